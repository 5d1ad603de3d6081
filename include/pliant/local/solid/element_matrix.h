// The stiffness matrices of elements, K = sum_e K_e, as triplets and in a bound of the largest frequency.
// Where each coordinate's mass is split among its elements, M = sum_e M_e, the largest omega^2 of the whole
// is at most the largest of any element, for x K x = sum x K_e x <= max_e(omega_e^2) sum x M_e x. An
// element's share of a mass is its part of what holds the coordinate, sum_j |K_ij|: the bound is then close.
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

/// Stiffness K among the local coordinates `at`.
template <int N>
struct ElementMatrix {
  std::array<int, N> at;
  Eigen::Matrix<double, N, N> K;
};

/// each(visit) calls visit(ElementMatrix) for all elements.
template <class Each>
void add_triplets(Each&& each, std::vector<Eigen::Triplet<double>>& K) {
  each([&](const auto& element) {
    const int n = static_cast<int>(element.at.size());
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j)
        if (element.K(i, j) != 0)
          K.emplace_back(element.at[static_cast<std::size_t>(i)], element.at[static_cast<std::size_t>(j)],
                         element.K(i, j));
  });
}

/// No less than the largest omega^2 of K u = omega^2 M u; infinity where something without mass is held.
template <class Each>
double largest_of_elements(Each&& each, const VecX<double>& M) {
  VecX<double> held = VecX<double>::Zero(M.size());
  each([&](const auto& element) {
    for (std::size_t i = 0; i < element.at.size(); ++i)
      held[element.at[i]] += element.K.row(static_cast<Eigen::Index>(i)).template lpNorm<1>();
  });
  double largest = 0;
  each([&](const auto& element) {
    VecX<double> root(element.K.rows());
    for (std::size_t i = 0; i < element.at.size(); ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      const double part = element.K.row(row).template lpNorm<1>();
      root[row] = part > 0 ? std::sqrt(held[element.at[i]] / (part * M[element.at[i]])) : 0;
    }
    if (!root.allFinite()) {
      largest = std::numeric_limits<double>::infinity();
      return;
    }
    const MatX<double> scaled = root.asDiagonal() * element.K * root.asDiagonal();
    largest = std::max(largest, symmetric_eigenvalues(scaled)[scaled.rows() - 1]);
  });
  // The eigenvalues' own rounding.
  return largest * (1 + 1e-12);
}

}  // namespace pliant
