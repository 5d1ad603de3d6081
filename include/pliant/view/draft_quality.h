// The quality of the pictures of a motion, chosen by the time that the pictures take.
#pragma once

#include <pliant/render/window_renderer.h>

namespace pliant {

/// Lowers the quality of drafts (pictures that change) while they take longer than kLongest in the mean, and
/// raises the quality again when there is time. Only a part of the time of a picture depends on its samples.
/// If fewer samples save little time, the fall of the quality is undone.
class DraftQuality {
 public:
  using Quality = WindowRenderer::Quality;
  static constexpr double kLongest = 0.035;  ///< mean time of a picture, s of wall time
  static constexpr int kPause = 300;         ///< pictures before a useless fall of the quality is tried again

  Quality quality() const { return quality_; }

  /// Counts a picture of the present quality. seconds: the wall time that it took. The first picture of a
  /// quality does not count, because it may include preparations.
  void add(double seconds) {
    if (++pictures_ == 1) return;
    mean_ = pictures_ == 2 ? seconds : mean_ + kWeight * (seconds - mean_);
    if (pictures_ <= kTrial) return;
    const double before = mean_before_fall_;
    mean_before_fall_ = 0;
    const int level = static_cast<int>(quality_);
    if (mean_ > kWorthwhile * before && before > 0) {
      change(level + 1);
      may_fall_after_ = kPause;
    } else if (mean_ > kLongest && level > static_cast<int>(Quality::half_draft) &&
               pictures_ > may_fall_after_) {
      mean_before_fall_ = mean_;
      change(level - 1);
    } else if (level < static_cast<int>(Quality::draft) && mean_ < kLongest &&
               (kMargin * mean_ * more_samples(level) < kLongest || pictures_ > kPause)) {
      change(level + 1);
    }
  }

 private:
  static constexpr double kWeight = 0.2;  // of the last picture in the mean
  static constexpr double kMargin = 1.2;  // margin of time for a rise, so that the quality does not alternate
  static constexpr double kWorthwhile =
      0.85;                         // a fall that leaves more than this share of the time is undone (useless)
  static constexpr int kTrial = 8;  // pictures before a change

  /// Ratio of the numbers of samples of the next better draft and of a draft.
  static double more_samples(int level) {
    const double ratio = WindowRenderer::samples(static_cast<Quality>(level + 1)) /
                         WindowRenderer::samples(static_cast<Quality>(level));
    return ratio * ratio;
  }
  void change(int level) {
    quality_ = static_cast<Quality>(level);
    pictures_ = may_fall_after_ = 0;
  }

  Quality quality_ = Quality::draft;
  double mean_ = 0, mean_before_fall_ = 0;  // s
  int pictures_ = 0;                        // of the present quality
  int may_fall_after_ = 0;                  // number of pictures_ up to which the quality may not fall
};

}  // namespace pliant
