// The loaded membrane (Terzopoulos & Metaxas 1991): the energy depends on the size of the displacement d and
// on its variation,
//   E = 1/2 int (w1 |grad d|^2 + w0 |d|^2).
// On a linear triangle with area A and shape functions N_i,
//   K_ij = w1 A grad N_i . grad N_j + w0 A (1 + delta_ij)/12   (lumped: w0 A delta_ij/3)
// for each of the directions x, y and z. Two domains of integration are available:
//   ParameterMesh   the parameters, du dv, as published; the material is stiffer near poles
//   ShellMesh       the surface itself, with the cotangent formula for the gradient; poles have no influence
#pragma once

#include <array>
#include <vector>

#include <pliant/local/nodal_energy.h>
#include <pliant/local/shell/edge_strain.h>

namespace pliant {

/// Weights of the loaded membrane.
struct Load {
  /// Integration of w0 |d|^2: `consistent` is exact; `lumped` assigns a third of the area of each triangle to
  /// each of its corners.
  enum class Size { consistent, lumped };
  double w0;  ///< weight of the size |d|^2: N/m on parameters, N/m^3 on the surface
  double w1;  ///< weight of the variation |grad d|^2: N/m
  Size size = Size::consistent;
};

/// A triangle mesh of the parameter rectangle. A node at a pole has a different v in each triangle, so that
/// (u, v) are stored for each corner. Each cell of the (u, v) grid has two triangles. In a cell at a pole,
/// one of the two triangles has the pole at two of its corners.
struct ParameterMesh {
  Eigen::Index n_nodes;
  Eigen::Matrix3Xi triangles;
  Eigen::Matrix2Xd uv;  ///< (u, v) of corner k of triangle t in column 3 t + k
};

class LoadedMembrane final : public NodalEnergy {
 public:
  /// Integrates over du dv. Throws std::invalid_argument if w0 or w1 is negative or not finite, if a triangle
  /// refers to an unknown node or has no area in the plane (u, v), or if uv does not have one column for each
  /// corner.
  LoadedMembrane(const ParameterMesh& mesh, const Load& load);
  /// Integrates over the surface. Throws std::invalid_argument if w0 or w1 is negative or not finite.
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
  /// Constants of four triangles: K_ij of one direction.
  struct Triangles {
    std::array<Pack, 3> spring;  ///< term w1 of -K_ij for the ends of edge k: w1 cot(angle at corner k)/2
    Pack diagonal, uniform;      ///< term w0 of K_ij: uniform + diagonal delta_ij
  };
  using Corners = ElementBatches<3>::Corners;

  LoadedMembrane(const Eigen::Matrix3Xi& triangles, Eigen::Index n_nodes, const Load& load);
  void set_triangle(int batch, int lane, const Edges<double>& e, const Load& load);
  /// Returns K d at the corners of a batch.
  Corners K_times(int batch, const Corners& d) const;
  /// Calls visit(ElementMatrix) with the stiffness of every triangle.
  template <class Visit>
  void each_element(Visit&& visit) const;

  ElementBatches<3> batches_;
  std::vector<Triangles> triangles_;
};

}  // namespace pliant
