// The lowest modes of a mesh under W^T d = 0. With M = C^T C, x = C d and an orthonormal basis Q of C G0,
// those of largest nu of
//   x -> s - Y (Q^T Y)^-1 Q^T s,   s = C (K + sigma M)^-1 C^T x,   Y the same of Q,   nu = 1/(omega^2 +
//   sigma)
// M of curved elements is the consistent one, by which omega errs with the fourth power of an edge, from
// above; of straight ones and of shells the lumped one, whose error opposes that of their stiffness.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include <Spectra/SymEigsSolver.h>
#include <Eigen/Cholesky>
#include <Eigen/QR>

#include <pliant/local/solid/solid_mass.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/part/local/modal_basis.h>
#include <pliant/part/part.h>

#include "mass_root.h"
#include "mode_conditions.h"

namespace pliant {

namespace {

using Sparse = SparseMatrix;

/// Up to here the dense solver is the faster way.
constexpr Eigen::Index kDense = 400;
/// Local coordinates whose factor takes gigabytes, and numbers in the modes.
constexpr Eigen::Index kMostCoordinates = 120'000;
constexpr double kMostNumbers = 5e7;

/// M over the nodes of a mesh.
Sparse mass_of(const LocalMesh& mesh) {
  const Eigen::Index n = mesh.X.rows();
  std::vector<Eigen::Triplet<double>> entries;
  if (!mesh.shell() && mesh.tetrahedra.rows() > 4) {
    entries = consistent_mass(mesh.X, mesh.tetrahedra, mesh.density);
  } else {
    for (int k = 0; k < n; ++k) entries.emplace_back(k, k, mesh.mass[k]);
  }
  Sparse M(n, n);
  M.setFromTriplets(entries.begin(), entries.end());
  return M;
}

/// Throws where modes do not know a law.
void check_laws(const std::string& of, const LaidEnergies& laid, const LocalSettings& settings) {
  for (std::size_t k = 0; k < laid.all.size(); ++k)
    if (laid.all[k]->of() != NodalEnergy::Of::displacement)
      throw LocalFault(of + "modes know laws that are quadratic in d only, and not the law '" +
                           settings.energies[k].name + "'; expected another law, or the basis \"nodes\"",
                       static_cast<int>(k));
  if (laid.all.empty()) throw LocalFault(of + "modes need a law; expected one at least");
}

/// Mass and stiffness of a mesh.
struct MeshElasticity {
  MeshElasticity(const LocalMesh& mesh, const LaidEnergies& laid) : mass(mass_of(mesh), laid.own_inertia) {
    const Eigen::Index n = mass.size();
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& energy : laid.all) energy->add_stiffness(VecX<double>::Zero(n), entries);
    K.resize(n, n);
    K.setFromTriplets(entries.begin(), entries.end());
  }
  MassRoot mass;
  Sparse K;
};

/// An orthonormal basis of C G0: rigid motion and the dynamic parameters, at rest.
MatX<double> conditions(const Part& part, const LocalMesh& mesh, const MassRoot& mass) {
  constexpr double dependent = 1e-9;
  const MatX<double> G = rest_frame(part, mesh.nodes, mesh.X);
  MatX<double> all = MatX<double>::Zero(mass.size(), G.cols());
  all.topRows(G.rows()) = G;
  return orthonormal_basis(mass.root(all), dependent);
}

/// (K' + sigma)^-1, K' = C^-T K C^-1, on what the conditions leave, as Spectra asks for it.
class Flexibility {
 public:
  using Scalar = double;

  Flexibility(const MeshElasticity& of, const MatX<double>& Q, double sigma,
              const MakeSparseFactor& make_factor)
      : mass_(of.mass), Q_(Q), factor_(make_factor()) {
    Sparse shifted = of.K + sigma * of.mass.whole();
    shifted.makeCompressed();
    factor_->analyse(shifted);
    positive_ = factor_->factor(shifted);
    if (!positive_) return;
    Y_ = yield(Q);
    inner_.compute(Q.transpose() * Y_);
    positive_ = inner_.info() == Eigen::Success;
  }
  bool exists() const { return positive_; }
  Eigen::Index rows() const { return Q_.rows(); }
  Eigen::Index cols() const { return Q_.rows(); }
  void perform_op(const double* in, double* out) const {
    const VecX<double> s = yield(Eigen::Map<const VecX<double>>(in, rows()));
    const VecX<double> hold = inner_.solve(Q_.transpose() * s);
    Eigen::Map<VecX<double>>(out, rows()) = s - Y_ * hold;
  }

 private:
  MatX<double> yield(const MatX<double>& x) const {
    MatX<double> pushed = mass_.transposed(x);
    factor_->solve(pushed);
    return mass_.root(pushed);
  }

