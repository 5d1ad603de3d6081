// Function bodies of NodalDeformation (nodal_deformation.h): the reference conditions of the frame, and the
// effect of changes of the frame on the nodes; energies and momenta of the part; the mobility of a point;
// bounds of stiffness for the length of a step.
#pragma once

#include <pliant/math/header_only.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/local/node_sums.h>

namespace pliant {

PLIANT_INLINE NodalDeformation::ConditionViolation NodalDeformation::violation(
    const Eigen::Ref<const Nodes>& d, const Eigen::Ref<const Nodes>& d_dot,
    const LocalWorkspace& work) const {
  using namespace node_sums;
  const NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  VectorSum md, mv, s_mv;
  OuterSum ds;
  for_each_four(n, [&](const auto& four) {
    const Pack m = four.load(inertia_.data());
    const Vec3<Pack> s = four.load(w.s.data(), n), m_d = times(m, four.load(d.data(), n)),
                     m_v = times(m, four.load(d_dot.data(), n));
    md.add(m_d);
    mv.add(m_v);
    ds.add(m_d, s);
    s_mv.add(cross(s, m_v));
  });
  ConditionViolation violation;
  violation.d_s = ds.total();
  violation.W_d << md.total(), -axial(violation.d_s);
  violation.W_d_dot << mv.total(), s_mv.total();
  return violation;
}

PLIANT_INLINE VecMax<double> NodalDeformation::frame_share(const Eigen::Ref<const Nodes>& a,
                                                           const LocalWorkspace& work) const {
  using namespace node_sums;
  const NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes(), n_s = w.H0.rows() - 6;
  VecMax<double> on_frame(6 + n_s);
  VectorSum sum_a, s_a;
  for_each_four(n, [&](const auto& four) {
    const Vec3<Pack> ma = times(four.load(inertia_.data()), four.load(a.data(), n));
    sum_a.add(ma);
    s_a.add(cross(four.load(w.s.data(), n), ma));
  });
  on_frame.head<3>() = sum_a.total();
  on_frame.segment<3>(3) = s_a.total();
  for (int k = 0; k < n_s; ++k) {
    Pack along(0.0);
    for_each_four(n, [&](const auto& four) {
      along += four.load(inertia_.data()) * four.load(column(w, n, k), n).dot(four.load(a.data(), n));
    });
    on_frame[6 + k] = sum(along);
  }
  return on_frame;
}

PLIANT_INLINE void NodalDeformation::add_frame_velocities(const VecMax<double>& v_r, double sign,
                                                          const LocalWorkspace& work, const double* from,
                                                          double* to) const {
  using namespace node_sums;
  const NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  const VecMax<double> v = sign * v_r;
  const FrameMotion frame(v, w, n);
  for_each_four(n, [&](const auto& four) {
    Vec3<Pack> by_frame = frame.rigid(four.load(w.x.data(), n));
    if (v.size() > 6) by_frame = plus(by_frame, frame.shape(four));
    four.store(to, n, plus(four.load(from, n), by_frame));
  });
}

PLIANT_INLINE void NodalDeformation::move_frame(const Vec3<double>& shift, const Mat3<double>& turn, Nodes& p,
                                                Nodes& u) const {
  using namespace node_sums;
  const Eigen::Index n = n_nodes();
  const Vec3<Pack> from = spread(-shift),
                   row[3] = {spread(turn.col(0)), spread(turn.col(1)), spread(turn.col(2))};
  for_each_four(n, [&](const auto& four) {
    const Vec3<Pack> x = plus(four.load(p.data(), n), from), v = four.load(u.data(), n);
    Vec3<Pack> x_now, v_now;
    for (int r = 0; r < 3; ++r) {
      x_now[r] = row[r].dot(x);
      v_now[r] = row[r].dot(v);
    }
    four.store(p.data(), n, x_now);
    four.store(u.data(), n, v_now);
  });
}

PLIANT_INLINE LocalMotion NodalDeformation::motion(const VecX<double>& v_r,
                                                   const LocalWorkspace& work) const {
  using namespace node_sums;
  const NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  const VecMax<double> v = v_r;
  const FrameMotion frame(v, w, n);
  VectorSum P, L, moment;
  Pack twice(0.0);
  for_each_four(n, [&](const auto& four) {
    const Pack m = four.load(inertia_.data());
    const Vec3<Pack> p = four.load(w.x.data(), n);
    const Vec3<Pack> velocity = plus(frame.rigid(p), four.load(w.rates_of_p(n), n));
    const Vec3<Pack> momentum = times(m, velocity);
    twice += momentum.dot(velocity);
    P.add(momentum);
    L.add(cross(p, momentum));
    moment.add(times(m, p));
  });
  const Eigen::Index own = n_d() - 3 * n;
  LocalMotion all{0.5 * sum(twice), 0, P.total(), L.total(), moment.total()};
  all.kinetic += 0.5 * w.d_dot.tail(own).dot(inertia_.tail(own).cwiseProduct(w.d_dot.tail(own)));
  all.elastic = w.law_factor * elastic_energy(w);
  return all;
}

PLIANT_INLINE LocalDeformation::Bound NodalDeformation::stiffness_bound(const LocalWorkspace& work) const {
  Bound bound;
  for (const auto& energy : energies_) {
    const bool of_d = energy->of() == NodalEnergy::Of::displacement;
    const double omega2 = work.law_factor * energy->frequency_bound(of_d ? work.d : of(work).x, inertia_);
    bound.K += omega2;
    bound.D += beta() * omega2;
  }
  return bound;
}

PLIANT_INLINE double NodalDeformation::mobility(const NodeWeights& at) const {
  double sum = 0;
  for (std::size_t k = 0; k < at.node.size(); ++k) sum += at.weight[k] * at.weight[k] * mobility_[at.node[k]];
  return sum;
}

}  // namespace pliant
