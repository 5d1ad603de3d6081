#include <pliant/integrate/advance.h>

#include <pliant/math/sinc.h>

namespace pliant {

void advance_part(const PartModel& m, VecX<double>& q, const VecX<double>& v, double h) {
  q.segment<3>(m.q0) += h * v.segment<3>(m.v0);
  const Vec3<double> half = 0.5 * h * v.segment<3>(m.v0 + 3);
  const double angle = half.norm();
  const math::SinCos<double> of_angle = math::sin_cos(angle);
  const Vec3<double> axis = sinc(angle, of_angle) * half;
  const Eigen::Quaterniond turn(of_angle.cos, axis[0], axis[1], axis[2]);
  auto theta = q.segment<4>(m.q0 + 3);
  const Eigen::Quaterniond now =
      (Eigen::Quaterniond(theta[0], theta[1], theta[2], theta[3]) * turn).normalized();
  theta << now.w(), now.x(), now.y(), now.z();
  q.segment(m.q0 + 7, m.n_s) += h * v.segment(m.v0 + 6, m.n_s);
}

void advance_coordinates(const Model& model, VecX<double>& q, const VecX<double>& v, double h) {
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0) advance_part(m, q, v, h);
}

void take_velocity(const PartModel& m, const PartWorkspace<double>& w, const VecMax<double>& v_r,
                   VecX<double>& v) {
  v.segment<3>(m.v0) = w.R * v_r.head<3>();
  v.segment(m.v0 + 3, 3 + m.n_s) = v_r.tail(3 + m.n_s);
}

void normalise_rotations(const Model& model, VecX<double>& q) {
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0) q.segment<4>(m.q0 + 3).normalize();
}

void hold_inertialess(const Model& model, const Workspace<double>& work, VecX<double>& v) {
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    if (m.q0 < 0 || !work.parts[i].any_held()) continue;
    for (int k = 0; k < 6 + m.n_s; ++k)
      if (work.parts[i].held(k)) v[m.v0 + k] = 0;
  }
}

}  // namespace pliant
