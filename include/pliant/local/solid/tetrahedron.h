// Tetrahedral elements: x(L) = sum_a N_a(L) x_a with barycentric coordinates L_0 .. L_3. The reference
// coordinates are xi_k = L_k, k = 1..3.
//   4 nodes    N_a = L_a
//   10 nodes   N_a = L_a (2 L_a - 1) at corners, 4 L_a L_b on the edges 01 12 20 03 13 23
//   15 nodes   the 10-node functions enriched with bubbles: 27 L_a L_b L_c on faces (node 10 + f is on the
//              face without corner f) and 256 L_0 L_1 L_2 L_3 in the middle (node 14). With the
//              bubbles the lumped masses are positive. Frequencies of vibration converge with fourth order
//              (Geevers, Mulder & van der Vegt 2018).
// Weights of quadrature rules sum to the volume 1/6 of the reference tetrahedron. The stiffness rules are
// exact for degree 1 (4 nodes), 3 (10 nodes) and 5 (15 nodes), so that the nodal forces of a uniform stress
// are in balance even on curved elements. With 15 nodes a small imbalance remains if the rest positions of an
// element have a nonzero bubble coefficient on a face inside the solid or in the middle. The mass rule is
// exact for degree 5 (Walkington 2000): M of straight elements is exact for 4 and 10 nodes, but not for 15
// nodes.
#pragma once

#include <array>

#include <pliant/math/types.h>

namespace pliant {

/// A quadrature point: barycentric coordinates and weight.
struct TetrahedronPoint {
  std::array<double, 4> L;
  double weight;
};

namespace detail {

/// Stores the four quadrature points with one coordinate 1 - 3 a and three coordinates a in points[n] ..
/// points[n + 3], and adds 4 to n. share: weight of each point divided by the volume of the tetrahedron.
template <std::size_t N>
constexpr void add_corner_orbit(std::array<TetrahedronPoint, N>& points, std::size_t& n, double a,
                                double share) {
  for (std::size_t c = 0; c < 4; ++c, ++n) {
    points[n] = {{a, a, a, a}, share / 6};
    points[n].L[c] = 1 - 3 * a;
  }
}

/// Rule with 8 points, exact for polynomials of degree 3.
constexpr std::array<TetrahedronPoint, 8> eight_points() {
  std::array<TetrahedronPoint, 8> points{};
  std::size_t n = 0;
  add_corner_orbit(points, n, 0.3281633025163817, 0.1362178425370874);
  add_corner_orbit(points, n, 0.1080472498984286, 0.1137821574629126);
  return points;
}

/// Rule with 14 points, exact for polynomials of degree 5 (Walkington 2000).
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

/// Corners at the ends of each edge. Node 4 + e is the midpoint of edge e.
inline constexpr std::array<std::array<std::size_t, 2>, 6> kTetrahedronEdges{
    {{0, 1}, {1, 2}, {2, 0}, {0, 3}, {1, 3}, {2, 3}}};

/// Rule of the consistent mass matrix of all elements, exact for degree 5.
inline constexpr std::array<TetrahedronPoint, 14> kTetrahedronMassRule = detail::fourteen_points();

/// Members of every element: the quadrature rule of the stiffness, the shape functions N, the gradient of
/// nodal vectors and the transpose of the gradient. T: double, Pack or a dual number.
struct LinearTetrahedron {
  static constexpr int n_nodes = 4;
  static constexpr std::array<TetrahedronPoint, 1> rule{{{{0.25, 0.25, 0.25, 0.25}, 1.0 / 6}}};

  static Vec<double, 4> N(const TetrahedronPoint& at) {
    return Eigen::Map<const Vec<double, 4>>(at.L.data());
  }

