// Products P_i(x) P_j(y) P_k(z) of Legendre polynomials with i + j + k <= degree, sorted by i + j + k. The
// coordinates x, y and z are scaled to [-1, 1] over a box.
#pragma once

#include <array>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/math/types.h>

namespace pliant {

class LegendreProducts {
 public:
  LegendreProducts(const Eigen::AlignedBox3d& box, int degree);

  const Eigen::AlignedBox3d& box() const { return box_; }
  Eigen::Index size() const { return static_cast<Eigen::Index>(powers_.size()); }
  /// Returns the values of all products at points x (3 x n, m): n x size().
  MatX<double> values(const Eigen::Matrix3Xd& x) const;
  /// Returns the matrix E with d/dx_axis of all products = E times all products, 1/m.
  MatX<double> derivative(int axis) const;

 private:
  Eigen::AlignedBox3d box_;
  int degree_;
  std::vector<std::array<int, 3>> powers_;
};

}  // namespace pliant
