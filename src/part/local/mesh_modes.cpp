// The lowest modes of a mesh under the reference conditions W^T d = 0, W = M G0, at rest. With M = C^T C,
// x = C d and an orthonormal basis Q of the columns of C G0, the lowest modes x are the eigenvectors with the
// largest eigenvalues nu = 1/(omega^2 + sigma) of
//   x -> s - Y (Q^T Y)^-1 Q^T s,   s = A x,   Y = A Q,   A = C (K + sigma M)^-1 C^T
// Here K is the stiffness, M the mass matrix, and sigma a small shift (shift_of()) that makes K + sigma M
// positive definite. Curved elements use the consistent M: the error of omega is positive and of fourth order
// in the edge length. Straight elements and shells use the lumped M, because the errors of the lumped M and
// of the stiffness have opposite signs.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <stdexcept>

#include <Spectra/SymEigsSolver.h>
#include <Eigen/Cholesky>

#include <pliant/local/solid/solid_mass.h>
#include <pliant/math/column_basis.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/part/local/modal_basis.h>
#include <pliant/part/local/mode_conditions.h>
#include <pliant/part/part.h>

#include "mass_root.h"

namespace pliant {

namespace {

using Sparse = SparseMatrix;

/// Up to this number of coordinates, the dense eigenvalue solver is faster than the iterative solver.
constexpr Eigen::Index kDense = 400;
/// kMaxCoordinates: maximum number of displacement components of the nodes. The factor of a larger stiffness
/// matrix needs gigabytes. kMaxNumbers: maximum number of entries of the fields over nodes.
constexpr Eigen::Index kMaxCoordinates = 120'000;
constexpr double kMaxNumbers = 5e7;

/// Returns M over the nodes of a mesh.
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

/// Throws LocalFault if there is no law, or if a law is not quadratic in d.
void check_laws(const std::string& part_name, const MeshEnergies& energies, const LocalSettings& settings) {
  for (std::size_t k = 0; k < energies.all.size(); ++k)
    if (energies.all[k]->of() != NodalEnergy::Of::displacement)
      throw LocalFault(part_name + "modes support only laws that are quadratic in d, not the law '" +
                           settings.energies[k].name + "'; expected another law, or the basis \"nodes\"",
                       static_cast<int>(k));
  if (energies.all.empty()) throw LocalFault(part_name + "modes need a law; expected at least one");
}

/// Mass and stiffness of a mesh.
struct MeshElasticity {
  MeshElasticity(const LocalMesh& mesh, const MeshEnergies& energies)
      : mass(mass_of(mesh), energies.own_inertia) {
    const Eigen::Index n = mass.size();
    std::vector<Eigen::Triplet<double>> entries;
    for (const auto& energy : energies.all) energy->add_stiffness(VecX<double>::Zero(n), entries);
    K.resize(n, n);
    K.setFromTriplets(entries.begin(), entries.end());
  }
  MassRoot mass;
  Sparse K;
};

/// Returns an orthonormal basis of C G0, the fields of rigid motion and of the dynamic parameters at rest.
MatX<double> basis_of_conditions(const Part& part, const LocalMesh& mesh, const MassRoot& mass) {
  constexpr double dependent = 1e-9;  // see orthonormal_basis()
  const MatX<double> G = rest_frame(part, mesh.nodes, mesh.X);
  MatX<double> all = MatX<double>::Zero(mass.size(), G.cols());
  all.topRows(G.rows()) = G;
  return orthonormal_basis(mass.root(all), dependent);
}

/// The operator (K' + sigma I)^-1, K' = C^-T K C^-1, restricted to the orthogonal complement of Q. The class
/// has the interface that the library Spectra requires.
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
    Y_ = unconstrained(Q);
    inner_.compute(Q.transpose() * Y_);
    positive_ = inner_.info() == Eigen::Success;
  }
  /// Whether K + sigma M is positive definite and Q^T Y is regular.
  bool exists() const { return positive_; }
  Eigen::Index rows() const { return Q_.rows(); }
  Eigen::Index cols() const { return Q_.rows(); }
  void perform_op(const double* in, double* out) const {
    const VecX<double> s = unconstrained(Eigen::Map<const VecX<double>>(in, rows()));
    const VecX<double> multipliers = inner_.solve(Q_.transpose() * s);
    Eigen::Map<VecX<double>>(out, rows()) = s - Y_ * multipliers;
  }

 private:
  /// Returns A x, the response without the conditions.
  MatX<double> unconstrained(const MatX<double>& x) const {
    MatX<double> y = mass_.transposed(x);
    factor_->solve(y);
    return mass_.root(y);
  }