  /// Returns dx/dxi of nodal vectors x, one column for each xi_k.
  template <class T>
  static Mat3<T> gradient(const TetrahedronPoint&, const Vec3<T>* x) {
    Mat3<T> D;
    for (int k = 0; k < 3; ++k)
      for (int r = 0; r < 3; ++r) D(r, k) = x[k + 1][r] - x[0][r];
    return D;
  }
  /// Adds Q dN_a/dxi to f_a at each node: the transpose of gradient().
  template <class T>
  static void add_nodal_forces(const TetrahedronPoint&, const Mat3<T>& Q, Vec3<T>* f) {
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

  /// Computes dx/dxi from dx/dL_c, with dN_c/dL_c = 4 L_c - 1 and dN/dL_c = 4 L_d for the node between
  /// corners c and d.
  template <class T>
  static Mat3<T> gradient(const TetrahedronPoint& at, const Vec3<T>* x) {
    Mat3<T> D;
    for (int r = 0; r < 3; ++r) {
      T dx_dL[4];
      for (std::size_t c = 0; c < 4; ++c) dx_dL[c] = x[c][r] * T(4 * at.L[c] - 1);
      for (std::size_t e = 0; e < 6; ++e) {
        const auto [c, d] = kTetrahedronEdges[e];
        dx_dL[c] += x[4 + e][r] * T(4 * at.L[d]);
        dx_dL[d] += x[4 + e][r] * T(4 * at.L[c]);
      }
      for (int k = 0; k < 3; ++k) D(r, k) = dx_dL[k + 1] - dx_dL[0];
    }
    return D;
  }
  template <class T>
  static void add_nodal_forces(const TetrahedronPoint& at, const Mat3<T>& Q, Vec3<T>* f) {
    for (int r = 0; r < 3; ++r) {
      const T Q_L[4]{-(Q(r, 0) + Q(r, 1) + Q(r, 2)), Q(r, 0), Q(r, 1), Q(r, 2)};
      for (std::size_t c = 0; c < 4; ++c) f[c][r] += Q_L[c] * T(4 * at.L[c] - 1);
      for (std::size_t e = 0; e < 6; ++e) {
        const auto [c, d] = kTetrahedronEdges[e];
        f[4 + e][r] += Q_L[c] * T(4 * at.L[d]) + Q_L[d] * T(4 * at.L[c]);
      }
    }
  }
};

struct EnrichedTetrahedron {
  static constexpr int n_nodes = 15;
  static constexpr std::array<TetrahedronPoint, 14> rule = kTetrahedronMassRule;

  static Vec<double, 15> N(const TetrahedronPoint& at) {
    const Vec<double, 10> quadratic = QuadraticTetrahedron::N(at);
    const double all = at.L[0] * at.L[1] * at.L[2] * at.L[3];
    Vec<double, 15> n;
    for (int a = 0; a < n_nodes; ++a) {
      Vec3<double> unit[n_nodes];
      for (Vec3<double>& x : unit) x.setZero();
      unit[a][0] = 1;
      double face[4], middle;
      bubbles(unit, 0, face, middle);
      n[a] = (a < 10 ? quadratic[a] : 0) + 256 * all * middle;
      for (std::size_t f = 0; f < 4; ++f) n[a] += face[f] * 27 * product_without(at, f);
    }
    return n;
  }

