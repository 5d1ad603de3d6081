// Function bodies of stable_step.h: the eigenvalues of the motion about the state, and the largest step for
// which the growth of the method is at most 1 for each of them. The growth is the largest factor by which one
// step multiplies a solution of x_ddot + D x_dot + K x = 0.
#pragma once

#include <pliant/simulate/stable_step.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <utility>
#include <vector>

#include <pliant/math/header_only.h>
#include <pliant/method/free_oscillation.h>
#include <pliant/part/local/modal_deformation.h>
#include <pliant/simulate/choose_integrator.h>
#include <pliant/simulate/fast_motion.h>

namespace pliant {

namespace stability {

/// Largest rotation of a part in a step, rad.
inline constexpr double kMaxRotation = 0.5;
/// Largest change of phase of a mode in a step, rad, if impacts or springs act on the mode. In longer steps
/// the impacts and springs may add energy, because they act on a mode as on a free body.
inline constexpr double kMaxPhase = 1;
/// The Krylov space of the eigenvalues grows by kVectors vectors until the residual of the eigenvalue that
/// limits the step is at most kResidual. The errors of eigenvalues are then of second order in the residual.
inline constexpr int kVectors = 20;
inline constexpr double kResidual = 0.02;
/// The step is divided by 1 + the residual, so that it is safe. If the residual is above kExact, the divisor
/// is 1 + residual + kMargin, at most 1 + kMaxMargin.
inline constexpr double kExact = 1e-3, kMargin = 0.01, kMaxMargin = 0.05;
/// For real eigenvalues that limit the step to at most kNearLimit times the smallest limit, the limit is
/// computed again from the resistance against the motion. kMaxExamined: largest number of these eigenvalues.
inline constexpr double kNearLimit = 1.25;
inline constexpr std::size_t kMaxExamined = 12;
/// A residual above this value is reported (StableStep::uncounted), and upper bounds of local elasticity,
/// element by element, then also limit the step.
inline constexpr double kReported = 0.3;
/// If the accelerations deform or turn a part by more than this number in one stable step, in sizes of the
/// part or radians, the start is far from equilibrium, which is reported (StableStep::uncounted).
inline constexpr double kFar = 0.5;
/// Distance of a part from its initial position, in sizes of the part, above which is_far_out() is true.
inline constexpr double kFarOut = 1e6;

/// Returns the largest step (s) for which a method keeps the solutions of x_ddot + D x_dot + K x = 0 bounded.
/// The result is infinite without stiffness and damping, and 0 if K or D is not finite. K: 1/s^2; D: 1/s.
inline double stable_step_of(const Integrator& method, double K, double D) {
  if (!(K > 0) && !(D > 0)) return std::numeric_limits<double>::infinity();
  if (!std::isfinite(K + D)) return 0;
  const MatX<double> k = MatX<double>::Constant(1, 1, K), d = MatX<double>::Constant(1, 1, D);
  // Bisection between a stable and an unstable step.
  const double first = 0.05 / std::max(std::sqrt(K), D), slack = 1 + 1e-9;
  constexpr double kUnlimited = 1e12;  // in units of the first step
  double low = first, high = first;
  while (method.growth(k, d, high) <= slack && high < kUnlimited * first) high *= 2;
  if (!(high < kUnlimited * first)) return std::numeric_limits<double>::infinity();
  while (method.growth(k, d, low) > slack && low > first / kUnlimited) low /= 2;
  for (int i = 0; i < 40 && high - low > 1e-6 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (method.growth(k, d, middle) <= slack ? low : high) = middle;
  }
  return low;
}

/// Returns the largest stable step (s) for one eigenvalue (1/s). Motions that grow without oscillation, like
/// the fall of an inverted pendulum, do not limit the step.
inline double stable_step_of(const Integrator& method, std::complex<double> eigenvalue) {
  const double damping = std::max(0.0, -eigenvalue.real());
  if (eigenvalue.imag() == 0) return stable_step_of(method, 0, damping);
  return stable_step_of(method, std::norm(eigenvalue), 2 * damping);
}

/// Upper bounds of stiffness K (1/s^2) and damping D (1/s), in mass-normalised coordinates.
struct Bound {
  double K = 0, D = 0;
};
/// Returns bounds of the drag and of the springs that act at time t (s) at part i. The part must deform
/// locally.
inline Bound bound_springs(const Model& model, double t, std::size_t i) {
  const PartModel& m = model.parts()[i];
  Bound bound;
  bound.D = m.drag;
  for (const SpringModel& s : model.springs())
    for (const PortRef& ref : {s.a, s.b}) {
      if (ref.part != static_cast<int>(i) || !s.spring->acts_at(t)) continue;
      const double mobility = m.local->mobility(m.node_weights[static_cast<std::size_t>(ref.port)]);
      // The factor 2: the other end may move by an equal amount in the opposite direction.
      bound.K += 2 * s.spring->stiffness.of_time().value(t) * mobility;
      bound.D += 2 * s.spring->damping.of_time().value(t) * mobility;
    }
  return bound;
}

/// Returns the text that names the cause of a limit.
inline std::string cause_of(const Model& model, const MotionPlace& place) {
  const PartModel& m = model.parts()[static_cast<std::size_t>(place.part)];
  const std::string name = "part '" + m.part->name() + "'";
  if (place.is_local) return "the local elasticity of " + name;
  if (place.is_of_parameters) return "the springs and parameters of " + name;
  if (m.island >= 0) return "the oscillation of " + name + " on its joints";
  const auto& forces = model.distributed_forces();
  const auto force = std::find_if(forces.begin(), forces.end(),
                                  [&](const DistributedModel& each) { return each.part == place.part; });
  if (force != forces.end())
    return "the distributed force '" + force->force->name + "' and the springs at " + name;
  return "the springs at " + name;
}

/// A motion that limits the step.
struct LimitingMotion {
  double step = std::numeric_limits<double>::infinity();  ///< s
  FastMotion motion;
};

/// Returns the motion with the smallest stable step.
inline LimitingMotion limiting_motion(const Integrator& method, FastMotions& motions) {
  std::vector<LimitingMotion> all;
  for (FastMotion& motion : motions.motions()) {
    const double step = stable_step_of(method, motion.value);
    if (std::isfinite(step)) all.push_back({step, std::move(motion)});
  }
  std::sort(all.begin(), all.end(),
            [](const LimitingMotion& a, const LimitingMotion& b) { return a.step < b.step; });
  // A real eigenvalue alone does not determine the limit. The eigenvalue may belong to an overdamped motion,
  // whose step map for semi-implicit Euler depends on both eigenvalues, or to a motion that grows by itself.
  LimitingMotion smallest;
  std::size_t examined = 0;
  for (LimitingMotion& each : all) {
    if (each.step > kNearLimit * smallest.step) break;
    if (each.motion.value.imag() == 0 && examined < kMaxExamined) {
      const FastMotions::Resistance resistance = motions.resistance(each.motion);
      each.step = stable_step_of(method, resistance.K, resistance.D);
      ++examined;
    }
    if (each.step < smallest.step) smallest = each;
  }
  return smallest;
}

/// The search for the smallest of all limits of the step.
class StableStepSearch {
 public:
  explicit StableStepSearch(const Simulation& simulation)
      : method_(simulation.integrator()),
        dynamics_(simulation.dynamics()),
        model_(simulation.model()),
        state_(simulation.state()) {}

