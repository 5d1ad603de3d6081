// Function bodies of step_length.h: the controller of the step length, and the first step.
#pragma once

#include <pliant/simulate/step_length.h>

#include <algorithm>
#include <cmath>

#include <pliant/body/speed_scale.h>
#include <pliant/math/header_only.h>
#include <pliant/part/local/nodal_deformation.h>

namespace pliant {

namespace step_length {
/// Safety factor, and smallest ratio of the length of a step to the length of the previous step.
inline constexpr double kSafety = 0.8, kMinFactor = 0.2;
/// Safety factor for errors of order 0. An error of order 0 is the ratio of the step length to
/// longest_contact_step(), which is known exactly. The next length may then be below kMinFactor times the
/// last length.
inline constexpr double kExactSafety = 0.99;
/// Exponent of the previous error in the proportional-integral controller, times order + 1.
inline constexpr double kIntegral = 0.2;
/// Lower bound of an error in the controller, in tolerances.
inline constexpr double kMinError = 1e-6;
}  // namespace step_length

PLIANT_INLINE double next_step(double h, double error, double last_error, int order, bool rejected,
                               double max_growth) {
  if (!std::isfinite(error)) return step_length::kMinFactor * h;
  if (order == 0 && error > 1) return step_length::kExactSafety / error * h;
  const double safety = order > 0 ? step_length::kSafety : step_length::kExactSafety;
  const double power = 1.0 / (order + 1), now = std::max(error, step_length::kMinError);
  double factor = safety * std::pow(now, -power);
  if (!rejected && last_error > 0)
    factor = safety * std::pow(now, -power * (1 - 0.75 * step_length::kIntegral)) *
             std::pow(std::max(last_error, step_length::kMinError), power * step_length::kIntegral);
  return h * std::clamp(factor, step_length::kMinFactor, rejected ? 1 : max_growth);
}

PLIANT_INLINE StepGrowth growth_of(const Integrator& method, const Model& model) {
  const auto& parts = model.parts();
  const bool reuses_factors =
      method.local_is_implicit() && std::any_of(parts.begin(), parts.end(), [](const PartModel& m) {
        return m.local != nullptr && m.local->nodal() != nullptr && m.local->nodal()->stiffness_is_constant();
      });
  return reuses_factors ? StepGrowth{true, 40} : StepGrowth{};
}

PLIANT_INLINE double first_step(StepContext& step, const ErrorScale& scale, int order) {
  const Dynamics& dynamics = step.dynamics;
  const State& state = step.state;
  Workspace<double>& work = step.work;
  // h: length of a step of Euler's method in which the state changes by 0.01 in the units of the scale.
  dynamics.accelerations(state.time(), state.q, state.v, state, work);
  VecX<double> q_dot, q_dot_end;
  dynamics.coordinate_rates(state.q, state.v, q_dot);
  const VecX<double> v_dot = work.v_dot;
  const double tolerance = scale.tolerance(), rate = tolerance * scale.norm(q_dot, v_dot, state.v);
  double h = rate > 0 ? 0.01 / rate : 1e-3 / slow_rate(dynamics.model());
  // Change of the rates during this step, divided by h.
  dynamics.accelerations(state.time() + h, state.q + h * q_dot, state.v + h * v_dot, state, work);
  dynamics.coordinate_rates(state.q + h * q_dot, state.v + h * v_dot, q_dot_end);
  step.counters.evaluations += 2;
  const double change = tolerance * scale.norm(q_dot_end - q_dot, work.v_dot - v_dot, state.v) / h;
  const double fastest = std::max(rate, std::sqrt(change));
  if (fastest > 0 && std::isfinite(fastest))
    h = std::min(100 * h, std::pow(tolerance, 1.0 / (order + 1)) / fastest);
  return h;
}

}  // namespace pliant