  template <class T>
  static Mat3<T> gradient(const TetrahedronPoint& at, const Vec3<T>* x) {
    Mat3<T> D = QuadraticTetrahedron::gradient(at, x);
    for (int r = 0; r < 3; ++r) {
      T face[4], middle, dx_dL[4];
      bubbles(x, r, face, middle);
      for (std::size_t c = 0; c < 4; ++c) {
        dx_dL[c] = middle * T(256 * product_without(at, c));
        for (std::size_t f = 0; f < 4; ++f)
          if (f != c) dx_dL[c] += face[f] * T(27 * product_without(at, c, f));
      }
      for (int k = 0; k < 3; ++k) D(r, k) += dx_dL[k + 1] - dx_dL[0];
    }
    return D;
  }
  template <class T>
  static void add_nodal_forces(const TetrahedronPoint& at, const Mat3<T>& Q, Vec3<T>* f) {
    QuadraticTetrahedron::add_nodal_forces(at, Q, f);
    for (int r = 0; r < 3; ++r) {
      const T Q_L[4]{-(Q(r, 0) + Q(r, 1) + Q(r, 2)), Q(r, 0), Q(r, 1), Q(r, 2)};
      // Forces on the bubble coefficients, then on the nodes by the transpose of bubbles().
      T middle(0.0), corners(0.0), edges(0.0), face[4];
      for (std::size_t c = 0; c < 4; ++c) middle += Q_L[c] * T(256 * product_without(at, c));
      for (std::size_t g = 0; g < 4; ++g) {
        face[g] = middle * T(-27.0 / 64);
        for (std::size_t c = 0; c < 4; ++c)
          if (c != g) face[g] += Q_L[c] * T(27 * product_without(at, c, g));
        f[10 + g][r] += face[g];
        corners += face[g];
      }
      edges = corners * T(-4.0 / 9) - middle * T(0.25);
      corners = corners * T(1.0 / 9) + middle * T(0.125);
      f[14][r] += middle;
      for (std::size_t c = 0; c < 4; ++c) f[c][r] += corners - face[c] * T(1.0 / 9);
      for (std::size_t e = 0; e < 6; ++e)
        f[4 + e][r] += edges + (face[kTetrahedronEdges[e][0]] + face[kTetrahedronEdges[e][1]]) * T(4.0 / 9);
    }
  }

  /// Computes the coefficients of the four face bubbles (face) and of the middle bubble (middle), for
  /// component r of nodal vectors x. A coefficient is the nodal value at the bubble's node minus the value
  /// that the quadratic functions have there. For the middle bubble the values of the face bubbles are
  /// subtracted too.
  template <class T>
  static void bubbles(const Vec3<T>* x, int r, T* face, T& middle) {
    T corners = x[0][r] + x[1][r] + x[2][r] + x[3][r], edges(0.0), faces(0.0);
    for (std::size_t e = 0; e < 6; ++e) edges += x[4 + e][r];
    for (std::size_t f = 0; f < 4; ++f) {
      T around = edges;  // becomes the sum over the three edges of the face
      for (std::size_t e = 0; e < 6; ++e)
        if (kTetrahedronEdges[e][0] == f || kTetrahedronEdges[e][1] == f) around -= x[4 + e][r];
      face[f] = x[10 + f][r] + (corners - x[f][r]) * T(1.0 / 9) - around * T(4.0 / 9);
      faces += face[f];
    }
    middle = x[14][r] + corners * T(0.125) - edges * T(0.25) - faces * T(27.0 / 64);
  }

 private:
  /// Returns the product of the barycentric coordinates without L_c, and without L_f if f < 4.
  static constexpr double product_without(const TetrahedronPoint& at, std::size_t c, std::size_t f = 4) {
    double product = 1;
    for (std::size_t d = 0; d < 4; ++d)
      if (d != c && d != f) product *= at.L[d];
    return product;
  }
};

/// Nodes of the enriched element. The weight of a node is its share of the volume 1/6 of the reference
/// tetrahedron; the lumped masses use these weights.
inline constexpr std::array<TetrahedronPoint, 15> kEnrichedNodes = [] {
  std::array<TetrahedronPoint, 15> nodes{};
  for (std::size_t c = 0; c < 4; ++c) {
    nodes[c].L[c] = 1;
    nodes[c].weight = 17.0 / 5040;
    nodes[10 + c] = {{1.0 / 3, 1.0 / 3, 1.0 / 3, 1.0 / 3}, 9.0 / 560};
    nodes[10 + c].L[c] = 0;
  }
  for (std::size_t e = 0; e < 6; ++e) {
    for (std::size_t end : kTetrahedronEdges[e]) nodes[4 + e].L[end] = 0.5;
    nodes[4 + e].weight = 2.0 / 315;
  }
  nodes[14] = {{0.25, 0.25, 0.25, 0.25}, 16.0 / 315};
  return nodes;
}();

}  // namespace pliant
