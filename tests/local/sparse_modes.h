// Modes of K u = lambda M u with eigenvalues near a shift, by inverse subspace iteration; and mean omega^2 of
// given fields.
#pragma once

#include <algorithm>
#include <stdexcept>
#include <utility>
#include <vector>

#include <Eigen/SparseCholesky>

#include <pliant/local/nodal_energy.h>
#include <pliant/math/eigenvalues.h>

#include "draws.h"

namespace pliant::test {

using Sparse = Eigen::SparseMatrix<double>;

inline Sparse sparse(const std::vector<Eigen::Triplet<double>>& entries, Eigen::Index n) {
  Sparse A(n, n);
  A.setFromTriplets(entries.begin(), entries.end());
  return A;
}
inline Sparse stiffness_at(const NodalEnergy& energy, const VecX<double>& x) {
  std::vector<Eigen::Triplet<double>> entries;
  energy.add_stiffness(x, entries);
  return sparse(entries, x.size());
}
/// Returns the matrix over local coordinates that repeats an n x n matrix over nodes for x, y and z.
inline Sparse in_space(const std::vector<Eigen::Triplet<double>>& entries, int n) {
  std::vector<Eigen::Triplet<double>> all;
  for (const auto& entry : entries)
    for (int i = 0; i < 3; ++i) all.emplace_back(i * n + entry.row(), i * n + entry.col(), entry.value());
  return sparse(all, 3 * n);
}
inline Sparse in_space(const VecX<double>& masses) {
  return Sparse(VecX<double>(masses.replicate(3, 1)).asDiagonal());
}

/// Computes omega^2 of given fields U on a mesh. The solution U' of (K + below M) U' = M U contains less of
/// the modes of high frequency than U. Each value is a mean of omega^2 over the modes of the mesh, weighted
/// by their shares in a field of U'. It is accurate even if a mode of the mesh mixes with others of nearby
/// frequency. below: 1/s^2, of the size of the wanted omega^2. The constructor throws std::runtime_error if
/// K + below M cannot be factored.
class SmoothedFields {
 public:
  SmoothedFields(Sparse K, Sparse M, double below) : K_(std::move(K)), M_(std::move(M)) {
    factor_.compute(K_ + below * M_);
    if (factor_.info() != Eigen::Success) throw std::runtime_error("K + below M could not be factored");
  }
  /// Returns the values in rising order, one for each column of U.
  VecX<double> values(const MatX<double>& U) const {
    const MatX<double> smooth = factor_.solve(MatX<double>(M_ * U));
    const MatX<double> k = smooth.transpose() * (K_ * smooth), m = smooth.transpose() * (M_ * smooth);
    return symmetric_eigenpairs(k, m).values;
  }

 private:
  Sparse K_, M_;
  Eigen::SimplicialLDLT<Sparse> factor_;
};

struct Modes {
  VecX<double> values;  ///< in rising order
  MatX<double> vectors;
};

/// Returns the `wanted` modes with eigenvalues nearest to the shift, in rising order. The shift must not be
/// an eigenvalue. spare: number of additional vectors, with which the iteration converges faster. Throws
/// std::runtime_error if K - shift M cannot be factored or 200 iterations do not converge.
inline Modes modes_near(const Sparse& K, const Sparse& M, double shift, int wanted, int spare = 8) {
  const Sparse A = K - shift * M;
  const Eigen::SimplicialLDLT<Sparse> factor(A);
  if (factor.info() != Eigen::Success) throw std::runtime_error("K - shift M could not be factored");
  const Eigen::Index n = K.rows(), block = std::min<Eigen::Index>(n, wanted + spare);
  Draws draws(4);
  MatX<double> X(n, block);
  for (double& value : X.reshaped()) value = draws.uniform(-1, 1);
  VecX<double> last = VecX<double>::Zero(wanted);
  for (int iteration = 0; iteration < 200; ++iteration) {
    MatX<double> Y = factor.solve(M * X);
    for (Eigen::Index k = 0; k < block; ++k) Y.col(k).normalize();
    const MatX<double> k = Y.transpose() * (K * Y), m = Y.transpose() * (M * Y);
    const Eigenpairs small = symmetric_eigenpairs(k, m);
    X = Y * small.vectors;
    std::vector<Eigen::Index> order(static_cast<std::size_t>(block));
    for (Eigen::Index i = 0; i < block; ++i) order[static_cast<std::size_t>(i)] = i;
    auto away = [&](Eigen::Index i) { return std::abs(small.values[i] - shift); };
    std::sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) { return away(a) < away(b); });
    order.resize(static_cast<std::size_t>(wanted));
    std::sort(order.begin(), order.end());
    const Modes modes{small.values(order), X(Eigen::all, order)};
    if ((modes.values - last).lpNorm<Eigen::Infinity>() <= 1e-9 * modes.values.lpNorm<Eigen::Infinity>())
      return modes;
    last = modes.values;
  }
  throw std::runtime_error("the subspace iteration did not converge");
}

}  // namespace pliant::test
