// Stiffness matrices of elements, K = sum_e K_e: their entries as triplets, and an upper bound on the
// frequency. The mass of each coordinate is split among its elements, M = sum_e M_e. Then
//   x K x = sum_e x K_e x <= max_e(omega_e^2) sum_e x M_e x = max_e(omega_e^2) x M x,
// so that omega^2 of the mesh is at most the largest omega_e^2 of one element (Irons & Treharne 1971). The
// mass of coordinate i is split in proportion to sum_j |K_e,ij|, which makes the bound tight.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/SparseCore>

#include <pliant/math/eigenvalues.h>
#include <pliant/math/types.h>

namespace pliant {

/// Stiffness matrix K of one element, and the index of each of its rows in the local coordinates of the mesh.
template <int N>
struct ElementMatrix {
  std::array<int, N> index;
  Eigen::Matrix<double, N, N> K;
};

/// Appends the non-zero entries of all element matrices. each(visit) calls visit(ElementMatrix) for every
/// element.
template <class Each>
void add_triplets(Each&& each, std::vector<Eigen::Triplet<double>>& K) {
  each([&](const auto& element) {
    const int n = static_cast<int>(element.index.size());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (element.K(i, j) != 0)
          K.emplace_back(element.index[static_cast<std::size_t>(i)],
                         element.index[static_cast<std::size_t>(j)], element.K(i, j));
  });
}

/// Returns an upper bound on omega^2 (1/s^2) of K u = omega^2 M u; infinity if a coordinate with stiffness
/// has no mass. M: diagonal of the mass matrix.
template <class Each>
double largest_element_frequency(Each&& each, const VecX<double>& M) {
  VecX<double> row_sum = VecX<double>::Zero(M.size());
  each([&](const auto& element) {
    for (std::size_t i = 0; i < element.index.size(); ++i)
      row_sum[element.index[i]] += element.K.row(static_cast<Eigen::Index>(i)).template lpNorm<1>();
  });
  double largest = 0;
  each([&](const auto& element) {
    VecX<double> root(element.K.rows());
    for (std::size_t i = 0; i < element.index.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double share = element.K.row(row).template lpNorm<1>();
      root[row] = share > 0 ? std::sqrt(row_sum[element.index[i]] / (share * M[element.index[i]])) : 0;
    }
    if (!root.allFinite()) {
      largest = std::numeric_limits<double>::infinity();
      return;
    }
    const MatX<double> scaled = root.asDiagonal() * element.K * root.asDiagonal();
    largest = std::max(largest, symmetric_eigenvalues(scaled)[scaled.rows() - 1]);
  });
  // Margin for rounding of the eigenvalues.
  return largest * (1 + 1e-12);
}

}  // namespace pliant
