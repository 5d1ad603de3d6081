#include <pliant/part/local/nodal_deformation.h>

#include <algorithm>
#include <stdexcept>

#include "part/quadrature/store_jets.h"

namespace pliant {

double NodalWorkspace::condition() const {
  // A unit triangle times pivots none of which is small is far from singular.
  constexpr double clear = 1e-3;
  return std::visit(
      [](const auto& lu) {
        const double pivot = lu.matrixLU().diagonal().cwiseAbs().minCoeff();
        return 1 / (pivot > clear ? pivot : lu.rcond());
      },
      factor);
}

NodalDeformation::NodalDeformation(const Part& part, const LocalSettings& settings)
    : LocalDeformation(settings.alpha, settings.beta) {
  mesh_ = make_local_mesh(part, settings);
  packs_ = packs_of(mesh_.nodes);
  LaidEnergies laid = lay_energies(part, settings, mesh_);
  energies_ = std::move(laid.all);
  for (const LocalLaw& law : settings.energies) laws_ += (laws_.empty() ? "" : ", ") + law.name;
  const VecX<double>& own = laid.own_inertia;
  for (const auto& energy : energies_)
    of_positions_ = of_positions_ || energy->of() == NodalEnergy::Of::position;
  inertia_.resize(3 * n_nodes() + own.size());
  inertia_ << mesh_.mass, mesh_.mass, mesh_.mass, own;
  mobility_ = inertia_.cwiseInverse();
  if (part.linear()) linear_ = lay_linear(part);
  auto at_nodes = [&](const std::function<Vec3<double>(const Vec3<double>&)>& of) {
    VecX<double> values = VecX<double>::Zero(inertia_.size());
    for (Eigen::Index k = 0; of && k < n_nodes(); ++k)
      nodes(values, n_nodes()).row(k) = of(mesh_.X.row(k).transpose()).transpose();
    return values;
  };
  initial_ = at_nodes(settings.displacement);
  initial_rate_ = at_nodes(settings.velocity);
  check_start(part, nodes(initial_, n_nodes()), initial_rate_);
}

NodalDeformation::Linear NodalDeformation::lay_linear(const Part& part) const {
  const int n_s = part.parameters().n_dynamic();
  const Eigen::Index n = n_nodes();
  const VecMax<double> zero = VecMax<double>::Zero(n_s);
  Linear linear{Nodes(n, 3), MatX<double>(3 * n, n_s), LinearInertia(n_s)};
  Counters unused;
  store_jets(part, zero, zero, packs_, {n, linear.s_0.data(), nullptr, nullptr, linear.J.data()}, unused);
  Eigen::Matrix3Xd s(3, 1 + n_s);
  for (Eigen::Index i = 0; i < n; ++i) {
    s.col(0) = linear.s_0.row(i);
    for (int k = 0; k < n_s; ++k) s.col(1 + k) = nodes(linear.J.col(k), n).row(i);
    linear.inertia.add(s, inertia_[i]);
  }
  return linear;
}

bool NodalDeformation::stiffness_is_constant() const {
  return std::all_of(energies_.begin(), energies_.end(),
                     [](const auto& energy) { return energy->of() == NodalEnergy::Of::displacement; });
}

std::string NodalDeformation::coordinate_name(Eigen::Index k) const {
  const Eigen::Index n = n_nodes();
  if (k >= 3 * n) return "own[" + std::to_string(k - 3 * n) + "]";
  return "d[" + std::to_string(k % n) + "]." + "xyz"[k / n];
}

const char* NodalDeformation::unit(Eigen::Index k) const {
  return k < 3 * n_nodes() ? "m" : "1";
}

double NodalDeformation::cost() const {
  // Nodes and triangles as bench/soft_step_bench measures them; the others are estimates.
  constexpr double node = 0.02, triangle = 0.008, tetrahedron = 0.02, curved = 0.15;
  const LocalMesh& m = mesh();
  const double elements = m.shell() ? triangle * static_cast<double>(m.triangles.cols())
                                    : (m.tetrahedra.rows() == 4 ? tetrahedron : curved) *
                                          static_cast<double>(m.tetrahedra.cols());
  return node * static_cast<double>(n_nodes()) + static_cast<double>(energies_.size()) * elements;
}

std::string NodalDeformation::description() const {
  const std::string elements = mesh().shell() ? std::to_string(mesh().triangles.cols()) + " triangles"
                                              : std::to_string(mesh().tetrahedra.cols()) + " tetrahedra";
  return std::to_string(n_d()) + " local, of " + std::to_string(n_nodes()) + " nodes and " + elements +
         "; laws: " + laws_;
}

NodeWeights NodalDeformation::weights(const Part& part, const Material<double>& m) const {
  return mesh_weights(part, mesh_, m);
}

Eigen::Map<const Nodes> NodalDeformation::at_nodes(const double* q_d, VecX<double>&) const {
  return {q_d, n_nodes(), 3};
}

Nodes NodalDeformation::displacements(const double* q_d) const {
  return Eigen::Map<const Nodes>(q_d, n_nodes(), 3);
}

Eigen::Matrix3Xd NodalDeformation::displacements(const double* q_d, const std::vector<int>& nodes) const {
  const Eigen::Map<const Nodes> d(q_d, n_nodes(), 3);
  Eigen::Matrix3Xd some(3, static_cast<Eigen::Index>(nodes.size()));
  for (Eigen::Index k = 0; k < some.cols(); ++k)
    some.col(k) = d.row(nodes[static_cast<std::size_t>(k)]).transpose();
  return some;
}

std::unique_ptr<LocalWorkspace> NodalDeformation::workspace() const {
  return std::make_unique<NodalWorkspace>();
}

}  // namespace pliant
