// The lowest modes of a mesh under W^T d = 0. With x = M^(1/2) d, K' = M^(-1/2) K M^(-1/2) and an orthonormal
// basis Q of M^(1/2) G0, those of largest nu of
//   x -> s - Y (Q^T Y)^-1 Q^T s,   s = (K' + sigma)^-1 x,   Y = (K' + sigma)^-1 Q,   nu = 1 / (omega^2 +
//   sigma)
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include <Spectra/SymEigsSolver.h>
#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <Eigen/SparseCholesky>

#include <pliant/part/modal_basis.h>
#include <pliant/part/part.h>

namespace pliant {

namespace {

using Sparse = Eigen::SparseMatrix<double>;

/// Up to here the dense solver is the faster way.
constexpr Eigen::Index kDense = 400;
/// Local coordinates whose factor takes minutes, and numbers in the modes.
constexpr Eigen::Index kMostCoordinates = 60'000;
constexpr double kMostNumbers = 5e7;

/// Elasticity of a mesh in mass-normalised coordinates.
struct MeshElasticity {
  VecX<double> root;  ///< of the masses
  Sparse K;
};

MeshElasticity lay_elasticity(const std::string& of, const LocalMesh& mesh, const LocalSettings& settings) {
  std::vector<std::unique_ptr<NodalEnergy>> energies;
  VecX<double> own;
  for (const LocalLaw& law : settings.energies) {
    energies.push_back(law.lay(mesh));
    if (energies.back()->of() != NodalEnergy::Of::displacement)
      throw std::invalid_argument(of + "modes know laws that are quadratic in d only, and not the law '" +
                                  law.name + "'; expected another law, or the basis \"nodes\"");
    const VecX<double> more = energies.back()->own_inertia();
    if (more.size() == 0) continue;
    if (own.size() > 0)
      throw std::invalid_argument(of + "only one of its energies may have coordinates of its own");
    own = more;
  }
  if (energies.empty()) throw std::invalid_argument(of + "modes need a law; expected one at least");
  MeshElasticity elasticity;
  elasticity.root.resize(3 * mesh.mass.size() + own.size());
  elasticity.root << mesh.mass, mesh.mass, mesh.mass, own;
  elasticity.root = elasticity.root.cwiseSqrt();
  const Eigen::Index n = elasticity.root.size();
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& energy : energies) energy->add_stiffness(VecX<double>::Zero(n), entries);
  elasticity.K.resize(n, n);
  elasticity.K.setFromTriplets(entries.begin(), entries.end());
  const VecX<double> inverse = elasticity.root.cwiseInverse();
  elasticity.K = (inverse.asDiagonal() * elasticity.K * inverse.asDiagonal()).eval();
  return elasticity;
}

/// An orthonormal basis of M^(1/2) G0: rigid motion and the dynamic parameters, at rest.
MatX<double> conditions(const Part& part, const LocalMesh& mesh, const VecX<double>& root) {
  constexpr double dependent = 1e-9;
  const Eigen::Index n = mesh.X.rows();
  const int n_s = part.n_s();
  MatX<double> W = MatX<double>::Zero(root.size(), 6 + n_s);
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3, k = (i + 2) % 3;
    W.col(i).segment(i * n, n).setOnes();
    W.col(3 + i).segment(k * n, n) = mesh.X.col(j);  // e_i x X
    W.col(3 + i).segment(j * n, n) = -mesh.X.col(k);
  }
  if (n_s > 0) {
    VecMax<double> q_s(n_s);
    for (int k = 0; k < n_s; ++k) q_s[k] = part.parameters().moving(k).rest_value();
    std::vector<PointJet<double>> jets;
    Counters unused;
    part.points(mesh.nodes, q_s, VecMax<double>::Zero(n_s), jets, unused);
    for (int k = 0; k < n_s; ++k)
      for (Eigen::Index i = 0; i < n; ++i)
        for (int r = 0; r < 3; ++r) W(i + r * n, 6 + k) = jets[static_cast<std::size_t>(i)].J(r, k);
  }
  W = (root.asDiagonal() * W).eval();
  for (Eigen::Index c = 0; c < W.cols(); ++c)
    if (W.col(c).norm() > 0) W.col(c).normalize();
  Eigen::ColPivHouseholderQR<MatX<double>> qr(W);
  qr.setThreshold(dependent);
  return qr.householderQ() * MatX<double>::Identity(root.size(), qr.rank());
}