  StableStep run() {
    limit_by_motions();
    limit_by_stabilization();
    for (std::size_t i = 0; i < model_.parts().size(); ++i)
      if (model_.parts()[i].q0 >= 0) limit_by_part(i);
    return smallest_;
  }

 private:
  void limit_by(double step, const std::string& limit) {
    if (step < smallest_.step) smallest_ = {step, limit, smallest_.uncounted};
  }
  /// Returns whether the method integrates the elasticity of a part implicitly.
  bool is_implicit(const PartModel& m) const { return m.local != nullptr && method_.local_is_implicit(); }

  /// Returns whether a muscle or drive acts on part i.
  bool is_actuated(std::size_t i) const {
    const int part = static_cast<int>(i);
    for (const DriveModel& drive : model_.drives()) {
      std::vector<int> parts;
      model_.append_parts(drive.on, parts);
      if (std::find(parts.begin(), parts.end(), part) != parts.end()) return true;
    }
    return std::any_of(model_.springs().begin(), model_.springs().end(), [&](const SpringModel& s) {
      return !s.functions.empty() && (s.a.part == part || s.b.part == part);
    });
  }
  /// Returns whether a spring or drive acts on part i.
  bool is_pulled(std::size_t i) const {
    if (is_actuated(i)) return true;
    return std::any_of(model_.springs().begin(), model_.springs().end(), [&](const SpringModel& s) {
      return s.spring->acts_at(state_.time()) &&
             (s.a.part == static_cast<int>(i) || s.b.part == static_cast<int>(i));
    });
  }

