// The linear membrane: constant-strain triangles in plane stress, E = 1/2 sum_T q S q of the displacements d
// with q_k = e_k . (d_(k+2) - d_(k+1)) (edge_strain.h). The edges are stored as e_k sqrt(S_kk), so that S has
// a unit diagonal: twelve numbers a triangle.
#pragma once

#include <pliant/local/edge_strain.h>
#include <pliant/local/nodal_energy.h>

namespace pliant {

class LinearMembrane final : public NodalEnergy {
 public:
  /// Throws std::invalid_argument for a sheet that cannot be.
  LinearMembrane(const ShellMesh& mesh, const Sheet& sheet);

  Of of() const override { return Of::displacement; }
  double energy(const VecX<double>& x) const override;
  void add_force(const VecX<double>& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const override;
  void add_derivative(const VecX<double>& x, const VecX<double>& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override;
  void add_stiffness(const VecX<double>& x, std::vector<Eigen::Triplet<double>>& K) const override;
  double frequency_bound(const VecX<double>& x, const VecX<double>& M) const override;

 private:
  struct Triangle {
    Edges<Pack> e;       ///< e_k sqrt(S_kk)
    Pack s01, s12, s20;  ///< S_kl / sqrt(S_kk S_ll)
  };
  using Three = std::array<Pack, 3>;

  static Three stretch(const Triangle& triangle, const std::array<Vec3<Pack>, 3>& d);
  static Three tension(const Triangle& triangle, const Three& q);
  template <class Visit>
  void each_element(Visit&& visit) const;

  ElementBatches<3> batches_;
  std::vector<Triangle> triangles_;
};

}  // namespace pliant
