// Upper bound on omega^2 of K u = omega^2 M u from single elements. The mass of each node is split among its
// elements in proportion to their volumes, M = sum of M_e. Then the largest omega^2 is at most the largest
// omega^2 of K_e u = omega^2 M_e u over all elements (Irons & Treharne 1971).
#pragma once

#include <algorithm>
#include <limits>

#include <pliant/local/solid/element_corners.h>
#include <pliant/math/eigenvalues.h>

namespace pliant {

/// Returns the bound, 1/s^2; infinity if the mass of a corner is not positive. M: diagonal of the mass matrix
/// in the order of nodes.h, kg. stiffness(e): K_e, whose row 3 a + i is direction i of corner a. volume(e):
/// volume of the element, the weight by which the mass of a node is split among its elements.
template <int N, class Stiffness, class Volume>
double element_frequency_bound(const ElementCorners<N>& corners, const VecX<double>& M, Stiffness&& stiffness,
                               Volume&& volume) {
  VecX<double> node_volume = VecX<double>::Zero(corners.n_nodes());
  for (int e = 0; e < corners.n_elements(); ++e)
    for (int a = 0; a < N; ++a) node_volume[corners.node(e, a)] += volume(e);
  double bound = 0;
  for (int e = 0; e < corners.n_elements(); ++e) {
    Eigen::Matrix<double, 3 * N, 1> root;
    for (int a = 0; a < N; ++a)
      for (int i = 0; i < 3; ++i) {
        const int node = corners.node(e, a);
        const double mass = M[static_cast<Eigen::Index>(i) * corners.n_nodes() + node];
        if (!(mass > 0)) return std::numeric_limits<double>::infinity();
        root[3 * a + i] = std::sqrt(node_volume[node] / (mass * volume(e)));
      }
    const Eigen::Matrix<double, 3 * N, 3 * N> K = root.asDiagonal() * stiffness(e) * root.asDiagonal();
    bound = std::max(bound, symmetric_eigenvalues(K).maxCoeff());
  }
  return bound * (1 + 1e-12);  // margin for rounding of the eigenvalues
}

}  // namespace pliant
