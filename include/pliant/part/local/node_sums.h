// Sums over the nodes of a part, four nodes at a time, and the velocities G v_r of the nodes for d_dot = 0,
// with v_r = (R^T c_dot, omega, q_s_dot) and G = [I, -[p]x, J] (include/pliant/part/README.md).
#pragma once

#include <Eigen/Geometry>

#include <pliant/local/solid/four_nodes.h>
#include <pliant/part/axial.h>
#include <pliant/part/local/nodal_deformation.h>

namespace pliant::node_sums {

/// The sum of a b^T over nodes.
struct OuterSum {
  Pack lanes[3][3];
  OuterSum() {
    for (auto& row : lanes)
      for (Pack& x : row) x = Pack(0.0);
  }
  void add(const Vec3<Pack>& a, const Vec3<Pack>& b) {
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) lanes[i][j] += a[i] * b[j];
  }
  Mat3<double> total() const {
    Mat3<double> m;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) m(i, j) = sum(lanes[i][j]);
    return m;
  }
};
/// The sum of vectors over nodes.
struct VectorSum {
  Vec3<Pack> lanes = Vec3<Pack>::Constant(Pack(0.0));
  void add(const Vec3<Pack>& a) {
    for (int r = 0; r < 3; ++r) lanes[r] += a[r];
  }
  Vec3<double> total() const { return {sum(lanes[0]), sum(lanes[1]), sum(lanes[2])}; }
};

inline Vec3<Pack> times(const Pack& m, const Vec3<Pack>& a) {
  return {m * a[0], m * a[1], m * a[2]};
}
/// Returns the vector a in all lanes.
inline Vec3<Pack> spread(const Vec3<double>& a) {
  return {Pack(a[0]), Pack(a[1]), Pack(a[2])};
}
inline Vec3<Pack> plus(const Vec3<Pack>& a, const Vec3<Pack>& b) {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}
/// Returns the cross product. Compilers do not inline Eigen's cross product of Packs.
[[gnu::always_inline]] inline Vec3<Pack> cross(const Vec3<Pack>& a, const Vec3<Pack>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

inline bool any_nonzero(const Eigen::Ref<const VecX<double>>& x) {
  return (x.array() != 0).any();
}

/// Returns ds/dq_c of all n nodes for dynamic parameter number c, m per unit of the parameter: n numbers
/// along x, then n along y, then n along z.
inline const double* column(const NodalWorkspace& w, Eigen::Index n, int c) {
  return w.J.data() + 3 * n * c;
}

/// The velocities G v_r of nodes: v_c + omega x p + J v_s. `all` is v_r = (v_c, omega, v_s).
struct FrameMotion {
  Vec3<Pack> c, omega;
  const VecMax<double>& v;
  const NodalWorkspace& w;
  Eigen::Index n;

  FrameMotion(const VecMax<double>& all, const NodalWorkspace& work, Eigen::Index n_nodes)
      : c(spread(all.head<3>())), omega(spread(all.segment<3>(3))), v(all), w(work), n(n_nodes) {}
  /// Returns v_c + omega x p.
  Vec3<Pack> rigid(const Vec3<Pack>& p) const { return plus(c, cross(omega, p)); }
  /// Returns J v_s.
  template <class Four>
  Vec3<Pack> shape(const Four& four) const {
    Vec3<Pack> sum = Vec3<Pack>::Constant(Pack(0.0));
    for (int k = 6; k < v.size(); ++k) {
      const Vec3<Pack> J = four.load(column(w, n, k - 6), n);
      for (int r = 0; r < 3; ++r) sum[r] += J[r] * Pack(v[k]);
    }
    return sum;
  }
};

/// Returns the sum of ds/dq_k . F over the n nodes: the generalised force on dynamic parameter number k. F:
/// forces on the nodes (N) in the layout of column().
inline double along_column(const double* F, const NodalWorkspace& w, Eigen::Index n, int k) {
  Pack along(0.0);
  for_each_four(n, [&](const auto& four) { along += four.load(column(w, n, k), n).dot(four.load(F, n)); });
  return sum(along);
}

}  // namespace pliant::node_sums
