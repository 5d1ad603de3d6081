// The functions project_frames() and end_motion() of project.h: reference conditions W^T d = 0 after a step
// (include/pliant/part/local/README.md). A change delta of (c, theta, q_s) that leaves every node in place
// changes d by -G delta, and W^T d by -K^T delta:
//   K^T delta = W^T d,   and for the velocities x_dot of the nodes, body frame, K^T v_r = W^T x_dot.
// H = sum over nodes k of G_k^T W_k; K = H - P^T with P = d(W^T d)/dq_s; H0 is the mass
// matrix of (c, theta, q_s) at d = 0.
#pragma once

#include <pliant/project/project.h>

#include <sstream>

#include <Eigen/Geometry>

#include <pliant/body/advance.h>
#include <pliant/body/speed_scale.h>
#include <pliant/body/step_failure.h>
#include <pliant/math/finite.h>
#include <pliant/math/header_only.h>
#include <pliant/part/local/nodal_deformation.h>

namespace pliant {

namespace projection {

/// A change of the frame of at most this share of the size of the part is a rounding error; it is not
/// applied.
inline constexpr double kFrameRounding = 1e-15;
inline constexpr int kMaxFrameIterations = 8;
/// K is regular if |sum m d s^T| over the nodes (mass m, displacement d, reference position s) is at most
/// this share of the smallest moment of inertia.
inline constexpr double kSmallChange = 0.3;
/// Largest allowed LocalWorkspace::condition(), the condition number of the matrix that determines the frame.
/// Above it, check_condition() throws.
inline constexpr double kMaxCondition = 1e8;

/// Returns whether the conditions of a part without dynamic parameters are satisfied to rounding, now and
/// after another step with the present rates. Returns false for a part with dynamic parameters. Without
/// dynamic parameters W is constant and the conditions are linear, so that most methods satisfy them after a
/// step.
inline bool conditions_met(const PartModel& m, const State& state, const PartWorkspace<double>& work) {
  if (m.n_s > 0 || !(state.h > 0) || !work.local || work.local->H0.rows() == 0 ||
      !(work.local->condition() <= kMaxCondition))
    return false;
  const NodalDeformation& local = *m.local->nodal();
  const auto at_nodes = [&](const VecX<double>& of, int first) {
    return Eigen::Map<const Nodes>(of.data() + first, local.n_nodes(), 3);
  };
  const NodalDeformation::ConditionViolation violation =
      local.violation(at_nodes(state.q, m.q0 + 7), at_nodes(state.v, m.v0 + 6), *work.local);
  const Vec<double, 6> inertia = work.local->H0.diagonal();
  const double size = m.size;
  const auto small = [&](const Vec<double, 6>& share) {
    return share.head<3>().norm() <= kFrameRounding * size * inertia[0] &&
           (share.tail<3>().array().abs() <= kFrameRounding * inertia.tail<3>().array()).all();
  };
  // K differs from H0 by at most sqrt(2) |sum m d s^T|, and by terms of W^T d, which is small.
  const bool regular = violation.d_s.norm() <= kSmallChange * inertia.tail<3>().minCoeff();
  return regular && small(violation.W_d) && small(state.h * violation.W_d_dot);
}

/// Throws NumericalFailure if the conditions no longer determine the frame of a part.
inline void check_condition(const PartModel& m, const LocalWorkspace& local, double t) {
  const double condition = local.condition();
  if (condition <= kMaxCondition) return;
  std::ostringstream message;
  message << "the motion of the nodes of part '" << m.part->name()
          << "' no longer determines its frame and global parameters (condition number ";
  if (std::isfinite(condition))
    message << condition << ", expected at most " << kMaxCondition << "); ";
  else
    message << "not finite); ";
  message << (m.n_s > 0 ? "freeze some of the parameters"
                        : "the nodes are too close to a line, or farther from the shape than its size");
  throw NumericalFailure(message.str(), t);
}

/// Throws NumericalFailure for a part for which the iteration of project_frame() does not converge.
[[noreturn]] inline void fail_to_follow(const PartModel& m, const StepContext& step) {
  std::ostringstream message;
  message << "the nodes of part '" << m.part->name()
          << "' are too far from the shape of its parameters to determine its frame"
          << (step.state.h > 0 ? "" : " at time 0; choose smaller displacements");
  throw NumericalFailure(message.str(), step.t);
}

/// Projects the frame of part i. Does nothing if the part does not deform locally, if its q_d and their rates
/// are zero, or if the state is not finite.
inline void project_frame(StepContext& step, std::size_t i) {
  const Dynamics& dynamics = step.dynamics;
  State& state = step.state;
  Workspace<double>& work = step.work;
  const PartModel& m = dynamics.model().parts()[i];
  if (m.local == nullptr) return;
  auto q_d = state.q.segment(m.q0 + 7 + m.n_s, m.n_d());
  if (q_d.isZero(0) && state.v.segment(m.v0 + 6 + m.n_s, m.n_d()).isZero(0)) return;
  work.parts.resize(dynamics.model().parts().size());
  if (m.local->nodal() != nullptr && conditions_met(m, state, work.parts[i])) return;
  if (!all_finite(state.q) || !all_finite(state.v)) return;
  const int part = static_cast<int>(i);
  dynamics.evaluate_frame(step.t, state.q, state.v, part, work);
  PartWorkspace<double>& w = work.parts[i];
  check_condition(m, *w.local, step.t);
  if (m.local->nodal() == nullptr) return;
  const NodalDeformation& local = *m.local->nodal();
  NodalWorkspace& now = NodalDeformation::of(*w.local);
  const Eigen::Index n = local.n_nodes();
  const double size = m.size;
  Nodes &p = now.p_kept, &u = now.u_kept;
  u.resize(n, 3);
  local.add_frame_velocities(w.v_r, 1, now, now.d_dot.data(), u.data());
  for (int iteration = 0;; ++iteration) {
    const VecMax<double> delta = now.solve_transposed(now.violation);
    if (!(largest_speed(m, delta) > kFrameRounding * size)) break;
    if (iteration == kMaxFrameIterations) fail_to_follow(m, step);
    if (iteration == 0) p = nodes(now.x, n);
    advance_part(m, state.q, world_velocity(w, delta), 1);
    const Vec3<double> rotation = delta.segment<3>(3);
    const double angle = rotation.norm();
    const Vec3<double> axis = angle > 0 ? Vec3<double>(rotation / angle) : Vec3<double>::UnitX();
    local.move_frame(delta.head<3>(), Eigen::AngleAxisd(angle, axis).toRotationMatrix(), p, u);
    // Evaluate the reference shape at the new parameters.
    if (m.n_s > 0) dynamics.evaluate_frame(step.t, state.q, state.v, part, work);
    Eigen::Map<Nodes>(q_d.data(), n, 3) = p - now.s;
    dynamics.evaluate_frame(step.t, state.q, state.v, part, work);
  }
  const VecMax<double> v_r = now.solve_transposed(local.frame_share(u, now));
  part_velocities(m, state.v) = world_velocity(w, v_r);
  local.add_frame_velocities(v_r, -1, now, u.data(), state.v.data() + m.v0 + 6 + m.n_s);
}

}  // namespace projection

PLIANT_INLINE void end_motion(StepContext& step) {
  zero_inertialess_velocities(step.model(), step.work, step.state.v);
  normalise_rotations(step.model(), step.state.q);
  project_frames(step);
}

PLIANT_INLINE void project_frames(StepContext& step) {
  for (std::size_t i = 0; i < step.model().parts().size(); ++i) projection::project_frame(step, i);
}

PLIANT_INLINE void project_frames(StepContext& step, const std::vector<int>& parts) {
  for (const int part : parts) projection::project_frame(step, static_cast<std::size_t>(part));
}

}  // namespace pliant
