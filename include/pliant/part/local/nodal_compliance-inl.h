// Function bodies of NodalDeformation: the response to impulses of joints and limits, M^-1.
#pragma once

#include <vector>

#include <pliant/math/header_only.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/local/node_sums.h>

namespace pliant {

namespace detail {

/// Returns G of points, 3 rows for each point, from positions x of the n nodes; G0 if x is s. n_r: 6 + n_s.
inline MatX<double> frame_at_points(const std::vector<NodeWeights>& points, const double* x,
                                    const NodalWorkspace& w, Eigen::Index n, Eigen::Index n_r) {
  const auto n_p = static_cast<Eigen::Index>(points.size());
  MatX<double> G(3 * n_p, n_r);
  const VecX<double> at = at_points(points, Eigen::Map<const Nodes>(x, n, 3));
  for (Eigen::Index k = 0; k < n_p; ++k) {
    G.block<3, 3>(3 * k, 0).setIdentity();
    G.block<3, 3>(3 * k, 3) = -skew(Vec3<double>(at.segment<3>(3 * k)));
  }
  for (Eigen::Index k = 6; k < n_r; ++k)
    G.col(k) =
        at_points(points, Eigen::Map<const Nodes>(node_sums::column(w, n, static_cast<int>(k) - 6), n, 3));
  return G;
}

}  // namespace detail

PLIANT_INLINE MatX<double> NodalDeformation::inertial_compliance(const std::vector<NodeWeights>& points,
                                                                 LocalWorkspace& work) const {
  NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes(), n_r = w.H0.rows(), n_p = 3 * static_cast<Eigen::Index>(points.size());
  const MatX<double> G = detail::frame_at_points(points, w.x.data(), w, n, n_r),
                     G0 = detail::frame_at_points(points, w.s.data(), w, n, n_r);
  // Solve the equations of nodal_deformation.h for unit impulses on v_r and on the points, one in each
  // column. An impulse at a point acts on d alone and belongs to F and F_d; an impulse on v_r is f. on_d is
  // sum G^T F_d - f, and loads is sum G0^T F.
  MatX<double> on_d(n_r, n_r + n_p), loads = MatX<double>::Zero(n_r, n_r + n_p);
  on_d << -MatX<double>::Identity(n_r, n_r), G.transpose();
  loads.rightCols(n_p) = G0.transpose();
  w.kappa_response = w.solve(on_d);
  loads -= w.H0 * w.kappa_response;
  w.a_response = w.solve_transposed(loads);
  MatX<double> A(n_r + n_p, n_r + n_p);
  A.topRows(n_r) = w.a_response;
  A.bottomRows(n_p) = -G0 * w.kappa_response - G * w.a_response;
  // Add the compliance 1/m of each node that two points share, times both weights.
  VecX<double> weight_in_b = VecX<double>::Zero(n);
  for (std::size_t b = 0; b < points.size(); ++b) {
    for (std::size_t j = 0; j < points[b].node.size(); ++j)
      weight_in_b[points[b].node[j]] += points[b].weight[j];
    for (std::size_t a = 0; a < points.size(); ++a) {
      double share = 0;
      for (std::size_t i = 0; i < points[a].node.size(); ++i)
        share += points[a].weight[i] * weight_in_b[points[a].node[i]] * mobility_[points[a].node[i]];
      A.block<3, 3>(n_r + 3 * static_cast<Eigen::Index>(a), n_r + 3 * static_cast<Eigen::Index>(b))
          .diagonal()
          .array() += share;
    }
    for (const int node : points[b].node) weight_in_b[node] = 0;
  }
  return 0.5 * (A + A.transpose());
}

PLIANT_INLINE void NodalDeformation::inertial_push_all(const std::vector<NodeWeights>& points,
                                                       const VecX<double>& g, const LocalWorkspace& work,
                                                       Eigen::Ref<VecX<double>> d_dot) const {
  using namespace node_sums;
  const NodalWorkspace& w = of(work);
  const Eigen::Index n = n_nodes();
  const VecMax<double> kappa = w.kappa_response * g, a = w.a_response * g;
  const FrameMotion by_conditions(kappa, w, n), frame(a, w, n);
  for_each_four(n, [&](const auto& four) {
    const Vec3<Pack> by_kappa =
                         plus(by_conditions.rigid(four.load(w.s.data(), n)), by_conditions.shape(four)),
                     by_frame = plus(frame.rigid(four.load(w.x.data(), n)), frame.shape(four));
    Vec3<Pack> v = four.load(d_dot.data(), n);
    for (int r = 0; r < 3; ++r) v[r] -= by_kappa[r] + by_frame[r];
    four.store(d_dot.data(), n, v);
  });
  const Eigen::Index n_r = w.H0.rows();
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t i = 0; i < points[k].node.size(); ++i) {
      const int node = points[k].node[i];
      for (int r = 0; r < 3; ++r)
        d_dot[node + r * n] +=
            points[k].weight[i] * mobility_[node] * g[n_r + 3 * static_cast<Eigen::Index>(k) + r];
    }
}

}  // namespace pliant
