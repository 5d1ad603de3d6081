// The reference conditions W^T d = 0 at the rest shape, and the modes of a stiffness that satisfy them.
#include <pliant/part/local/mode_conditions.h>

#include <stdexcept>

#include <pliant/math/column_basis.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/part/part.h>

namespace pliant {

namespace {

void normalise_columns(MatX<double>& A) {
  for (Eigen::Index c = 0; c < A.cols(); ++c)
    if (A.col(c).norm() > 0) A.col(c).normalize();
}

}  // namespace

MatX<double> rest_frame(const Part& part, const std::vector<Material<double>>& points, const Nodes& X) {
  const int n_s = part.n_s();
  const Eigen::Index n = X.rows();
  MatX<double> G = MatX<double>::Zero(3 * n, 6 + n_s);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    G.col(i).segment(i * n, n).setOnes();
    G.col(3 + i).segment(k * n, n) = X.col(j);  // e_i x X
    G.col(3 + i).segment(j * n, n) = -X.col(k);
  }
  if (n_s == 0) return G;
  VecMax<double> q_s(n_s);
  for (int k = 0; k < n_s; ++k) q_s[k] = part.parameters().moving(k).rest_value();
  std::vector<PointJet<double>> jets;
  Counters unused;
  part.points(points, q_s, VecMax<double>::Zero(n_s), jets, unused);
  for (int k = 0; k < n_s; ++k)
    for (Eigen::Index i = 0; i < n; ++i)
      for (int r = 0; r < 3; ++r) G(i + r * n, 6 + k) = jets[static_cast<std::size_t>(i)].J(r, k);
  return G;
}

MatX<double> rest_frame(const Part& part, const ModalBasis& basis) {
  const MatX<double> at_points = rest_frame(part, basis.points, basis.points_at_rest);
  const Eigen::Index n = basis.mass.size(), n_points = basis.points_at_rest.rows();
  MatX<double> G(3 * n, at_points.cols());
  for (int r = 0; r < 3; ++r)
    G.middleRows(r * n, n).noalias() = basis.project * at_points.middleRows(r * n_points, n_points);
  return G;
}

MatX<double> orthonormal_basis(MatX<double> A, double dependent) {
  normalise_columns(A);
  return column_basis(A, dependent);
}

void diagonalise(const Part& part, const MatX<double>& K, ModalBasis& basis) {
  constexpr double dependent = 1e-9;  // columns of W with a smaller relative pivot are ignored
  const double mass = basis.mass[0];
  MatX<double> W = rest_frame(part, basis);
  normalise_columns(W);
  const MatX<double> Z = complement_basis(W, dependent);
  if (Z.cols() < 1)
    throw std::invalid_argument("part '" + part.name() +
                                "': its frame and dynamic parameters represent all displacements of its " +
                                basis.made_of + "; expected a higher degree");
  const Eigenpairs modes = symmetric_eigenpairs(Z.transpose() * K * Z);
  basis.B = Z * modes.vectors / std::sqrt(mass);
  basis.omega2 = modes.values.cwiseMax(0) / mass;
}

}  // namespace pliant
