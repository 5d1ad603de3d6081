// Function bodies of choose_integrator.h: trials of the candidates, and the cost model of factorisations.
#pragma once

#include <pliant/simulate/choose_integrator.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include <pliant/body/step_failure.h>
#include <pliant/local/solid/inverted_element.h>
#include <pliant/math/header_only.h>
#include <pliant/simulate/step_length.h>

namespace pliant {

namespace integrator_choice {

/// Largest number of steps of a trial: kStepsWithFactors for methods that reuse factors, because their steps
/// grow for a longer time; kSteps for other methods. The first of kShares equal shares of these steps is not
/// counted, because steps grow and transients of the start decay there.
inline constexpr int kSteps = 48, kStepsWithFactors = 96, kShares = 3;
/// Longest simulated time of a trial, s.
inline constexpr double kMaxTrialTime = 1e3;
/// Cost of a factorisation of a dense matrix for n velocities: kFactorisation n^2 evaluations. An evaluation
/// takes about 70 n ns and a factorisation about n^3 / 3 ns (bench/step_bench, on one core).
inline constexpr double kFactorisation = 0.005;
/// Cost of a sparse factorisation of the stiffness of nodes, in evaluations: kSparseFactorisation times the
/// cube root of the number of nodal coordinates. Measured: 110 evaluations for a shell with 654 coordinates
/// (bench/work_precision, ringing), about 200 for a solid with 14 739 coordinates (bench/implicit_bench).
inline constexpr double kSparseFactorisation = 13;
/// Cost of the solves of a step, in factorisations. Measured: 0.13 for the shell above, 0.1 for the solid.
inline constexpr double kSolves = 0.1;
/// For tolerances of this value or more, the choice for a model with contact in which nothing is elastic or
/// damped is dormand_prince: steps with contact then cause most of the cost, and these steps are at most of
/// third order for every method.
inline constexpr double kCoarse = 1e-6;
/// kTrialTime: estimated time after which a trial ends, microseconds; trials of small models end earlier.
/// kMinCost: smallest value of max_cost(), evaluations.
inline constexpr double kTrialTime = 2e6, kMinCost = 30;
/// Number of steps that every trial may take, even if their cost is above max_cost().
inline constexpr int kLeastSteps = 3;
/// Largest number of velocities for which esdirk, whose stages need a dense matrix, is a candidate.
inline constexpr int kMaxDenseVelocities = 300;

/// Returns the largest cost of a trial, evaluations.
inline double max_cost(const Model& model) {
  double evaluation = 0;
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0) evaluation += evaluation_cost(*m.part);
  return std::max(kMinCost, kTrialTime / std::max(evaluation, 1.0));
}

/// Returns the cost of steps, in evaluations of the accelerations. factorisation: cost of one factorisation.
inline double cost_of(const StepCounters& counters, int steps, double factorisation) {
  return static_cast<double>(counters.evaluations) +
         factorisation * (static_cast<double>(counters.factorisations) + kSolves * steps);
}

/// Returns the simulated time (s) per cost of a trial of a method; 0 if the method fails. factorisation: cost
/// of one factorisation, in evaluations.
inline double pace(Integrator& method, const Dynamics& dynamics, const ErrorScale& scale, const State& start,
                   double factorisation, const std::function<bool()>& stop) {
  State state = start;
  Workspace<double> work;
  StepCounters counters;
  const int order = method.error_order();
  const StepError failed{std::numeric_limits<double>::infinity(), order, 0};
  method.measure(&scale);
  const double most = max_cost(dynamics.model());
  int steps = 0;
  auto too_long = [&] { return steps >= kLeastSteps && cost_of(counters, steps, factorisation) > most; };
  auto attempt = [&] {
    if (stop && stop()) throw ChoiceStopped();
    if (too_long()) return failed;
    try {
      StepContext step(dynamics, state, work, counters);
      method.step(step);
    } catch (const StepFailure&) {
      return failed;
    } catch (const InvertedElement&) {
      return failed;
    }
    const StepError error{method.pop_error(), order, state.h};
    return state.q.allFinite() && state.v.allFinite() ? error : failed;
  };
  StepContext start_of_trial(dynamics, state, work, counters);
  state.h = first_step(start_of_trial, scale, order);
  const StepGrowth growth = growth_of(method, dynamics.model());
  const int max_steps = growth.rarely ? kStepsWithFactors : kSteps;
  const double end = start.time() + kMaxTrialTime;
  double timed_from = start.time();
  double cost_before = 0;
  for (; steps < max_steps && state.time() < end && !too_long(); ++steps) {
    if (steps == max_steps / kShares) {
      timed_from = state.time();
      cost_before = cost_of(counters, steps, factorisation);
    }
    if (take_controlled_step(state, end, 0, growth, counters, attempt)) continue;
    if (!too_long()) return 0;
    break;
  }
  return (state.time() - timed_from) / (cost_of(counters, steps, factorisation) - cost_before);
}

}  // namespace integrator_choice

