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
  /// Returns the matrix E (1/m) for which E times the vector of all products is the derivative of this vector
  /// along `axis` (0 to 2).
  MatX<double> derivative(int axis) const;

 private:
  Eigen::AlignedBox3d box_;
  int degree_;
  std::vector<std::array<int, 3>> powers_;
};

}  // namespace pliant
