// Tetrahedral elements: x(L) = sum_a N_a(L) x_a with barycentric coordinates L_0 .. L_3; xi_k = L_k, k
// = 1..3.
//   4 nodes    N_a = L_a
//   10 nodes   N_a = L_a (2 L_a - 1) at corners, 4 L_a L_b on the edges 01 12 20 03 13 23
// Rules: weights over the reference tetrahedron (volume 1/6). Stiffness: exact to degree 1 and 3, so that a
// uniform stress is in balance on curved elements as well. Mass: degree 5 (Walkington 2000).
#pragma once

#include <array>

#include <pliant/math/types.h>

namespace pliant {

struct TetrahedronPoint {
  std::array<double, 4> L;
  double weight;
};

namespace detail {

template <std::size_t N>
constexpr void add_corner_orbit(std::array<TetrahedronPoint, N>& points, std::size_t& n, double a,
                                double share) {
  for (std::size_t c = 0; c < 4; ++c, ++n) {
    points[n] = {{a, a, a, a}, share / 6};
    points[n].L[c] = 1 - 3 * a;
  }
}

constexpr std::array<TetrahedronPoint, 8> eight_points() {
  std::array<TetrahedronPoint, 8> points{};
  std::size_t n = 0;
  add_corner_orbit(points, n, 0.3281633025163817, 0.1362178425370874);
  add_corner_orbit(points, n, 0.1080472498984286, 0.1137821574629126);
  return points;
}

constexpr std::array<TetrahedronPoint, 14> fourteen_points() {
  std::array<TetrahedronPoint, 14> points{};
  std::size_t n = 0;
  add_corner_orbit(points, n, 0.3108859192633006098, 0.1126879257180158508);
  add_corner_orbit(points, n, 0.0927352503108912264, 0.0734930431163619495);
  const double a = 0.0455037041256496495;
  for (std::size_t c = 0; c < 4; ++c)
    for (std::size_t d = c + 1; d < 4; ++d, ++n) {
      points[n] = {{a, a, a, a}, 0.0425460207770814664 / 6};
      points[n].L[c] = points[n].L[d] = 0.5 - a;
    }
  return points;
}

}  // namespace detail

/// Ends of the edges of a tetrahedron, in the order of the nodes on them.
inline constexpr std::array<std::array<std::size_t, 2>, 6> kTetrahedronEdges{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

inline constexpr std::array<TetrahedronPoint, 14> kTetrahedronMassRule = detail::fourteen_points();

struct LinearTetrahedron {
  static constexpr int n_nodes = 4;
  static constexpr std::array<TetrahedronPoint, 1> rule{{{{0.25, 0.25, 0.25, 0.25}, 1.0 / 6}}};

  static Vec<double, 4> N(const TetrahedronPoint& at) {
    return Eigen::Map<const Vec<double, 4>>(at.L.data());
  }

  /// dx/dxi, one column for each xi_k, of nodal vectors x.
  template <class T>
  static Mat3<T> gradient(const TetrahedronPoint&, const Vec3<T>* x) {
    Mat3<T> D;
    for (int k = 0; k < 3; ++k)
      for (int r = 0; r < 3; ++r) D(r, k) = x[k + 1][r] - x[0][r];
    return D;
  }
  /// f_a += Q dN_a/dxi, the transpose of gradient().
  template <class T>
  static void push(const TetrahedronPoint&, const Mat3<T>& Q, Vec3<T>* f) {
    for (int r = 0; r < 3; ++r) {
      f[0][r] -= Q(r, 0) + Q(r, 1) + Q(r, 2);
      for (int k = 0; k < 3; ++k) f[k + 1][r] += Q(r, k);
    }
  }
};

struct QuadraticTetrahedron {
  static constexpr int n_nodes = 10;
  static constexpr std::array<TetrahedronPoint, 8> rule = detail::eight_points();

  static Vec<double, 10> N(const TetrahedronPoint& at) {
    Vec<double, 10> n;
    for (int a = 0; a < 4; ++a)
      n[a] = at.L[static_cast<std::size_t>(a)] * (2 * at.L[static_cast<std::size_t>(a)] - 1);
    for (std::size_t e = 0; e < 6; ++e)
      n[static_cast<Eigen::Index>(4 + e)] = 4 * at.L[kTetrahedronEdges[e][0]] * at.L[kTetrahedronEdges[e][1]];
    return n;
  }

  /// By way of dx/dL_c: dN_c/dL_c = 4 L_c - 1, and 4 L_d for the node between c and d.
  template <class T>
  static Mat3<T> gradient(const TetrahedronPoint& at, const Vec3<T>* x) {
    Mat3<T> D;
    for (int r = 0; r < 3; ++r) {
      T along[4];
      for (std::size_t c = 0; c < 4; ++c) along[c] = x[c][r] * T(4 * at.L[c] - 1);
      for (std::size_t e = 0; e < 6; ++e) {
        const auto [c, d] = kTetrahedronEdges[e];
        along[c] += x[4 + e][r] * T(4 * at.L[d]);
        along[d] += x[4 + e][r] * T(4 * at.L[c]);
      }
      for (int k = 0; k < 3; ++k) D(r, k) = along[k + 1] - along[0];
    }
    return D;
  }
  template <class T>
  static void push(const TetrahedronPoint& at, const Mat3<T>& Q, Vec3<T>* f) {
    for (int r = 0; r < 3; ++r) {
      const T along[4]{-(Q(r, 0) + Q(r, 1) + Q(r, 2)), Q(r, 0), Q(r, 1), Q(r, 2)};
      for (std::size_t c = 0; c < 4; ++c) f[c][r] += along[c] * T(4 * at.L[c] - 1);
      for (std::size_t e = 0; e < 6; ++e) {
        const auto [c, d] = kTetrahedronEdges[e];
        f[4 + e][r] += along[c] * T(4 * at.L[d]) + along[d] * T(4 * at.L[c]);
      }
    }
  }
};

}  // namespace pliant
