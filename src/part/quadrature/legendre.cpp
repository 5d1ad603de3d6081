// Values and derivatives of Legendre products.
#include "legendre.h"

#include <algorithm>

namespace pliant {

LegendreProducts::LegendreProducts(const Eigen::AlignedBox3d& box, int degree) : box_(box), degree_(degree) {
  for (int n = 0; n <= degree; ++n)
    for (int i = n; i >= 0; --i)
      for (int j = n - i; j >= 0; --j) powers_.push_back({i, j, n - i - j});
}

MatX<double> LegendreProducts::values(const Eigen::Matrix3Xd& x) const {
  std::array<MatX<double>, 3> P;
  for (std::size_t r = 0; r < 3; ++r) {
    const auto row = static_cast<Eigen::Index>(r);
    const VecX<double> t =
        (x.row(row).array() - box_.center()[row]).matrix().transpose() * (2 / box_.sizes()[row]);
    P[r].resize(x.cols(), degree_ + 1);
    P[r].col(0).setOnes();
    if (degree_ > 0) P[r].col(1) = t;
    for (int n = 2; n <= degree_; ++n)
      P[r].col(n) = ((2 * n - 1) * t.cwiseProduct(P[r].col(n - 1)) - (n - 1) * P[r].col(n - 2)) / n;
  }
  MatX<double> V(x.cols(), size());
  for (Eigen::Index a = 0; a < size(); ++a) {
    const auto& [i, j, k] = powers_[static_cast<std::size_t>(a)];
    V.col(a) = P[0].col(i).cwiseProduct(P[1].col(j)).cwiseProduct(P[2].col(k));
  }
  return V;
}

MatX<double> LegendreProducts::derivative(int axis) const {
  const auto r = static_cast<std::size_t>(axis);
  MatX<double> E = MatX<double>::Zero(size(), size());
  for (Eigen::Index a = 0; a < size(); ++a)
    // The derivative of P_n is sum (2k + 1) P_k, k = n - 1, n - 3, ... >= 0.
    for (std::array<int, 3> to = powers_[static_cast<std::size_t>(a)]; --to[r] >= 0; --to[r]) {
      const auto b = std::find(powers_.begin(), powers_.end(), to) - powers_.begin();
      E(a, b) = (2 * to[r] + 1) * 2 / box_.sizes()[axis];
    }
  return E;
}

}  // namespace pliant