/// (K' + sigma)^-1 on what the conditions leave, as Spectra asks for it.
class Flexibility {
 public:
  using Scalar = double;

  Flexibility(const Sparse& K, const MatX<double>& Q, double sigma) : Q_(Q) {
    Sparse shifted = K;
    for (Eigen::Index i = 0; i < K.rows(); ++i) shifted.coeffRef(i, i) += sigma;
    factor_.compute(shifted);
    if (factor_.info() != Eigen::Success) return;
    Y_ = factor_.solve(Q);
    inner_.compute(Q.transpose() * Y_);
  }
  bool exists() const { return factor_.info() == Eigen::Success && inner_.info() == Eigen::Success; }
  Eigen::Index rows() const { return Q_.rows(); }
  Eigen::Index cols() const { return Q_.rows(); }
  void perform_op(const double* in, double* out) const {
    const VecX<double> s = factor_.solve(Eigen::Map<const VecX<double>>(in, rows()));
    const VecX<double> hold = inner_.solve(Q_.transpose() * s);
    Eigen::Map<VecX<double>>(out, rows()) = s - Y_ * hold;
  }

 private:
  const MatX<double>& Q_;
  Eigen::SimplicialLDLT<Sparse> factor_;
  MatX<double> Y_;
  Eigen::LDLT<MatX<double>> inner_;
};

/// A tenth of the least omega^2 among displacements that are quadratic in X.
double shift_of(const LocalMesh& mesh, const MeshElasticity& elasticity, const MatX<double>& Q) {
  const Eigen::Index n = mesh.X.rows();
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k <= j; ++k) {
        VecX<double> x = VecX<double>::Zero(elasticity.root.size());
        x.segment(i * n, n) = mesh.X.col(j).cwiseProduct(mesh.X.col(k));
        x = elasticity.root.cwiseProduct(x).eval();
        x -= (Q * (Q.transpose() * x)).eval();
        const double size = x.squaredNorm(), omega2 = x.dot(elasticity.K * x) / size;
        if (omega2 > 0) least = std::min(least, omega2);
      }
  return 0.1 * least;
}

/// Columns: the modes in mass-normalised coordinates, of rising frequency.
MatX<double> lowest(const std::string& of, const LocalMesh& mesh, const MeshElasticity& elasticity,
                    const MatX<double>& Q, Eigen::Index count) {
  const Eigen::Index n = elasticity.root.size();
  if (n <= kDense || 4 * count > n) {
    const Eigen::HouseholderQR<MatX<double>> qr(Q);
    const MatX<double> Z = MatX<double>(qr.householderQ()).rightCols(n - Q.cols());
    const Eigen::SelfAdjointEigenSolver<MatX<double>> modes(Z.transpose() * elasticity.K * Z);
    return Z * modes.eigenvectors().leftCols(count);
  }
  constexpr double tolerance = 1e-13;
  constexpr int most_iterations = 1000;
  Flexibility flexibility(elasticity.K, Q, shift_of(mesh, elasticity, Q));
  if (!flexibility.exists())
    throw std::invalid_argument(of + "its elasticity is not positive: its modes cannot be told");
  Spectra::SymEigsSolver<Flexibility> solver(flexibility, count, std::min(n, 2 * count + 20));
  solver.init();
  solver.compute(Spectra::SortRule::LargestAlge, most_iterations, tolerance);
  if (solver.info() != Spectra::CompInfo::Successful)
    throw std::invalid_argument(of + "only " + std::to_string(solver.eigenvalues().size()) + " of its " +
                                std::to_string(count) + " modes could be told; expected fewer modes");
  MatX<double> x = solver.eigenvectors();
  x -= (Q * (Q.transpose() * x)).eval();
  const Eigen::HouseholderQR<MatX<double>> qr(x);
  return qr.householderQ() * MatX<double>::Identity(n, count);
}

}  // namespace