  const MassRoot& mass_;
  const MatX<double>& Q_;
  std::unique_ptr<SparseFactor> factor_;
  bool positive_ = false;
  MatX<double> Y_;
  Eigen::LDLT<MatX<double>> inner_;
};

/// Returns the shift sigma: a tenth of the smallest positive Rayleigh quotient omega^2 of 18 displacement
/// fields. Each field is a product X_j X_k along x, y or z, projected on the complement of the conditions.
double shift_of(const LocalMesh& mesh, const MeshElasticity& elasticity, const MatX<double>& Q) {
  const Eigen::Index n = mesh.X.rows();
  double min_omega2 = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (int k = 0; k <= j; ++k) {
        VecX<double> d = VecX<double>::Zero(elasticity.mass.size());
        d.segment(i * n, n) = mesh.X.col(j).cwiseProduct(mesh.X.col(k));
        VecX<double> x = elasticity.mass.root(d);
        x -= (Q * (Q.transpose() * x)).eval();
        d = elasticity.mass.solve(x);
        const double omega2 = d.dot(elasticity.K * d) / x.squaredNorm();
        if (omega2 > 0) min_omega2 = std::min(min_omega2, omega2);
      }
  return 0.1 * min_omega2;
}

/// Returns the lowest `count` modes x, from all eigenvectors of K' (see Flexibility) on the complement of Q.
MatX<double> lowest_of_all(const MeshElasticity& elasticity, const MatX<double>& Q, Eigen::Index count) {
  const MatX<double> Z = complement_basis(Q), d = elasticity.mass.solve(Z);
  return Z * symmetric_eigenpairs(d.transpose() * (elasticity.K * d)).vectors.leftCols(count);
}

/// A part, the settings of its local deformation, and its mesh.
struct MeshProblem {
  const Part& part;
  const LocalSettings& settings;
  const LocalMesh& mesh;
  std::string part_name = "part '" + part.name() + "': ";

  Eigen::Index count() const { return settings.modes; }
  /// Throws std::invalid_argument for less than one mode, and for too many modes or nodes.
  void check_size() const;
};

/// Returns an orthonormal basis of the span of the lowest modes, in mass-normalised coordinates, one vector
/// in each column. diagonalised() finds the modes in this span.
MatX<double> lowest_modes(const MeshProblem& problem, const MeshElasticity& elasticity,
                          const MatX<double>& Q) {
  const Eigen::Index n = elasticity.mass.size(), count = problem.count();
  if (n <= kDense || 4 * count > n) return lowest_of_all(elasticity, Q, count);
  constexpr double kEigenTolerance = 1e-13;
  constexpr int kMaxIterations = 1000;
  const double sigma = shift_of(problem.mesh, elasticity, Q);
  Flexibility flexibility(elasticity, Q, sigma, problem.settings.make_factor);
  if (!flexibility.exists())
    throw std::invalid_argument(
        problem.part_name + "its stiffness matrix is not positive definite, so its modes cannot be found");
  Spectra::SymEigsSolver<Flexibility> solver(flexibility, count, std::min(n, 2 * count + 20));
  solver.init();
  solver.compute(Spectra::SortRule::LargestAlge, kMaxIterations, kEigenTolerance);
  if (solver.info() != Spectra::CompInfo::Successful)
    throw std::invalid_argument(problem.part_name + "the eigenvalue search found only " +
                                std::to_string(solver.eigenvalues().size()) + " of its " +
                                std::to_string(count) + " modes; expected fewer modes");
  MatX<double> x = solver.eigenvectors();
  x -= (Q * (Q.transpose() * x)).eval();
  return column_basis(x);
}

void MeshProblem::check_size() const {
  const Eigen::Index n_nodes = mesh.X.rows();
  if (count() < 1)
    throw std::invalid_argument(part_name + std::to_string(count()) + " modes; expected at least 1");
  const double numbers = (4.0 + 3 * settings.modes) * static_cast<double>(n_nodes);
  if (3 * n_nodes > kMaxCoordinates || numbers > kMaxNumbers)
    throw std::invalid_argument(part_name + std::to_string(count()) + " modes of a mesh of " +
                                std::to_string(n_nodes) + " nodes are too many; expected at most " +
                                std::to_string(kMaxCoordinates / 3) + " nodes, and nodes times modes below " +
                                std::to_string(static_cast<long>(kMaxNumbers / 3)));
}

/// Modes over the coordinates of a mesh, one in each column of d, sorted by increasing frequency.
struct MeshModes {
  MatX<double> d;
  VecX<double> omega2;
};

