// Advances coordinates along velocities. The increments of positions and parameters are added; rotations are
// multiplied by the exponential map of their increment.
#pragma once

#include <pliant/body/constraint/group.h>

namespace pliant {

/// Computes q <- q (+) h v for all parts that have coordinates; h: s. c, q_s and q_d increase by h times
/// their velocities. The quaternions change by theta <- theta o exp(h omega / 2), where o is the product of
/// quaternions.
void advance_coordinates(const Model& model, VecX<double>& q, const VecX<double>& v, double h);

/// Computes q <- q (+) h v for the frame and the global parameters of one part. v: (c_dot, omega, q_s_dot) of
/// the part.
void advance_part(const PartModel& m, VecX<double>& q, const Eigen::Ref<const VecX<double>>& v, double h);

/// Computes q <- q (+) h v for all coordinates of one part. v: velocities of all parts.
void advance_whole_part(const PartModel& m, VecX<double>& q, const VecX<double>& v, double h);

/// Returns the entries (c_dot, omega, q_s_dot) of a part in the velocities v of all parts.
inline auto part_velocities(const PartModel& m, VecX<double>& v) {
  return v.segment(m.v0, 6 + m.n_s);
}
inline auto part_velocities(const PartModel& m, const VecX<double>& v) {
  return v.segment(m.v0, 6 + m.n_s);
}

/// Returns v_r = (R^T c_dot, omega, q_s_dot) of a part from (c_dot, omega, q_s_dot). w must contain the
/// rotation R of the part.
VecMax<double> body_velocity(const PartWorkspace<double>& w, const Eigen::Ref<const VecX<double>>& v);
/// Returns (c_dot, omega, q_s_dot) of a part from v_r = (R^T c_dot, omega, q_s_dot).
VecMax<double> world_velocity(const PartWorkspace<double>& w, const Eigen::Ref<const VecX<double>>& v_r);

/// Sets the entries of a part in v from its velocities x in a group (constraint/group.h). For a part that
/// deforms locally, x contains only v_r and d_dot of the points of its joints. The function finds the
/// impulses, on v_r and at these points, that change the present velocities to x. The velocities of the local
/// coordinates change by the response to these impulses.
void scatter_velocity(const PartModel& m, const PartWorkspace<double>& w,
                      const Eigen::Ref<const VecX<double>>& x, VecX<double>& v);
/// Computes q <- q (+) h x for one part, with its velocities x in a group. q_d changes by h times the
/// velocities of the local coordinates that scatter_velocity() gives a part at rest.
void advance_part_in_group(const PartModel& m, const PartWorkspace<double>& w,
                           const Eigen::Ref<const VecX<double>>& x, double h, VecX<double>& q);

/// Normalises every quaternion.
void normalise_rotations(const Model& model, VecX<double>& q);

/// Sets the velocities that had no inertia at the last evaluation to zero, for instance the rate of a
/// parameter that moves no mass.
void zero_inertialess_velocities(const Model& model, const Workspace<double>& work, VecX<double>& v);

}  // namespace pliant
