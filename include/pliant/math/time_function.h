// Functions of time in a scene: constants, C2 cubic splines through key frames, formulas. Each gives value,
// rate and second derivative, so that moving anchors, prescribed paths and actuation enter the equations of
// motion exactly.
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

/// A time (s) at which the rate of a function of time jumps, or its value; infinite: there is none.
struct Kink {
  double time = std::numeric_limits<double>::infinity();
  bool jumps = false;  ///< whether its value does

  /// The earlier one, or both where they are at the same time.
  Kink or_sooner(const Kink& other) const {
    if (time == other.time) return {time, jumps || other.jumps};
    return time < other.time ? *this : other;
  }
};

/// A scalar function of time t (s). Cheap to copy.
class TimeFunction {
 public:
  TimeFunction(double constant = 0) : constant_(constant) {}  // NOLINT(google-explicit-constructor)

  /// The cubic spline through (t_i, y_i), twice continuously differentiable from the first key to the last;
  /// before and after them it is constant, so that its rate jumps there unless the end rates are zero. Ends
  /// are natural (second derivative zero). One key is a constant. Throws std::invalid_argument unless all is
  /// finite, the times strictly increase, and there is a key and as many values as times.
  static TimeFunction key_frames(std::vector<double> t, std::vector<double> y);
  /// The same with the rates at the first and the last key given (clamped ends); one key is still a constant.
  static TimeFunction key_frames(std::vector<double> t, std::vector<double> y, double first_rate,
                                 double last_rate);
  /// A formula in t (see Formula in math/formula.h). Throws FormulaError with the offset of the fault.
  static TimeFunction formula(const std::string& text);

  /// Value, first and second time derivative at t.
  Taylor2<double> at(double t) const { return impl_ ? impl_->at(t) : Taylor2<double>(constant_); }
  double value(double t) const { return at(t).v; }
  bool is_constant() const { return impl_ == nullptr; }
  /// The first kink later than a time and no later than another (s). Of a formula those are found that a few
  /// looks between these times tell: they are to be near each other, as the ends of a step are.
  Kink first_kink(double after, double until) const {
    return impl_ && after < until ? impl_->first_kink(after, until) : Kink();
  }

  /// What stands behind a function that is not constant.
  struct Impl {
    virtual ~Impl() = default;
    virtual Taylor2<double> at(double t) const = 0;
    virtual Kink first_kink(double /*after*/, double /*until*/) const { return {}; }
  };
  explicit TimeFunction(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

 private:
  double constant_ = 0;
  std::shared_ptr<const Impl> impl_;
};

/// Three functions of time: a moving point, a force, a torque.
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

  /// Its mean rate over h seconds, and by how much its rate differs from that at most, at kMoments.
  struct Passage {
    Vec3<double> rate;
    double beside;
  };
  Passage over(double t, double h) const;
};

/// Shares of a time at which it is looked at what happens in it: what swings to and fro is caught by one.
inline constexpr std::array<double, 5> kMoments{0, 0.27, 0.5, 0.77, 1};

}  // namespace pliant
