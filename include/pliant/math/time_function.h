// Functions of time in a scene: constants, C2 cubic splines through key frames, formulas. A function returns
// its value, rate and second derivative, because moving anchors, prescribed paths and actuation need C_t and
// C_tt of Eq. (13).
#pragma once

#include <array>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/math/scalar/taylor2.h>
#include <pliant/math/types.h>

namespace pliant {

/// A time (s) at which a function of time or its rate jumps. An infinite time means that there is no kink.
struct Kink {
  double time = std::numeric_limits<double>::infinity();
  bool jumps = false;  ///< whether the value jumps, and not only the rate

  /// Returns the earlier kink. At equal times the value of the result jumps if the value of one of the two
  /// jumps.
  Kink or_sooner(const Kink& other) const {
    if (time == other.time) return {time, jumps || other.jumps};
    return time < other.time ? *this : other;
  }
};

/// A scalar function of time t (s). Copies are cheap: they share the spline or the formula.
class TimeFunction {
 public:
  TimeFunction(double constant = 0) : first_value_(constant) {}  // NOLINT(google-explicit-constructor)

  /// Returns the cubic spline through the keys (t_i, y_i) with natural ends (second derivative zero). The
  /// spline is twice continuously differentiable from the first key to the last. Before the first key and
  /// after the last it is constant, so its rate jumps there unless the end rates are zero. A single key gives
  /// a constant. Throws std::invalid_argument if there is no key, if the numbers of times and values differ,
  /// if a number is not finite, or if the times do not strictly increase.
  static TimeFunction key_frames(std::vector<double> t, std::vector<double> y);
  /// Returns the cubic spline with given rates at the first and the last key (clamped ends). A single key
  /// gives a constant. Throws std::invalid_argument for invalid keys, as above, and if a rate is not finite.
  static TimeFunction key_frames(std::vector<double> t, std::vector<double> y, double first_rate,
                                 double last_rate);
  /// Returns a formula in t (see Formula in math/formula.h). Throws FormulaError with the offset of the
  /// error.
  static TimeFunction formula(const std::string& text);

  /// Returns the value and the first and second time derivative at t (s).
  Taylor2<double> at(double t) const { return impl_ ? impl_->at(t) : Taylor2<double>(first_value_); }
  double value(double t) const { return at(t).v; }
  /// Returns the value at time 0, computed when the function was made. The call is safe while another thread
  /// adds keys to the function (LinearKeys).
  double first_value() const { return first_value_; }
  bool is_constant() const { return impl_ == nullptr; }
  /// Returns the first kink in the interval (after, until] (s), or a Kink of infinite time. For a formula,
  /// the search compares the branches of the formula at 5 times of the interval, including the ends. The
  /// search can miss kinks in a long interval; the interval of one step is short enough.
  Kink first_kink(double after, double until) const {
    return impl_ && after < until ? impl_->first_kink(after, until) : Kink();
  }

  /// Implementation of a function that is not constant.
  struct Impl {
    virtual ~Impl() = default;
    virtual Taylor2<double> at(double t) const = 0;
    virtual Kink first_kink(double /*after*/, double /*until*/) const { return {}; }
  };
  explicit TimeFunction(std::shared_ptr<const Impl> impl)
      : first_value_(impl->at(0).v), impl_(std::move(impl)) {}

 private:
  double first_value_;  // at time 0; for a constant, its value at all times
  std::shared_ptr<const Impl> impl_;
};

/// Three functions of time, for a moving point, a force or a torque.
struct TimeVector {
  std::array<TimeFunction, 3> component;

  TimeVector() = default;
  TimeVector(const Vec3<double>& x) : component{x[0], x[1], x[2]} {}  // NOLINT(google-explicit-constructor)
  TimeVector(TimeFunction x, TimeFunction y, TimeFunction z)
      : component{std::move(x), std::move(y), std::move(z)} {}

  Vec3<Taylor2<double>> at(double t) const {
    return {component[0].at(t), component[1].at(t), component[2].at(t)};
  }
  Vec3<double> value(double t) const {
    return {component[0].value(t), component[1].value(t), component[2].value(t)};
  }
  Kink first_kink(double after, double until) const {
    return component[0]
        .first_kink(after, until)
        .or_sooner(component[1].first_kink(after, until))
        .or_sooner(component[2].first_kink(after, until));
  }
  bool is_constant() const {
    return component[0].is_constant() && component[1].is_constant() && component[2].is_constant();
  }

  /// The mean rate over a time interval, and the largest distance of the rate from this mean, sampled at
  /// kMoments.
  struct MeanRate {
    Vec3<double> rate;     ///< change / h, in units of the function per second
    double max_deviation;  ///< in the same units
  };
  /// Returns the mean rate from t to t + h (s), and the largest deviation from it.
  MeanRate over(double t, double h) const;
};

/// Fractions of a step at which functions of time are sampled. The fractions are not equally spaced, so that
/// the samples of a periodic motion are not all zero.
inline constexpr std::array<double, 5> kMoments{0, 0.27, 0.5, 0.77, 1};

}  // namespace pliant
