// Function bodies of NodalDeformation: construction, and names, units and values of the coordinates.
#pragma once

#include <algorithm>
#include <functional>
#include <stdexcept>
#include <string>

#include <pliant/math/header_only.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/store_jets.h>

namespace pliant {

PLIANT_INLINE double NodalWorkspace::condition() const {
  // The smallest pivot is a cheap estimate of 1 / condition. If the pivot is small, rcond() replaces this
  // estimate.
  constexpr double clearly_regular = 1e-3;
  return std::visit(
      [](const auto& lu) {
        const double pivot = lu.matrixLU().diagonal().cwiseAbs().minCoeff();
        return 1 / (pivot > clearly_regular ? pivot : lu.rcond());
      },
      factor);
}

PLIANT_INLINE NodalDeformation::NodalDeformation(const Part& part, const LocalSettings& settings)
    : LocalDeformation(settings.alpha, settings.beta) {
  mesh_ = make_local_mesh(part, settings);
  packs_ = packs_of(mesh_.nodes);
  MeshEnergies energies = make_mesh_energies(part, settings, mesh_);
  energies_ = std::move(energies.all);
  for (const LocalLaw& law : settings.energies) laws_ += (laws_.empty() ? "" : ", ") + law.name;
  const VecX<double>& own = energies.own_inertia;
  for (const auto& energy : energies_)
    of_positions_ = of_positions_ || energy->of() == NodalEnergy::Of::position;
  inertia_.resize(3 * n_nodes() + own.size());
  inertia_ << mesh_.mass, mesh_.mass, mesh_.mass, own;
  mobility_ = inertia_.cwiseInverse();
  if (part.linear()) linear_ = make_linear(part);
  auto coordinates = [&](const std::function<Vec3<double>(const Vec3<double>&)>& field) {
    VecX<double> values = VecX<double>::Zero(inertia_.size());
    for (Eigen::Index k = 0; field && k < n_nodes(); ++k)
      nodes(values, n_nodes()).row(k) = field(mesh_.X.row(k).transpose()).transpose();
    return values;
  };
  initial_ = coordinates(settings.displacement);
  initial_rate_ = coordinates(settings.velocity);
  check_start(part, nodes(initial_, n_nodes()), initial_rate_);
}

PLIANT_INLINE NodalDeformation::Linear NodalDeformation::make_linear(const Part& part) const {
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

PLIANT_INLINE bool NodalDeformation::stiffness_is_constant() const {
  return std::all_of(energies_.begin(), energies_.end(),
                     [](const auto& energy) { return energy->of() == NodalEnergy::Of::displacement; });
}

PLIANT_INLINE std::string NodalDeformation::coordinate_name(Eigen::Index k) const {
  const Eigen::Index n = n_nodes();
  if (k >= 3 * n) return "own[" + std::to_string(k - 3 * n) + "]";
  return "d[" + std::to_string(k % n) + "]." + "xyz"[k / n];
}

PLIANT_INLINE const char* NodalDeformation::unit(Eigen::Index k) const {
  return k < 3 * n_nodes() ? "m" : "1";
}

PLIANT_INLINE double NodalDeformation::cost() const {
  // Microseconds. bench/soft_step_bench measures the times of a node and a triangle; the other two times are
  // estimates.
  constexpr double node = 0.02, triangle = 0.008, tetrahedron = 0.02, curved = 0.15;
  const LocalMesh& m = mesh();
  const double elements = m.shell() ? triangle * static_cast<double>(m.triangles.cols())
                                    : (m.tetrahedra.rows() == 4 ? tetrahedron : curved) *
                                          static_cast<double>(m.tetrahedra.cols());
  return node * static_cast<double>(n_nodes()) + static_cast<double>(energies_.size()) * elements;
}

PLIANT_INLINE std::string NodalDeformation::description() const {
  const std::string elements = mesh().shell() ? std::to_string(mesh().triangles.cols()) + " triangles"
                                              : std::to_string(mesh().tetrahedra.cols()) + " tetrahedra";
  return std::to_string(n_d()) + " local, of " + std::to_string(n_nodes()) + " nodes and " + elements +
         "; laws: " + laws_;
}

PLIANT_INLINE NodeWeights NodalDeformation::weights(const Part& part, const Material<double>& m) const {
  return mesh_weights(part, mesh_, m);
}

PLIANT_INLINE Eigen::Map<const Nodes> NodalDeformation::at_nodes(const double* q_d, VecX<double>&) const {
  return {q_d, n_nodes(), 3};
}

PLIANT_INLINE Nodes NodalDeformation::displacements(const double* q_d) const {
  return Eigen::Map<const Nodes>(q_d, n_nodes(), 3);
}

PLIANT_INLINE Eigen::Matrix3Xd NodalDeformation::displacements(const double* q_d,
                                                               const std::vector<int>& nodes) const {
  const Eigen::Map<const Nodes> d(q_d, n_nodes(), 3);
  Eigen::Matrix3Xd some(3, static_cast<Eigen::Index>(nodes.size()));
  for (Eigen::Index k = 0; k < some.cols(); ++k)
    some.col(k) = d.row(nodes[static_cast<std::size_t>(k)]).transpose();
  return some;
}

PLIANT_INLINE std::unique_ptr<LocalWorkspace> NodalDeformation::workspace() const {
  return std::make_unique<NodalWorkspace>();
}

}  // namespace pliant