ModalBasis lay_mesh_modes(const Part& part, const LocalSettings& settings) {
  const std::string of = "part '" + part.name() + "': ";
  ModalBasis basis;
  const auto mesh = std::make_shared<const LocalMesh>(lay_local_mesh(part, settings));
  const Eigen::Index n_nodes = mesh->X.rows();
  if (settings.modes < 1)
    throw std::invalid_argument(of + std::to_string(settings.modes) + " modes; expected 1 at least");
  const double numbers = (4.0 + 3 * settings.modes) * static_cast<double>(n_nodes);
  if (3 * n_nodes > kMostCoordinates || numbers > kMostNumbers)
    throw std::invalid_argument(
        of + std::to_string(settings.modes) + " modes of a mesh of " + std::to_string(n_nodes) +
        " nodes are too much to be told; expected at most " + std::to_string(kMostCoordinates / 3) +
        " nodes, and nodes times modes below " + std::to_string(static_cast<long>(kMostNumbers / 3)));
  const MeshElasticity elasticity = lay_elasticity(of, *mesh, settings);
  const MatX<double> Q = conditions(part, *mesh, elasticity.root);
  const Eigen::Index left = elasticity.root.size() - Q.cols();
  if (settings.modes > left)
    throw std::invalid_argument(of + std::to_string(settings.modes) + " modes of a mesh that has " +
                                std::to_string(left) + "; expected no more");
  MatX<double> x = lowest(of, *mesh, elasticity, Q, settings.modes);
  // By their energies, whose error is the square of that of the modes.
  const MatX<double> stiffness = x.transpose() * (elasticity.K * x);
  const Eigen::SelfAdjointEigenSolver<MatX<double>> inner(stiffness);
  x = (x * inner.eigenvectors()).eval();
  basis.omega2 = inner.eigenvalues().cwiseMax(0);
  const MatX<double> modes = elasticity.root.cwiseInverse().asDiagonal() * x;

  // The fields that make them up, with the constant and X.
  constexpr double dependent = 1e-10;
  const VecX<double> root = mesh->mass.cwiseSqrt();
  MatX<double> fields(n_nodes, 4 + 3 * settings.modes);
  fields.leftCols<4>() << VecX<double>::Ones(n_nodes), mesh->X;
  for (Eigen::Index j = 0; j < settings.modes; ++j)
    fields.middleCols<3>(4 + 3 * j) = modes.col(j).head(3 * n_nodes).reshaped(n_nodes, 3);
  fields = (root.asDiagonal() * fields).eval();
  for (Eigen::Index c = 0; c < fields.cols(); ++c)
    if (fields.col(c).norm() > 0) fields.col(c).normalize();
  Eigen::ColPivHouseholderQR<MatX<double>> qr(fields);
  qr.setThreshold(dependent);
  const double mass = mesh->mass.sum();
  const MatX<double> U = qr.householderQ() * MatX<double>::Identity(n_nodes, qr.rank());
  const auto phi =
      std::make_shared<const MatX<double>>(std::sqrt(mass) * root.cwiseInverse().asDiagonal() * U);
  basis.mass = VecX<double>::Constant(qr.rank(), mass);
  basis.project = phi->transpose() * (mesh->mass / mass).asDiagonal();
  basis.points = mesh->nodes;
  basis.points_at_rest = mesh->X;
  basis.X = basis.project * mesh->X;
  basis.B.resize(3 * qr.rank(), settings.modes);
  for (Eigen::Index j = 0; j < settings.modes; ++j)
    basis.B.col(j) =
        MatX<double>(basis.project * modes.col(j).head(3 * n_nodes).reshaped(n_nodes, 3)).reshaped();
  basis.mesh = *mesh;
  basis.shown = *phi;
  basis.made_of = "a mesh of " + std::to_string(n_nodes) + " nodes";
  basis.weights = [mesh, phi](const Part& of_part, const Material<double>& m) {
    const NodeWeights among = mesh_weights(of_part, *mesh, m);
    NodeWeights at;
    for (Eigen::Index a = 0; a < phi->cols() && !among.node.empty(); ++a) {
      double sum = 0;
      for (std::size_t i = 0; i < among.node.size(); ++i) sum += among.weight[i] * (*phi)(among.node[i], a);
      at.node.push_back(static_cast<int>(a));
      at.weight.push_back(sum);
    }
    return at;
  };
  return basis;
}

}  // namespace pliant