  /// Returns for each velocity whether it takes part in the motion whose eigenvalues limit the step. Excluded
  /// are local coordinates and parameters that the method integrates implicitly, and modes that the method
  /// integrates exactly.
  std::vector<bool> moving_velocities() const {
    std::vector<bool> moves(static_cast<std::size_t>(model_.n_v()), true);
    for (std::size_t i = 0; i < model_.parts().size(); ++i) {
      const PartModel& m = model_.parts()[i];
      if (m.q0 < 0) continue;
      const auto set = [&](int first, int count) { std::fill_n(moves.begin() + m.v0 + first, count, false); };
      if (is_implicit(m))
        set(6, m.n_s + m.n_d());
      else if (oscillates_freely(m) && !is_pulled(i))
        set(6 + m.n_s, m.n_d());
    }
    return moves;
  }

  /// Returns whether a part is so far from its initial position that rounding errors dominate differences of
  /// the accelerations. The eigenvalues at the initial state are then used.
  bool is_far_out() const {
    const State initial = model_.initial_state();
    return std::any_of(model_.parts().begin(), model_.parts().end(), [&](const PartModel& m) {
      return m.q0 >= 0 &&
             !((state_.q.segment<3>(m.q0) - initial.q.segment<3>(m.q0)).norm() <= kFarOut * m.size);
    });
  }

  /// Limits the step by the eigenvalues of the motion about the state.
  void limit_by_motions() {
    if (model_.n_v() == 0 || (model_.islands().empty() && !has_stiffness(model_, state_.time()))) return;
    const auto limits = [&](double K, double D) { return std::isfinite(stable_step_of(method_, K, D)); };
    if (!limits(1, 0) && !limits(0, 1)) return;
    // The Jacobian excludes Baumgarte's terms: limit_by_stabilization() has their limit.
    State state = is_far_out() ? model_.initial_state() : state_;
    std::replace(state.joints.begin(), state.joints.end(), JointMode::closing, JointMode::closed);
    JointPolicy policy = dynamics_.joint_policy();
    policy.projected = true;
    Dynamics dynamics = dynamics_;
    dynamics.set_joint_policy(policy);
    FastMotions motions(dynamics, state, moving_velocities());
    LimitingMotion limiting;
    for (bool more = true; more;) {
      more = motions.extend(kVectors);
      limiting = limiting_motion(method_, motions);
      more = more && !(std::isfinite(limiting.step) && limiting.motion.residual <= kResidual);
    }
    if (!std::isfinite(limiting.step)) return;
    const double residual = limiting.motion.residual,
                 margin = residual > kExact ? std::min(residual + kMargin, kMaxMargin) : residual;
    const std::string cause = cause_of(model_, motions.place(limiting.motion));
    limit_by(limiting.step / (1 + margin), cause);
    report_far_start();
    if (!(residual <= kReported)) {
      std::ostringstream text;
      text.precision(2);
      text << "the frequency of " << cause << " is known to " << 100 * residual
           << " % only, and may limit the step more";
      smallest_.uncounted = text.str();
      limit_by_element_bounds();
    }
  }

  /// Limits the step by upper bounds of the stiffness and damping of local elasticity, element by element.
  void limit_by_element_bounds() {
    Workspace<double> work;
    dynamics_.accelerations(state_.time(), state_.q, state_.v, state_, work);
    for (std::size_t i = 0; i < model_.parts().size(); ++i) {
      const PartModel& m = model_.parts()[i];
      if (m.q0 < 0 || m.local == nullptr || is_implicit(m)) continue;
      const LocalDeformation::Bound bound = m.local->stiffness_bound(*work.parts[i].local);
      limit_by(stable_step_of(method_, bound.K, bound.D + m.local->alpha()),
               "the local elasticity of part '" + m.part->name() + "'");
    }
  }

  /// Reports a part whose accelerations deform or turn it far in one step. The eigenvalues then change soon
  /// after the start.
  void report_far_start() {
    Workspace<double> work;
    dynamics_.accelerations(state_.time(), state_.q, state_.v, state_, work);
    const double half_square = 0.5 * smallest_.step * smallest_.step;
    double farthest = kFar;
    for (const PartModel& m : model_.parts()) {
      if (m.q0 < 0) continue;
      const double turn = half_square * work.v_dot.segment<3>(m.v0 + 3).norm();
      double strain = 0;
      for (int k = 0; k < m.n_s; ++k)
        if (m.part->parameters().moving(k).spec->quantity == Quantity::length)
          strain = std::max(strain, half_square * std::abs(work.v_dot[m.v0 + 6 + k]) / m.size);
      if (m.local != nullptr && m.local->nodal() != nullptr && m.n_d() > 0)
        strain = std::max(
            strain,
            half_square * work.v_dot.segment(m.v0 + 6 + m.n_s, m.n_d()).cwiseAbs().maxCoeff() / m.size);
      if (!(std::max(turn, strain) > farthest)) continue;
      farthest = std::max(turn, strain);
      smallest_.uncounted = "the start is far from equilibrium: its loads " +
                            std::string(strain > turn ? "deform" : "turn") + " part '" + m.part->name() +
                            "' so fast that the stable step soon changes, and may become smaller";
    }
  }