/// Returns the modes that diagonalise the stiffness in the span of the columns of x. The error of omega^2 is
/// quadratic in the error of x.
MeshModes diagonalised(const MeshElasticity& elasticity, const MatX<double>& x) {
  const MatX<double> d = elasticity.mass.solve(x);
  const MatX<double> stiffness = d.transpose() * (elasticity.K * d);
  const Eigenpairs inner = symmetric_eigenpairs(stiffness);
  return {d * inner.vectors, inner.values.cwiseMax(0)};
}

/// Returns the displacements of the nodes in mode number j: nodes x 3.
auto nodal_part(const MeshModes& modes, Eigen::Index j, Eigen::Index n_nodes) {
  return modes.d.col(j).head(3 * n_nodes).reshaped(n_nodes, 3);
}

/// Returns scalar fields over nodes (columns) that span the constant, X and the components of the modes. The
/// fields are orthogonal over the mass, and the integral of the square of each field over the mass is the
/// mass of the part.
MatX<double> fields_of(const LocalMesh& mesh, const MassRoot& root, const MeshModes& modes) {
  constexpr double dependent = 1e-10;  // see orthonormal_basis()
  const Eigen::Index n_nodes = mesh.X.rows(), count = modes.d.cols();
  MatX<double> fields(n_nodes, 4 + 3 * count);
  fields.leftCols<4>() << VecX<double>::Ones(n_nodes), mesh.X;
  for (Eigen::Index j = 0; j < count; ++j) fields.middleCols<3>(4 + 3 * j) = nodal_part(modes, j, n_nodes);
  return std::sqrt(mesh.mass.sum()) *
         root.solve_of_nodes(orthonormal_basis(root.root_of_nodes(fields), dependent));
}

/// Returns the fields phi at a material point, interpolated from the nodes; empty for a point inside a shell.
NodeWeights fields_at(const Part& part, const LocalMesh& mesh, const MatX<double>& phi,
                      const Material<double>& m) {
  const NodeWeights among = mesh_weights(part, mesh, m);
  NodeWeights at;
  for (Eigen::Index a = 0; a < phi.cols() && !among.node.empty(); ++a) {
    double sum = 0;
    for (std::size_t i = 0; i < among.node.size(); ++i) sum += among.weight[i] * phi(among.node[i], a);
    at.node.push_back(static_cast<int>(a));
    at.weight.push_back(sum);
  }
  return at;
}

}  // namespace

ModalBasis make_mesh_modes(const Part& part, const LocalSettings& settings) {
  const auto mesh = std::make_shared<const LocalMesh>(make_local_mesh(part, settings));
  const MeshProblem problem{part, settings, *mesh};
  problem.check_size();
  const MeshEnergies energies = make_mesh_energies(part, settings, *mesh);
  check_laws(problem.part_name, energies, settings);
  const MeshElasticity elasticity(*mesh, energies);
  const MassRoot& root = elasticity.mass;
  const MatX<double> Q = basis_of_conditions(part, *mesh, root);
  const Eigen::Index available = root.size() - Q.cols();
  if (settings.modes > available)
    throw std::invalid_argument(problem.part_name + std::to_string(settings.modes) +
                                " modes are requested, but its mesh has only " + std::to_string(available) +
                                "; expected no more");
  const MeshModes modes = diagonalised(elasticity, lowest_modes(problem, elasticity, Q));

  ModalBasis basis;
  basis.omega2 = modes.omega2;
  const Eigen::Index n_nodes = mesh->X.rows();
  const double mass = mesh->mass.sum();
  const auto phi = std::make_shared<const MatX<double>>(fields_of(*mesh, root, modes));
  basis.mass = VecX<double>::Constant(phi->cols(), mass);
  basis.project = MatX<double>(root.of_nodes() * *phi).transpose() / mass;
  basis.points = mesh->nodes;
  basis.points_at_rest = mesh->X;
  basis.X = basis.project * mesh->X;
  basis.B.resize(3 * phi->cols(), settings.modes);
  for (Eigen::Index j = 0; j < settings.modes; ++j)
    basis.B.col(j) = MatX<double>(basis.project * nodal_part(modes, j, n_nodes)).reshaped();
  basis.mesh = *mesh;
  basis.shown = *phi;
  basis.made_of = "a mesh of " + std::to_string(n_nodes) + " nodes";
  basis.weights = [mesh, phi](const Part& of_part, const Material<double>& m) {
    return fields_at(of_part, *mesh, *phi, m);
  };
  return basis;
}

}  // namespace pliant
