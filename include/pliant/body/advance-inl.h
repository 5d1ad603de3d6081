// Function bodies of advance.h: changes of coordinates and velocities of parts.
#pragma once

#include <pliant/body/advance.h>
#include <pliant/math/header_only.h>
#include <pliant/math/rotation.h>

namespace pliant {

PLIANT_INLINE void advance_part(const PartModel& m, VecX<double>& q, const Eigen::Ref<const VecX<double>>& v,
                                double h) {
  q.segment<3>(m.q0) += h * v.head<3>();
  auto theta = q.segment<4>(m.q0 + 3);
  const Eigen::Quaterniond now =
      (Eigen::Quaterniond(theta[0], theta[1], theta[2], theta[3]) * quaternion(h * v.segment<3>(3)))
          .normalized();
  theta << now.w(), now.x(), now.y(), now.z();
  q.segment(m.q0 + 7, m.n_s) += h * v.tail(m.n_s);
}

PLIANT_INLINE void advance_whole_part(const PartModel& m, VecX<double>& q, const VecX<double>& v, double h) {
  advance_part(m, q, part_velocities(m, v), h);
  q.segment(m.q0 + 7 + m.n_s, m.n_d()) += h * v.segment(m.v0 + 6 + m.n_s, m.n_d());
}

PLIANT_INLINE void advance_coordinates(const Model& model, VecX<double>& q, const VecX<double>& v, double h) {
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0) advance_whole_part(m, q, v, h);
}

PLIANT_INLINE VecMax<double> body_velocity(const PartWorkspace<double>& w,
                                           const Eigen::Ref<const VecX<double>>& v) {
  VecMax<double> v_r = v;
  v_r.head<3>() = w.R.transpose() * v.head<3>();
  return v_r;
}

PLIANT_INLINE VecMax<double> world_velocity(const PartWorkspace<double>& w,
                                            const Eigen::Ref<const VecX<double>>& v_r) {
  VecMax<double> v = v_r;
  v.head<3>() = w.R * v_r.head<3>();
  return v;
}

PLIANT_INLINE void scatter_velocity(const PartModel& m, const PartWorkspace<double>& w,
                                    const Eigen::Ref<const VecX<double>>& x, VecX<double>& v) {
  if (m.local != nullptr) {
    VecX<double> change(x.size());
    gather_velocity(m, w, v, change);
    change = w.local->A_inverse * (x - change);
    m.local->push_all(m.joint_points, change, *w.local, v.segment(m.v0 + 6 + m.n_s, m.n_d()));
  }
  part_velocities(m, v) = x.head(6 + m.n_s);
  v.segment<3>(m.v0) = w.R * x.head<3>();
}

PLIANT_INLINE void advance_part_in_group(const PartModel& m, const PartWorkspace<double>& w,
                                         const Eigen::Ref<const VecX<double>>& x, double h, VecX<double>& q) {
  advance_part(m, q, world_velocity(w, x.head(6 + m.n_s)), h);
  if (m.local != nullptr)
    m.local->push_all(m.joint_points, w.local->A_inverse * (h * x), *w.local,
                      q.segment(m.q0 + 7 + m.n_s, m.n_d()));
}

PLIANT_INLINE void normalise_rotations(const Model& model, VecX<double>& q) {
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0) q.segment<4>(m.q0 + 3).normalize();
}

PLIANT_INLINE void zero_inertialess_velocities(const Model& model, const Workspace<double>& work,
                                               VecX<double>& v) {
  for (std::size_t i = 0; i < work.without_inertia.size(); ++i) {
    if (work.without_inertia[i] == 0) continue;
    const PartModel& m = model.parts()[i];
    for (int k = 0; k < 6 + m.n_s; ++k)
      if (work.parts[i].without_inertia(k)) v[m.v0 + k] = 0;
  }
}

}  // namespace pliant
