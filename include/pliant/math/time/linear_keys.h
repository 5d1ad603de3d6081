// A piecewise linear function of time through key frames. Keys can be added while the function is in use.
#pragma once

#include <algorithm>
#include <cstddef>
#include <memory>
#include <utility>
#include <vector>

#include <pliant/math/time/key_frames.h>
#include <pliant/math/time_function.h>

namespace pliant {

/// With keys (t_i, y_i), the value between the keys i and i+1 is y_i + (y_{i+1} - y_i) (t - t_i) / (t_{i+1} -
/// t_i). Before the first key and after the last the value is constant. Every key is a kink, even if the rate
/// does not jump there. Otherwise an added key could turn an earlier key into a kink. At a key the rate is
/// the rate just after the key.
class LinearKeys final : public TimeFunction::Impl {
 public:
  /// t: times, s. y: a value for each time. Throws std::invalid_argument if there is no key, if the numbers
  /// of times and values differ, if a number is not finite, or if the times do not strictly increase.
  LinearKeys(std::vector<double> t, std::vector<double> y) : t_(std::move(t)), y_(std::move(y)) {
    detail::require_keys(t_, y_);
  }

  /// Adds a key at a time t (s) later than all others. No other thread may use the function during the call.
  void append(double t, double y) {
    t_.push_back(t);
    y_.push_back(y);
  }
  /// Replaces all keys by one. No other thread may use the function during the call.
  void restart(double t, double y) {
    t_.assign(1, t);
    y_.assign(1, y);
  }
  const std::vector<double>& times() const { return t_; }  ///< s
  const std::vector<double>& values() const { return y_; }

  Taylor2<double> at(double t) const override {
    if (t < t_.front()) return y_.front();
    const auto above = std::upper_bound(t_.begin(), t_.end(), t);
    if (above == t_.end()) return y_.back();
    const std::size_t i = static_cast<std::size_t>(above - t_.begin()) - 1;
    const double rate = (y_[i + 1] - y_[i]) / (t_[i + 1] - t_[i]);
    return {y_[i] + rate * (t - t_[i]), rate, 0};
  }

  Kink first_kink(double after, double until) const override {
    const auto next = std::upper_bound(t_.begin(), t_.end(), after);
    return next == t_.end() || *next > until ? Kink() : Kink{*next, false};
  }

 private:
  std::vector<double> t_, y_;
};

/// Returns the piecewise linear function through keys. Throws the exceptions of the constructor of
/// LinearKeys.
inline TimeFunction linear_key_frames(std::vector<double> t, std::vector<double> y) {
  return TimeFunction(std::make_shared<LinearKeys>(std::move(t), std::move(y)));
}

}  // namespace pliant
