// Instances of Eigen's eigenvalue solvers.
#include <pliant/math/eigenvalues.h>

#include <Eigen/Eigenvalues>

namespace pliant {

Eigenpairs symmetric_eigenpairs(const Eigen::Ref<const MatX<double>>& A) {
  const Eigen::SelfAdjointEigenSolver<MatX<double>> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VecX<double> symmetric_eigenvalues(const Eigen::Ref<const MatX<double>>& A) {
  return Eigen::SelfAdjointEigenSolver<MatX<double>>(A, Eigen::EigenvaluesOnly).eigenvalues();
}

Eigenpairs symmetric_eigenpairs(const Eigen::Ref<const MatX<double>>& A,
                                const Eigen::Ref<const MatX<double>>& B) {
  const Eigen::GeneralizedSelfAdjointEigenSolver<MatX<double>> solver(A, B);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

ComplexEigenpairs eigenpairs(const Eigen::Ref<const MatX<double>>& A) {
  const Eigen::EigenSolver<MatX<double>> solver(A);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

VecX<std::complex<double>> eigenvalues(const Eigen::Ref<const MatX<double>>& A) {
  return Eigen::EigenSolver<MatX<double>>(A, false).eigenvalues();
}

double spectral_radius(const Eigen::Ref<const MatX<double>>& A) {
  return eigenvalues(A).cwiseAbs().maxCoeff();
}

}  // namespace pliant
