// Functions of time in a scene: constants, C2 cubic splines through key frames, formulas. Each gives value, rate and
// second derivative, so that moving anchors, prescribed paths and actuation enter the equations of motion exactly.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/math/taylor2.h>
#include <pliant/math/types.h>

namespace pliant {

/// A scalar function of time t (s). Cheap to copy.
class TimeFunction {
 public:
  TimeFunction(double constant = 0) : constant_(constant) {}  // NOLINT(google-explicit-constructor)

  /// The C2 cubic spline through (t_i, y_i): natural ends when the first and last rates are not given; before the
  /// first and after the last key the function is constant at its end value.
  /// Throws std::invalid_argument unless the times are finite and strictly increasing and there is a key.
  static TimeFunction key_frames(std::vector<double> t, std::vector<double> y);
  /// A formula in t (see Formula in math/formula.h). Throws FormulaError with the offset of the fault.
  static TimeFunction formula(const std::string& text);

  /// Value, first and second time derivative at t.
  Taylor2<double> at(double t) const { return impl_ ? impl_->at(t) : Taylor2<double>(constant_); }
  double value(double t) const { return at(t).v; }
  bool is_constant() const { return impl_ == nullptr; }

  /// What stands behind a function that is not constant.
  struct Impl {
    virtual ~Impl() = default;
    virtual Taylor2<double> at(double t) const = 0;
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

  Vec3<Taylor2<double>> at(double t) const { return {component[0].at(t), component[1].at(t), component[2].at(t)}; }
  Vec3<double> value(double t) const {
    return {component[0].value(t), component[1].value(t), component[2].value(t)};
  }
  bool is_constant() const {
    return component[0].is_constant() && component[1].is_constant() && component[2].is_constant();
  }
};

}  // namespace pliant
