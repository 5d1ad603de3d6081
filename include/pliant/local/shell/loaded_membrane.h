// The loaded membrane (Terzopoulos & Metaxas 1991), a deformation d that costs by its size and its variation:
//   E = 1/2 int w1 |grad d|^2 + w0 |d|^2,
// on linear triangles, K_ij = w1 A grad N_i . grad N_j + w0 A (1 + delta_ij)/12, the same for x, y and z.
// The integral is over the parameters du dv, as in the paper, where the material is stiffer towards poles; or
// over the surface itself (its gradient by the cotangents of the triangles), which knows no poles.
#pragma once

#include <pliant/local/nodal_energy.h>
#include <pliant/local/shell/edge_strain.h>

namespace pliant {

struct Load {
  enum class Size { consistent, lumped };
  double w0;  ///< of the size: per area of what is integrated over, N/m per unit
  double w1;  ///< of the variation: N/m on parameters, N m per area on the surface
  Size size =
      Size::consistent;  ///< how w0 is integrated: exactly, or a third of each triangle at each corner
};

/// A mesh of the parameter plane. A node at a pole has many v: its coordinates are the corner's, and a cell
/// at a pole is two triangles, of which one has the pole twice.
struct ParameterMesh {
  Eigen::Index n_nodes;
  Eigen::Matrix3Xi triangles;
  Eigen::Matrix2Xd uv;  ///< of corner k of triangle t in column 3 t + k
};

class LoadedMembrane final : public NodalEnergy {
 public:
  /// Over du dv. Throws std::invalid_argument when w0 or w1 is negative or not finite, or when a triangle
  /// names a node that is not there or has no area in the plane.
  LoadedMembrane(const ParameterMesh& mesh, const Load& load);
  /// Over the surface. Throws likewise.
  LoadedMembrane(const ShellMesh& mesh, const Load& load);

  Of of() const override { return Of::displacement; }
  bool isotropic() const override { return true; }
  double energy(const Coordinates& x) const override;
  void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const override;
  void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override;
  void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const override;
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const override;

 private:
  struct Triangle {
    std::array<Pack, 3> spring;  ///< between the ends of edge k: w1 cot(angle k)/2
    Pack alone, together;        ///< of w0: for a corner, and for all three
  };
  using Corners = ElementBatches<3>::Corners;

  LoadedMembrane(const Eigen::Matrix3Xi& triangles, Eigen::Index n_nodes, const Load& load);
  void set(int batch, int lane, const Edges<double>& e, const Load& load);
  /// K d at the corners of a batch.
  Corners pull(int b, const Corners& d) const;
  template <class Visit>
  void each_element(Visit&& visit) const;

  ElementBatches<3> batches_;
  std::vector<Triangle> triangles_;
};

}  // namespace pliant
