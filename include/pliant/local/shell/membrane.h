// Membranes for large deformation: constant-strain triangles whose energy depends on the whole deformation
// from rest to the current positions p = s + d. Tensions tau_k = dW/dq_k act along the current edges e_k
// (edge_strain.h):
//   q_k = (|e_k|^2 - |e_k|_rest^2)/2,   dq_k = e_k . de_k,
//   d(tau_k e_k) = (dtau_k/dq . dq) e_k + tau_k de_k.
#pragma once

#include <array>
#include <vector>

#include <pliant/local/nodal_energy.h>
#include <pliant/local/shell/membrane_laws.h>
#include <pliant/local/solid/element_matrix.h>

namespace pliant {

/// Law: StVenantKirchhoffSheet, NeoHookeanSheet or NeoHookeanLogSheet (membrane_laws.h).
template <class Law>
class Membrane final : public NodalEnergy {
 public:
  /// Throws the errors of Sheet::check.
  Membrane(const ShellMesh& mesh, const Sheet& sheet);

  Of of() const override { return Of::position; }
  /// Returns E, J. If a triangle has no area, E of NeoHookeanSheet is infinite or NaN. With
  /// NeoHookeanLogSheet the energy, the elastic force, its derivative, the stiffness and frequency_bound()
  /// then throw InvertedElement.
  double energy(const Coordinates& x) const override;
  void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const override;
  void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override;
  void add_viscous_force(const Coordinates& x, const Coordinates& x_dot, VecX<double>& f, Buffer& buffer,
                         ThreadPool* pool) const override;
  void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const override;
  void add_viscosity(const Coordinates& x, std::vector<Eigen::Triplet<double>>& V) const override;
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const override;

 private:
  /// Constants of four triangles.
  struct Batch {
    typename Law::Triangles law;
    std::array<Pack, 3> rest;  ///< |e_k|^2 / 2 at rest, m^2

    /// Returns q at the current edges e, m^2.
    std::array<Pack, 3> strain(const Edges<Pack>& e) const {
      return {0.5 * e[0].dot(e[0]) - rest[0], 0.5 * e[1].dot(e[1]) - rest[1], 0.5 * e[2].dot(e[2]) - rest[2]};
    }
  };
  const Batch& batch(int b) const { return triangles_[static_cast<std::size_t>(b)]; }
  /// Returns G^T slope G of one triangle with the current edges e, where dq = G dx. slope: dtau/dq of the
  /// triangles of batch b.
  ElementMatrix<9> element_of(int b, int lane, const Edges<Pack>& e,
                              const std::array<std::array<Pack, 3>, 3>& slope) const;
  /// Calls visit(ElementMatrix) with the stiffness of every triangle at x.
  template <class Visit>
  void each_element(const Coordinates& x, Visit&& visit) const;

  ElementBatches<3> batches_;
  std::vector<Batch> triangles_;
};

using StVenantKirchhoffMembrane = Membrane<StVenantKirchhoffSheet>;
using NeoHookeanMembrane = Membrane<NeoHookeanSheet>;
using NeoHookeanLogMembrane = Membrane<NeoHookeanLogSheet>;

extern template class Membrane<StVenantKirchhoffSheet>;
extern template class Membrane<NeoHookeanSheet>;
extern template class Membrane<NeoHookeanLogSheet>;

}  // namespace pliant
