// Functions of time and state, for forces, springs, drives and sensors: a function of time, or a formula of t
// and of signals.
#pragma once

#include <array>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/actuation/signal.h>
#include <pliant/math/formula.h>
#include <pliant/math/time_function.h>

namespace pliant {

/// Maximum number of signals of a formula.
inline constexpr int kMaxSignals = 32;

/// A scalar function of time t (s) and of the state. Copies are cheap: they share the formula.
class StateFunction {
 public:
  StateFunction(double constant = 0) : of_time_(constant) {}             // NOLINT
  StateFunction(TimeFunction of_time) : of_time_(std::move(of_time)) {}  // NOLINT
  /// signals: the quantities of the formula, in the order of their numbers in the formula (Formula::Names).
  /// Throws std::invalid_argument for more than kMaxSignals signals.
  StateFunction(Formula formula, std::vector<Signal> signals);

  bool reads_state() const { return of_state_ != nullptr; }
  bool is_constant() const { return !reads_state() && of_time_.is_constant(); }
  /// The function of time; 0 if the function reads the state.
  const TimeFunction& of_time() const { return of_time_; }
  /// The formula. The function must read the state.
  const Formula& formula() const { return of_state_->formula; }
  /// The signals of the formula; empty if the function does not read the state.
  const std::vector<Signal>& signals() const;
  /// Returns the value of a constant.
  double constant() const { return of_time_.value(0); }

 private:
  struct OfState {
    Formula formula;
    std::vector<Signal> signals;
  };
  TimeFunction of_time_;
  std::shared_ptr<const OfState> of_state_;
};

/// Three functions, the components of a force or torque.
struct StateVector {
  std::array<StateFunction, 3> component;

  StateVector() = default;
  StateVector(const Vec3<double>& x) : component{x[0], x[1], x[2]} {}  // NOLINT
  StateVector(const TimeVector& x)                                     // NOLINT
      : component{x.component[0], x.component[1], x.component[2]} {}
  StateVector(StateFunction x, StateFunction y, StateFunction z)
      : component{std::move(x), std::move(y), std::move(z)} {}

  bool reads_state() const {
    return component[0].reads_state() || component[1].reads_state() || component[2].reads_state();
  }
  bool is_constant() const {
    return component[0].is_constant() && component[1].is_constant() && component[2].is_constant();
  }
};

/// A named number that a controller sets.
struct Input {
  std::string name;
  double initial = 0;  ///< value at time 0
};

/// A named function of time and state, which is recorded. Formulas of loads may read it.
struct Sensor {
  std::string name;
  StateFunction value;
};

}  // namespace pliant
