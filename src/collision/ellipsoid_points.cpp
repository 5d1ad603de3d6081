// The lowest point of an ellipsoid over a plane, and the point of an ellipsoid at which the radial coordinate
// of another ellipsoid is least. Newton's method finds the second point.
#include <pliant/collision/ellipsoid_points.h>

#include <cmath>
#include <limits>

#include <Eigen/Eigenvalues>

namespace pliant {

namespace {
constexpr int kMaxDirectionSteps = 100;
}

Vec3<double> lowest_direction(const Vec3<double>& axes, const Vec3<double>& n) {
  return -axes.cwiseProduct(n).normalized();
}

Vec3<double> nearest_direction(const Mat3<double>& M, const Vec3<double>& r) {
  // The global minimum on the sphere satisfies (M^T M + lambda) y = -M^T r, |y| = 1 and lambda >= -(least
  // eigenvalue of M^T M) (Moré and Sorensen 1983). Below, lambda is measured from this bound.
  const Eigen::SelfAdjointEigenSolver<Mat3<double>> modes(M.transpose() * M);
  const Mat3<double>& V = modes.eigenvectors();
  const Vec3<double> g = -V.transpose() * (M.transpose() * r);
  const Vec3<double> stiff = (modes.eigenvalues().array() - modes.eigenvalues()[0]).max(0);
  auto along = [&](double lambda) -> Vec3<double> { return g.array() / (stiff.array() + lambda); };
  // 1 / |y| is concave and increasing in lambda, so Newton's method for this function converges from below.
  const double upper = g.norm(), lower = std::abs(g[0]);  // bounds of the lambda with |y| = 1
  const double tiny = std::numeric_limits<double>::epsilon() * (stiff[2] + upper);
  double lambda = std::max(lower, tiny);
  if (!(along(lambda).norm() > 1) && lower <= tiny) {
    // The hard case of Moré and Sorensen: M^T r has no component along the eigenvector of the least
    // eigenvalue. This component of y follows from |y| = 1; both signs give minima.
    Vec3<double> y(0, 0, 0);
    for (int k = 1; k < 3; ++k)
      if (stiff[k] > tiny) y[k] = g[k] / stiff[k];
    y[0] = std::copysign(std::sqrt(std::max(0.0, 1 - y.squaredNorm())), g[0]);
    return (V * y).normalized();
  }
  for (int i = 0; i < kMaxDirectionSteps; ++i) {
    const Vec3<double> y = along(lambda);
    const double length = y.norm(), slope = (y.array().square() / (stiff.array() + lambda)).sum();
    const double step = length * length * (length - 1) / slope;
    if (!(std::abs(step) > 4 * std::numeric_limits<double>::epsilon() * lambda)) break;
    lambda = std::max(lambda + step, lower);
  }
  return (V * along(lambda)).normalized();
}

}  // namespace pliant