  /// Limits the step by Baumgarte's terms, which act on open joints, and on closed joints without projection.
  /// Gains that depend on the step length are stable for any step, so that they give no limit.
  void limit_by_stabilization() {
    const JointPolicy& policy = dynamics_.joint_policy();
    const Stabilization& rule = model_.body().stabilization;
    const bool acts = !rule.follows_step(policy.step_consistent) &&
                      std::any_of(state_.joints.begin(), state_.joints.end(), [&](JointMode mode) {
                        return mode == JointMode::closing || (mode == JointMode::closed && !policy.projected);
                      });
    if (!acts) return;
    const Gains gains = rule.gains(state_.h, policy.step_consistent);
    limit_by(stable_step_of(method_, gains.beta * gains.beta, 2 * gains.alpha),
             "the gaps of joints, which Baumgarte's terms close");
  }

  void limit_by_part(std::size_t i) {
    const PartModel& m = model_.parts()[i];
    const double speed = state_.v.segment<3>(m.v0 + 3).norm();
    const std::string name = "part '" + m.part->name() + "'";
    if (speed > 0) limit_by(kMaxRotation / speed, "the rotation of " + name);
    if (m.local == nullptr) return;
    const TimeFunction* factor = m.part->local_factor();
    if (const Oscillators* modes = m.local->oscillators(); modes != nullptr && !is_implicit(m)) {
      const double now = factor != nullptr ? std::max(1.0, factor->value(state_.time())) : 1,
                   of_phase = kMaxPhase / std::sqrt(now * modes->omega2.maxCoeff());
      if (model_.body().contact.active)
        limit_by(of_phase, "the modes of " + name + ", which impacts may excite");
      if (oscillates_freely(m) && is_pulled(i)) {
        limit_by(of_phase, "the modes of " + name + ", which springs may excite");
        smallest_.uncounted = "the method integrates the modes of " + name +
                              " exactly, so that longer steps may be stable in spite of the springs";
      }
    }
    if (factor != nullptr) limit_by_factor(m, *factor);
    if (!is_implicit(m)) return;
    const Bound bound = bound_springs(model_, state_.time(), i);
    limit_by(stable_step_of(method_, bound.K, bound.D), "the springs at " + name);
    if (is_actuated(i))
      smallest_.uncounted = "the muscles and drives at " + name + " are not included, because " +
                            std::string(method_.name()) + " integrates its elasticity implicitly";
    if (m.island >= 0)
      smallest_.uncounted = "the joints of parts that deform locally are not included, because " +
                            std::string(method_.name()) + " integrates their elasticity implicitly";
  }

  /// Limits the step for a part whose local stiffness is multiplied by a factor, a function of time. The
  /// exact integration of free modes does not include the factor; the method integrates the remaining force.
  void limit_by_factor(const PartModel& m, const TimeFunction& factor) {
    const std::string name = "part '" + m.part->name() + "'";
    const double now = factor.value(state_.time());
    if (m.local->modal() != nullptr && !is_implicit(m) && oscillates_freely(m) && now != 1) {
      const Oscillators modes = m.local->modal()->oscillators_at(std::max(now, 1.0));
      limit_by(std::min(stable_step_of(method_, modes.omega2.maxCoeff(), modes.damping.maxCoeff()),
                        kMaxPhase / std::sqrt(modes.omega2.maxCoeff())),
               "the modes of " + name + ", whose stiffness has a factor");
    }
    if (!factor.is_constant())
      smallest_.uncounted = "the factor of the local stiffness of " + name + " changes in time";
  }

  const Integrator& method_;
  const Dynamics& dynamics_;
  const Model& model_;
  const State& state_;
  StableStep smallest_{std::numeric_limits<double>::infinity(), {}, {}};
};

}  // namespace stability

PLIANT_INLINE double largest_stable_step(const Simulation& simulation) {
  return stable_step(simulation).step;
}

PLIANT_INLINE StableStep stable_step(const Simulation& simulation) {
  return stability::StableStepSearch(simulation).run();
}

}  // namespace pliant
