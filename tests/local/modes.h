// A few modes of K u = omega^2 M u near a frequency, by inverse iteration of a block of vectors, and fields
// on the sphere to begin with.
#pragma once

#include <complex>

#include <Eigen/Eigenvalues>
#include <Eigen/SparseCholesky>

#include "energy_laws.h"
#include "shell_meshes.h"

namespace pliant::test {

/// The values of omega^2 on the space that `rounds` inverse iterations at `shift` make of the columns of U.
inline VecX<double> ritz_values(const Eigen::SparseMatrix<double>& K, const VecX<double>& M, double shift,
                                MatX<double> U, int rounds) {
  Eigen::SparseMatrix<double> A = K;
  for (Eigen::Index i = 0; i < M.size(); ++i) A.coeffRef(i, i) -= shift * M[i];
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(A);
  VecX<double> values;
  for (int round = 0; round <= rounds; ++round) {
    if (round > 0) U = factor.solve(MatX<double>(M.asDiagonal() * U));
    const MatX<double> small_K = U.transpose() * (K * U), small_M = U.transpose() * M.asDiagonal() * U;
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatX<double>> solver(small_K, small_M);
    values = solver.eigenvalues();
    U = U * solver.eigenvectors();
  }
  return values;
}

/// Fields on the sphere of the surface harmonics Y of degree n: Y along the normal, and the slope of Y, for
/// 2n + 1 of them. Y = Re and Im (a.X)^n with a.a = 0. n = 0: the normal.
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
