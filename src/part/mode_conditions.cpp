#include "mode_conditions.h"

#include <stdexcept>

#include <Eigen/Eigenvalues>
#include <Eigen/QR>

#include <pliant/part/part.h>

namespace pliant {

MatX<double> rest_frame(const Part& part, const ModalBasis& basis) {
  const int n_s = part.n_s();
  const Eigen::Index n = basis.mass.size();
  const auto n_points = static_cast<Eigen::Index>(basis.points.size());
  MatX<double> G = MatX<double>::Zero(3 * n, 6 + n_s);
  const VecX<double> one = basis.project.rowwise().sum();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    G.col(i).segment(i * n, n) = one;
    G.col(3 + i).segment(k * n, n) = basis.X.col(j);  // e_i x X
    G.col(3 + i).segment(j * n, n) = -basis.X.col(k);
  }
  if (n_s == 0) return G;
  VecMax<double> q_s(n_s);
  for (int k = 0; k < n_s; ++k) q_s[k] = part.parameters().moving(k).rest_value();
  std::vector<PointJet<double>> jets;
  Counters unused;
  part.points(basis.points, q_s, VecMax<double>::Zero(n_s), jets, unused);
  for (int k = 0; k < n_s; ++k) {
    Nodes values(n_points, 3);
    for (Eigen::Index i = 0; i < n_points; ++i)
      values.row(i) = jets[static_cast<std::size_t>(i)].J.col(k).transpose();
    G.col(6 + k) = Nodes(basis.project * values).reshaped();
  }
  return G;
}

void diagonalise(const Part& part, const MatX<double>& K, ModalBasis& basis) {
  constexpr double dependent = 1e-9;
  const Eigen::Index n = basis.mass.size();
  const double mass = basis.mass[0];
  MatX<double> W = rest_frame(part, basis);
  for (Eigen::Index c = 0; c < W.cols(); ++c)
    if (W.col(c).norm() > 0) W.col(c).normalize();
  Eigen::ColPivHouseholderQR<MatX<double>> qr(W);
  qr.setThreshold(dependent);
  const Eigen::Index left = 3 * n - qr.rank();
  if (left < 1)
    throw std::invalid_argument("part '" + part.name() +
                                "': its frame and dynamic parameters leave no displacement to its " +
                                basis.made_of + "; expected a higher degree");
  const MatX<double> Z = MatX<double>(qr.householderQ()).rightCols(left);
  const Eigen::SelfAdjointEigenSolver<MatX<double>> modes(Z.transpose() * K * Z);
  basis.B = Z * modes.eigenvectors() / std::sqrt(mass);
  basis.omega2 = modes.eigenvalues().cwiseMax(0) / mass;
}

}  // namespace pliant
