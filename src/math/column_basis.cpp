// Orthonormal bases of the columns of dense matrices, and least squares, by Eigen's QR factorisations.
#include <pliant/math/column_basis.h>

#include <Eigen/QR>

#include <pliant/math/scalar/power_of_two.h>

namespace pliant {

MatX<double> column_basis(const MatX<double>& A) {
  const Eigen::HouseholderQR<MatX<double>> qr(A);
  return qr.householderQ() * MatX<double>::Identity(A.rows(), A.cols());
}

MatX<double> column_basis(const MatX<double>& A, double dependent) {
  Eigen::ColPivHouseholderQR<MatX<double>> qr(A);
  qr.setThreshold(dependent);
  return qr.householderQ() * MatX<double>::Identity(A.rows(), qr.rank());
}

MatX<double> complement_basis(const MatX<double>& A) {
  const Eigen::HouseholderQR<MatX<double>> qr(A);
  return MatX<double>(qr.householderQ()).rightCols(A.rows() - A.cols());
}

MatX<double> complement_basis(const MatX<double>& A, double dependent) {
  Eigen::ColPivHouseholderQR<MatX<double>> qr(A);
  qr.setThreshold(dependent);
  return MatX<double>(qr.householderQ()).rightCols(A.rows() - qr.rank());
}

VecX<double> least_squares(const MatX<double>& A, const VecX<double>& b) {
  VecX<double> scale = A.colwise().norm().transpose();
  for (double& s : scale) s = 1 / power_of_two(s);
  return scale.cwiseProduct((A * scale.asDiagonal()).colPivHouseholderQr().solve(b));
}

VecX<double> least_norm(const MatX<double>& A, const VecX<double>& b) {
  return A.completeOrthogonalDecomposition().solve(b);
}

MatX<double> pseudo_inverse(const MatX<double>& A) {
  return A.completeOrthogonalDecomposition().pseudoInverse();
}

}  // namespace pliant
