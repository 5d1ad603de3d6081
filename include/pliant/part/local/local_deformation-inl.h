// Function bodies of LocalDeformation, and the choice of the derived class by the settings.
#pragma once

#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include <Eigen/Cholesky>

#include <pliant/math/eigenvalues.h>
#include <pliant/math/header_only.h>
#include <pliant/part/local/local_deformation.h>
#include <pliant/part/local/modal_deformation.h>
#include <pliant/part/local/nodal_deformation.h>

namespace pliant {

namespace detail {

inline std::unique_ptr<LocalDeformation> local_deformation_of_basis(const Part& part,
                                                                    const LocalSettings& settings) {
  switch (settings.basis) {
    case LocalSettings::Basis::polynomial:
      return std::make_unique<ModalDeformation>(part, settings, make_polynomials(part, settings));
    case LocalSettings::Basis::modes:
      return std::make_unique<ModalDeformation>(part, settings, make_mesh_modes(part, settings));
    default:
      return std::make_unique<NodalDeformation>(part, settings);
  }
}

/// Returns an error message with the name of the part in front, unless the message has this name already.
inline std::string with_part_name(const Part& part, const std::string& error) {
  const std::string name = "part '" + part.name() + "': ";
  return error.compare(0, name.size(), name) == 0 ? error : name + error;
}

/// Returns the inverse of a compliance A, or the pseudo-inverse if A is nearly singular.
inline MatX<double> inverse_of_compliance(const MatX<double>& A) {
  constexpr double smallest = 1e-11;  // smaller eigenvalues of A, scaled to a unit diagonal, are not inverted
  const VecX<double> scale = A.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse();
  const MatX<double> scaled = scale.asDiagonal() * A * scale.asDiagonal();
  constexpr double well_conditioned = 1e-8;
  const Eigen::LLT<MatX<double>> factor(scaled);
  // The condition number of a positive definite matrix with a unit diagonal is below 4 / determinant.
  const double root = factor.matrixLLT().diagonal().prod();
  if (factor.info() == Eigen::Success &&
      (root * root > 4 * well_conditioned || factor.rcond() > well_conditioned))
    return scale.asDiagonal() * factor.solve(MatX<double>(scale.asDiagonal()));
  auto [inverse, vectors] = symmetric_eigenpairs(scaled);
  for (double& value : inverse) value = value > smallest ? 1 / value : 0;
  const MatX<double> V = scale.asDiagonal() * vectors;
  return V * inverse.asDiagonal() * V.transpose();
}

}  // namespace detail

PLIANT_INLINE MeshEnergies make_mesh_energies(const Part& part, const LocalSettings& settings,
                                              const LocalMesh& mesh) {
  MeshEnergies energies;
  for (std::size_t k = 0; k < settings.energies.size(); ++k) {
    try {
      energies.all.push_back(settings.energies[k].make_energy(mesh));
    } catch (const std::invalid_argument& e) {
      throw LocalFault(detail::with_part_name(part, e.what()), static_cast<int>(k));
    }
    const VecX<double> more = energies.all.back()->own_inertia();
    if (more.size() == 0) continue;
    if (energies.own_inertia.size() > 0)
      throw LocalFault(
          detail::with_part_name(part, "only one of its laws may have coordinates of its own, and '" +
                                           settings.energies[k].name + "' is the second"),
          static_cast<int>(k));
    energies.own_inertia = more;
  }
  return energies;
}

PLIANT_INLINE std::unique_ptr<LocalDeformation> make_local_deformation(const Part& part,
                                                                       const LocalSettings& settings) {
  try {
    return detail::local_deformation_of_basis(part, settings);
  } catch (const LocalFault&) {
    throw;
  } catch (const std::invalid_argument& e) {
    throw LocalFault(detail::with_part_name(part, e.what()));
  }
}

PLIANT_INLINE void LocalDeformation::check_start(const Part& part, const Nodes& displacements,
                                                 const VecX<double>& rates) {
  const double farthest = displacements.rowwise().norm().maxCoeff();
  if (farthest <= part.size() && rates.allFinite()) return;
  std::ostringstream message;
  message << "part '" << part.name() << "': at time 0 nodes are displaced by " << farthest
          << " m; expected no more than its size, " << part.size() << " m, and finite velocities";
  throw std::invalid_argument(message.str());
}

PLIANT_INLINE void LocalWorkspace::set_compliance(MatX<double> compliance) {
  A = std::move(compliance);
  A_inverse = detail::inverse_of_compliance(A);
}

PLIANT_INLINE void LocalDeformation::compliance(const std::vector<NodeWeights>& points,
                                                LocalWorkspace& work) const {
  work.set_compliance(work.response != nullptr ? work.response->compliance()
                                               : inertial_compliance(points, work));
}

PLIANT_INLINE void LocalDeformation::push_all(const std::vector<NodeWeights>& points, const VecX<double>& g,
                                              const LocalWorkspace& work,
                                              Eigen::Ref<VecX<double>> d_dot) const {
  if (work.response != nullptr)
    work.response->push(g, d_dot);
  else
    inertial_push_all(points, g, work, d_dot);
}

PLIANT_INLINE VecX<double> at_points(const std::vector<NodeWeights>& points,
                                     const Eigen::Ref<const Nodes>& values) {
  VecX<double> x = VecX<double>::Zero(3 * static_cast<Eigen::Index>(points.size()));
  for (std::size_t k = 0; k < points.size(); ++k)
    for (std::size_t i = 0; i < points[k].node.size(); ++i)
      x.segment<3>(3 * static_cast<Eigen::Index>(k)) +=
          points[k].weight[i] * values.row(points[k].node[i]).transpose();
  return x;
}

}  // namespace pliant