PLIANT_INLINE double evaluation_cost(const Part& part) {
  // Microseconds for each part, for each mass point times each parameter, and for each strain point.
  constexpr double part_alone = 0.1, point_and_parameter = 0.008, strain_point = 0.2;
  double cost = part_alone + point_and_parameter * part.mass_points().n_points * part.n_s();
  if (part.continuum() != nullptr) cost += strain_point * part.continuum()->points().n_points;
  if (part.local() != nullptr) cost += part.local()->cost();
  return cost;
}

PLIANT_INLINE bool has_stiffness(const Model& model, double t) {
  if (!model.drives().empty()) return true;
  const auto& springs = model.springs();
  if (std::any_of(springs.begin(), springs.end(), [&](const SpringModel& s) { return s.spring->acts_at(t); }))
    return true;
  return std::any_of(model.parts().begin(), model.parts().end(), [](const PartModel& m) {
    const Part& part = *m.part;
    return m.q0 >= 0 && (m.local != nullptr || m.drag > 0 || part.continuum() != nullptr ||
                         (m.n_s > 0 && (!part.K_s().isZero(0) || part.alpha() > 0 || part.beta() > 0)));
  });
}

PLIANT_INLINE IntegratorChoice choose_integrator(const Dynamics& dynamics, const ErrorScale& scale,
                                                 const State& start, const std::function<bool()>& stop) {
  const Model& model = dynamics.model();
  if (!has_stiffness(model, start.time())) {
    if (model.body().contact.active && scale.tolerance() >= integrator_choice::kCoarse)
      return {"dormand_prince",
              "nothing is elastic or damped, and for a tolerance this coarse steps with contact need no "
              "higher order"};
    return {"dop853", "nothing is elastic or damped"};
  }
  bool modes = false;
  int nodes = 0;  // number of nodal coordinates
  for (const PartModel& m : model.parts()) {
    if (m.local == nullptr) continue;
    if (m.local->oscillators() == nullptr)
      nodes += m.n_d();
    else
      modes = true;
  }
  const double sparse = integrator_choice::kSparseFactorisation * std::cbrt(nodes);
  std::vector<std::pair<const char*, double>> candidates{{"dop853", 0}};
  if (nodes > 0 || modes) candidates.emplace_back("linearly_implicit", sparse);
  if (nodes == 0 && model.n_v() <= integrator_choice::kMaxDenseVelocities)
    candidates.emplace_back("esdirk", integrator_choice::kFactorisation * model.n_v() * model.n_v());
  IntegratorChoice best;
  double fastest = -1;
  std::ostringstream reason;
  reason.precision(2);
  for (const auto& [name, factorisation] : candidates) {
    const std::unique_ptr<Integrator> method = make_integrator(name);
    const double speed = integrator_choice::pace(*method, dynamics, scale, start, factorisation, stop);
    reason << (best.integrator.empty() ? "" : ", ") << name << " advances " << speed
           << " s per evaluation of the accelerations";
    if (speed > fastest) best.integrator = name;
    fastest = std::max(fastest, speed);
  }
  best.why = reason.str();
  return best;
}

}  // namespace pliant
