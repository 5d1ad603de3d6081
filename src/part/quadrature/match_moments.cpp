#include "match_moments.h"

#include <Eigen/QR>

namespace pliant {

namespace {

/// Returns the moments of order 0, 1 and 2 of a point of unit mass.
Vec<double, 10> moments(const Vec3<double>& x) {
  Vec<double, 10> f;
  f << 1, x[0], x[1], x[2], x[0] * x[0], x[1] * x[1], x[2] * x[2], x[0] * x[1], x[1] * x[2], x[2] * x[0];
  return f;
}
/// Returns the moments of a part from its inertia.
Vec<double, 10> moments(const Inertia<double>& whole) {
  const Mat3<double> I = whole.M.block<3, 3>(3, 3);
  const Vec3<double> square = 0.5 * I.trace() * Vec3<double>::Ones() - I.diagonal();
  Vec<double, 10> f;
  f << whole.mass, whole.moment, square, -I(0, 1), -I(1, 2), -I(2, 0);
  return f;
}

}  // namespace

double match_moments(const Inertia<double>& whole, const Nodes& X, VecX<double>& mass) {
  const Eigen::Index n = X.rows();
  const Vec<double, 10> unit = moments(Vec3<double>(X.cwiseAbs().colwise().maxCoeff().transpose()));
  MatX<double> F(10, n);
  for (Eigen::Index k = 0; k < n; ++k)
    F.col(k) = moments(Vec3<double>(X.row(k).transpose())).cwiseQuotient(unit);
  const Vec<double, 10> wanted = moments(whole).cwiseQuotient(unit), missing = wanted - F * mass;
  // Minimise sum m c^2 subject to sum m c f = missing. The sums are over points, c is the relative change of
  // the mass m, and f are the moments of a point. The solution is c = f^T y.
  const Eigen::Matrix<double, 10, 10> A = F * mass.asDiagonal() * F.transpose();
  Eigen::CompleteOrthogonalDecomposition<Eigen::Matrix<double, 10, 10>> solver;
  solver.setThreshold(1e-10);
  solver.compute(A);
  const VecX<double> change = F.transpose() * solver.solve(missing);
  mass.array() *= 1 + change.array();
  return (wanted - F * mass).cwiseAbs().maxCoeff() / whole.mass;
}

}  // namespace pliant
