// The linear membrane: constant-strain triangles in plane stress,
//   E = 1/2 sum over triangles of q S q,   q_k = e_k . (d_(k+2) - d_(k+1))   (edge_strain.h).
// The edges are stored as e_k sqrt(S_kk), so that S has a unit diagonal: twelve numbers for each triangle.
#pragma once

#include <array>
#include <vector>

#include <pliant/local/nodal_energy.h>
#include <pliant/local/shell/edge_strain.h>

namespace pliant {

class LinearMembrane final : public NodalEnergy {
 public:
  /// Throws the errors of Sheet::check.
  LinearMembrane(const ShellMesh& mesh, const Sheet& sheet);

  Of of() const override { return Of::displacement; }
  double energy(const Coordinates& x) const override;
  void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const override;
  void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override;
  void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const override;
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const override;

 private:
  using PerEdge = std::array<Pack, 3>;
  /// Constants of four triangles.
  struct Triangles {
    Edges<Pack> e;       ///< e_k sqrt(S_kk)
    Pack s01, s12, s20;  ///< S_kl / sqrt(S_kk S_ll)

    /// Returns q_k sqrt(S_kk).
    PerEdge strain(const std::array<Vec3<Pack>, 3>& d) const {
      const Edges<Pack> change = edges_of(d);
      return {e[0].dot(change[0]), e[1].dot(change[1]), e[2].dot(change[2])};
    }
    /// Returns tau_k / sqrt(S_kk).
    PerEdge tension(const PerEdge& q) const {
      return {q[0] + s01 * q[1] + s20 * q[2], q[1] + s01 * q[0] + s12 * q[2], q[2] + s20 * q[0] + s12 * q[1]};
    }
  };

  /// Calls visit(ElementMatrix) with the stiffness of every triangle.
  template <class Visit>
  void each_element(Visit&& visit) const;

  ElementBatches<3> batches_;
  std::vector<Triangles> triangles_;
};

}  // namespace pliant
