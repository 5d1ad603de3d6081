// Moving a state along velocities: positions add, rotations turn by the exponential map.
#pragma once

#include <pliant/body/constraint/group.h>

namespace pliant {

/// q <- q (+) h v: c and q_s add, theta <- theta o exp(h omega / 2).
void advance_coordinates(const Model& model, VecX<double>& q, const VecX<double>& v, double h);

/// The same of one part, with its own velocities (c_dot, omega, q_s_dot).
void advance_part(const PartModel& m, VecX<double>& q, const Eigen::Ref<const VecX<double>>& v, double h);

/// The same of its local coordinates too; v: of all parts.
void advance_whole_part(const PartModel& m, VecX<double>& q, const VecX<double>& v, double h);

/// The share of a part in the velocities v of all.
inline auto share_of(const PartModel& m, VecX<double>& v) {
  return v.segment(m.v0, 6 + m.n_s);
}
inline auto share_of(const PartModel& m, const VecX<double>& v) {
  return v.segment(m.v0, 6 + m.n_s);
}

/// (R^T c_dot, omega, q_s_dot) of a part from (c_dot, omega, q_s_dot), and back; work: of its frame.
VecMax<double> body_velocity(const PartWorkspace<double>& w, const Eigen::Ref<const VecX<double>>& v);
VecMax<double> world_velocity(const PartWorkspace<double>& w, const Eigen::Ref<const VecX<double>>& v_r);

/// Of v what belongs to the velocities x of a part as its group has them (body/group.h): nodes take what the
/// change of the points at which joints hold them tells.
void scatter_velocity(const PartModel& m, const PartWorkspace<double>& w,
                      const Eigen::Ref<const VecX<double>>& x, VecX<double>& v);
/// q <- q (+) h x of a part, x as its group has it.
void advance_with(const PartModel& m, const PartWorkspace<double>& w, const Eigen::Ref<const VecX<double>>& x,
                  double h, VecX<double>& q);

/// Brings every quaternion back to unit length.
void normalise_rotations(const Model& model, VecX<double>& q);

/// Zero rates for parameters that had no inertia at the last evaluation.
void stop_inertialess(const Model& model, const Workspace<double>& work, VecX<double>& v);

}  // namespace pliant
