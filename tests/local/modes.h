// Modes of K u = omega^2 M u near a frequency, by inverse iteration of a block of vectors; and harmonic
// fields on the sphere as initial vectors.
#pragma once

#include <algorithm>
#include <complex>
#include <utility>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/SparseCholesky>

#include <pliant/math/eigenvalues.h>

#include "energy_laws.h"
#include "shell_meshes.h"

namespace pliant::test {

/// Returns the mean omega^2 of `count` modes, after inverse iterations of U and V at omega^2 = `near`. Of the
/// modes with omega^2 < 2 `near`, those with the largest components in the space of U are selected. V
/// contains fields of neighbouring modes, which would mix with the wanted modes. Throws std::out_of_range if
/// there are fewer than `count` modes.
inline double mean_of_modes(const Eigen::SparseMatrix<double>& K, const VecX<double>& M, double near,
                            const MatX<double>& U, const MatX<double>& V, int count) {
  Eigen::SparseMatrix<double> A = K;
  for (Eigen::Index i = 0; i < M.size(); ++i) A.coeffRef(i, i) -= near * M[i];
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(A);
  MatX<double> modes(M.size(), U.cols() + V.cols());
  modes << U, V;
  VecX<double> values;
  for (int round = 0; round < 3; ++round) {
    modes = factor.solve(MatX<double>(M.asDiagonal() * modes));
    const MatX<double> small_K = modes.transpose() * (K * modes),
                       small_M = modes.transpose() * M.asDiagonal() * modes;
    const Eigenpairs small = symmetric_eigenpairs(small_K, small_M);
    values = small.values;
    modes = modes * small.vectors;
  }
  const MatX<double> along = U.transpose() * M.asDiagonal() * modes,
                     within = MatX<double>(U.transpose() * M.asDiagonal() * U).ldlt().solve(along);
  std::vector<std::pair<double, double>> found;
  for (Eigen::Index i = 0; i < values.size() && values[i] < 2 * near; ++i)
    found.emplace_back(along.col(i).dot(within.col(i)), values[i]);
  std::sort(found.rbegin(), found.rend());
  double sum = 0;
  for (int i = 0; i < count; ++i) sum += found.at(static_cast<std::size_t>(i)).second;
  return sum / count;
}

/// Returns fields of 2n + 1 random surface harmonics Y of degree n on the sphere. For each Y, one column is Y
/// along the normal, and the next column is grad Y / n. Y is Re (a.N)^n with the unit normal N and a random
/// complex vector a, a.a = 0. For n = 0, the only column is the normal.
inline MatX<double> harmonic_fields(const ShellMesh& mesh, int n) {
  Draws draws(11);
  const int count = 2 * n + 1;
  MatX<double> U(3 * mesh.n_nodes(), n == 0 ? 1 : 2 * count);
  for (int k = 0; k < count; ++k) {
    const Vec3<double> p = draws.vector(1).normalized(), q = p.cross(draws.vector(1)).normalized();
    auto harmonic = [&](const Vec3<double>& X, int degree) {
      return std::pow(std::complex<double>(p.dot(X), q.dot(X)), degree);
    };
    U.col(n == 0 ? 0 : 2 * k) = field(mesh, [&](const Vec3<double>& X) -> Vec3<double> {
      const Vec3<double> N = X.normalized();
      return n == 0 ? N : Vec3<double>(harmonic(N, n).real() * N);
    });
    if (n == 0) break;
    U.col(2 * k + 1) = field(mesh, [&](const Vec3<double>& X) -> Vec3<double> {
      const Vec3<double> N = X.normalized();
      const std::complex<double> y = harmonic(N, n - 1);
      const Vec3<double> slope = y.real() * p - y.imag() * q;
      return slope - slope.dot(N) * N;
    });
  }
  return U;
}

}  // namespace pliant::test