  const MassRoot& mass_;
  const MatX<double>& Q_;
  std::unique_ptr<SparseFactor> factor_;
  bool positive_ = false;
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
        VecX<double> d = VecX<double>::Zero(elasticity.mass.size());
        d.segment(i * n, n) = mesh.X.col(j).cwiseProduct(mesh.X.col(k));
        VecX<double> x = elasticity.mass.root(d);
        x -= (Q * (Q.transpose() * x)).eval();
        d = elasticity.mass.solve(x);
        const double omega2 = d.dot(elasticity.K * d) / x.squaredNorm();
        if (omega2 > 0) least = std::min(least, omega2);
      }
  return 0.1 * least;
}

/// Columns: the modes in mass-normalised coordinates, of rising frequency.
MatX<double> lowest(const std::string& of, const LocalMesh& mesh, const MeshElasticity& elasticity,
                    const MatX<double>& Q, Eigen::Index count, const MakeSparseFactor& make_factor) {
  const Eigen::Index n = elasticity.mass.size();
  if (n <= kDense || 4 * count > n) {
    const Eigen::HouseholderQR<MatX<double>> qr(Q);
    const MatX<double> Z = MatX<double>(qr.householderQ()).rightCols(n - Q.cols()),
                       d = elasticity.mass.solve(Z);
    return Z * symmetric_eigenpairs(d.transpose() * (elasticity.K * d)).vectors.leftCols(count);
  }
  constexpr double tolerance = 1e-13;
  constexpr int most_iterations = 1000;
  Flexibility flexibility(elasticity, Q, shift_of(mesh, elasticity, Q), make_factor);
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

ModalBasis make_mesh_modes(const Part& part, const LocalSettings& settings) {
  const std::string of = "part '" + part.name() + "': ";
  ModalBasis basis;
  const auto mesh = std::make_shared<const LocalMesh>(make_local_mesh(part, settings));
  const Eigen::Index n_nodes = mesh->X.rows();
  if (settings.modes < 1)
    throw std::invalid_argument(of + std::to_string(settings.modes) + " modes; expected 1 at least");
  const double numbers = (4.0 + 3 * settings.modes) * static_cast<double>(n_nodes);
  if (3 * n_nodes > kMostCoordinates || numbers > kMostNumbers)
    throw std::invalid_argument(
        of + std::to_string(settings.modes) + " modes of a mesh of " + std::to_string(n_nodes) +
        " nodes are too much to be told; expected at most " + std::to_string(kMostCoordinates / 3) +
        " nodes, and nodes times modes below " + std::to_string(static_cast<long>(kMostNumbers / 3)));
  const LaidEnergies laid = lay_energies(part, settings, *mesh);
  check_laws(of, laid, settings);
  const MeshElasticity elasticity(*mesh, laid);
  const MassRoot& root = elasticity.mass;
  const MatX<double> Q = conditions(part, *mesh, root);
  const Eigen::Index left = root.size() - Q.cols();
  if (settings.modes > left)
    throw std::invalid_argument(of + std::to_string(settings.modes) + " modes of a mesh that has " +
                                std::to_string(left) + "; expected no more");
  MatX<double> x = lowest(of, *mesh, elasticity, Q, settings.modes, settings.make_factor);
  // By their energies, whose error is the square of that of the modes.
  x = root.solve(x);
  const MatX<double> stiffness = x.transpose() * (elasticity.K * x);
  const Eigenpairs inner = symmetric_eigenpairs(stiffness);
  const MatX<double> modes = x * inner.vectors;
  basis.omega2 = inner.values.cwiseMax(0);

  // The fields that make them up, with the constant and X.
  constexpr double dependent = 1e-10;
  MatX<double> fields(n_nodes, 4 + 3 * settings.modes);
  fields.leftCols<4>() << VecX<double>::Ones(n_nodes), mesh->X;
  for (Eigen::Index j = 0; j < settings.modes; ++j)
    fields.middleCols<3>(4 + 3 * j) = modes.col(j).head(3 * n_nodes).reshaped(n_nodes, 3);
  const double mass = mesh->mass.sum();
  const auto phi = std::make_shared<const MatX<double>>(
      std::sqrt(mass) * root.solve_of_nodes(orthonormal_basis(root.root_of_nodes(fields), dependent)));
  basis.mass = VecX<double>::Constant(phi->cols(), mass);
  basis.project = MatX<double>(root.of_nodes() * *phi).transpose() / mass;
  basis.points = mesh->nodes;
  basis.points_at_rest = mesh->X;
  basis.X = basis.project * mesh->X;
  basis.B.resize(3 * phi->cols(), settings.modes);
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
