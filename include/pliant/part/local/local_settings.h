// The settings of the local deformation of a part: basis, laws of elasticity, initial values and damping.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/math/sparse_factor.h>
#include <pliant/part/local/local_mesh.h>

namespace pliant {

/// A law of elasticity for any mesh. local_laws.h lists the laws that a scene can name.
struct LocalLaw {
  using MakeEnergy = std::function<std::unique_ptr<NodalEnergy>(const LocalMesh&)>;
  /// The arguments are the values of make_energy, name and linear. The name is for messages.
  template <class F, class = std::enable_if_t<std::is_constructible_v<MakeEnergy, F>>>
  LocalLaw(F on_mesh, std::string law_name = "of the user", std::optional<Elasticity> of_solid = {})
      : make_energy(std::move(on_mesh)), name(std::move(law_name)), linear(of_solid) {}

  MakeEnergy make_energy;  ///< makes the energy of a mesh
  std::string name;
  std::optional<Elasticity> linear;  ///< the constants of linear elasticity of a solid; empty for another
                                     ///< law. Basis::polynomial needs only these constants
};

/// The error that a local deformation cannot be made.
struct LocalFault : std::invalid_argument {
  LocalFault(const std::string& what, int of_law = -1) : std::invalid_argument(what), law(of_law) {}
  int law;  ///< number of the faulty law in LocalSettings::energies; -1 if no law is at fault
};

struct LocalSettings {
  /// The basis S of d = S q_d, Eq. (5). nodes: q_d consists of the displacements of the nodes of a mesh.
  /// polynomial: q_d consists of the amplitudes of modes that are displacement polynomials over the body of a
  /// solid. modes: q_d consists of the amplitudes of the lowest modes of a mesh.
  enum class Basis { nodes, polynomial, modes };
  Basis basis = Basis::nodes;
  int degree = 4;      ///< for Basis::polynomial: degree of the polynomials, 1 to 10
  int modes = 20;      ///< for Basis::modes: number of modes
  int resolution = 8;  ///< edges of the mesh along an eighth of a great circle, see Surface and Solid
  int order = 1;       ///< elements of a solid: 1 straight, 4 nodes; 2 curved, 15 nodes (10 for Basis::modes)
  using Law = LocalLaw;
  std::vector<Law> energies;
  /// Displacement (m) and velocity (m/s) at time 0 as functions of the position at rest (body frame, m).
  /// Empty: zero.
  std::function<Vec3<double>(const Vec3<double>&)> displacement, velocity;
  double alpha = 0, beta = 0;  ///< damping D = alpha M + beta K of the local coordinates, 1/s and s
  /// For Basis::modes: makes the factorisation of the stiffness matrix of the mesh. For more than some ten
  /// thousand coordinates, CHOLMOD (solve/cholmod_factor.h) is many times faster than Eigen.
  MakeSparseFactor make_factor = make_eigen_factor;
};

/// The energies of the laws of a part on a mesh.
struct MeshEnergies {
  std::vector<std::unique_ptr<NodalEnergy>> all;
  /// Inertia of the own coordinates of an energy (local/nodal_energy.h); empty if no energy has own
  /// coordinates.
  VecX<double> own_inertia;
};
/// Returns the energies. Throws LocalFault if a law cannot be evaluated on the mesh, or if a second law has
/// own coordinates.
MeshEnergies make_mesh_energies(const Part& part, const LocalSettings& settings, const LocalMesh& mesh);

}  // namespace pliant
