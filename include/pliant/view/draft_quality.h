// The quality of the pictures of a motion, chosen by the time that they take.
#pragma once

#include <pliant/render/window_renderer.h>

namespace pliant {

/// Chooses the best draft whose pictures take less than kLongest in the mean. The time is assumed to be
/// proportional to the number of samples, or less.
class DraftQuality {
 public:
  using Quality = WindowRenderer::Quality;
  static constexpr double kLongest = 0.035;  ///< s of wall time

  Quality quality() const { return quality_; }

  /// Counts a picture of the present quality. seconds: the wall time that it took.
  void add(double seconds) {
    mean_ = pictures_ == 0 ? seconds : mean_ + kWeight * (seconds - mean_);
    if (++pictures_ < kTrial) return;
    const int level = static_cast<int>(quality_);
    if (mean_ > kLongest && level > static_cast<int>(Quality::half_draft))
      change(level - 1);
    else if (level < static_cast<int>(Quality::draft) && kMargin * mean_ * more_samples(level) < kLongest)
      change(level + 1);
  }

 private:
  static constexpr double kWeight = 0.2;  // of the last picture in the mean
  static constexpr double kMargin = 1.2;  // so that the quality does not change to and fro
  static constexpr int kTrial = 8;        // pictures before a change

  /// Ratio of the numbers of samples of the next better draft and of a draft.
  static double more_samples(int level) {
    const double ratio = WindowRenderer::samples(static_cast<Quality>(level + 1)) /
                         WindowRenderer::samples(static_cast<Quality>(level));
    return ratio * ratio;
  }
  void change(int level) {
    quality_ = static_cast<Quality>(level);
    pictures_ = 0;
  }

  Quality quality_ = Quality::draft;
  double mean_ = 0;
  int pictures_ = 0;
};

}  // namespace pliant
