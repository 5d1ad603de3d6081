// Bending of thin shells by mid-edge normals (the plate element of Morley 1968; on surfaces Grinspun et al.
// 2006). Each edge has a normal at its middle that turns about the edge. It stands between those of its two
// triangles, turned on by phi, an own coordinate of the energy, so that against the triangles it has turned
// by
//   alpha = dtheta/2 + phi on the left,  dtheta/2 - phi on the right   (phi alone on the boundary),
// dtheta: change of the angle between the triangles since rest. Each triangle is bent by the constant
// curvature
//   kappa = 1/A sum_k alpha_k |e_k| n_k n_k^T,   n_k across edge k, outwards;   E = 1/2 sum_T alpha Q alpha.
// alpha also has what the strain of the triangle itself turns, C q (edge_strain.h), so that kappa is the
// change of Koiter and Sanders. It converges on any mesh; angles alone do not. phi is no part of any motion
// of the nodes: it has inertia (rotary, rho t^3/12) but no momentum, and rigid motion leaves it alone. Free
// edges have no moment.
#pragma once

#include <pliant/local/nodal_energy.h>
#include <pliant/local/shell/hinges.h>
#include <pliant/local/shell/shell_edges.h>

namespace pliant {

/// Hinges: LinearHinges (of displacements, angles linear in them about rest) or FoldingHinges (of positions,
/// any folds short of half a turn from rest).
template <class Hinges>
class MidEdgeBending final : public NodalEnergy {
 public:
  /// area_density: kg/m^2. Throws std::invalid_argument for a sheet that cannot be, and as shell_edges.
  MidEdgeBending(const ShellMesh& mesh, const Sheet& sheet, double area_density);

  Of of() const override { return Hinges::kOf; }
  /// phi of the edges in the order of shell_edges: kg m^2.
  VecX<double> own_inertia() const override { return own_inertia_; }
  double energy(const Coordinates& x) const override;
  void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const override;
  void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override;
  void add_viscous_force(const Coordinates& x, const Coordinates& x_dot, VecX<double>& f, Buffer& buffer,
                         ThreadPool* pool) const override;
  void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const override;
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const override;

 private:
  using Three = std::array<Pack, 3>;
  using Corners = HingeCorners<Pack>;
  using TriangleCorners = ElementBatches<3>::Corners;
  struct Triangles {
    Three Q_diagonal, Q_off;  ///< Q_00 Q_11 Q_22, Q_12 Q_20 Q_01
    std::array<Three, 3> C;   ///< C_kl
    Three side;               ///< 1 where the triangle is on the left of its edge, -1 on the right
    std::array<std::array<int, Pack::kLanes>, 3> edge, angle;  ///< numbers of phi and of dtheta
  };
  /// Where a buffer keeps the changes of angles and the moments dE/dalpha; the forces of corners come first.
  struct Places {
    double *corners, *angles, *moments;
  };
  Places places(Buffer& buffer, int copies) const;
  int n_angles() const { return Pack::kLanes * batches_.n_batches() + 1; }
  std::size_t n_moments() const { return 3 * Pack::kLanes * triangles_.size(); }

  void set_coupling(const ShellMesh& mesh);
  /// alpha of a batch of triangles that are strained by q.
  static Three turns(const Triangles& triangles, const double* angles, const double* phi, const Three& q);
  static Three moments(const Triangles& triangles, const Three& alpha);
  /// C^T m.
  static Three tensions(const Triangles& triangles, const Three& m);
  Three moments_at(int batch, const double* m) const;
  /// angles and strains, strain(batch), -> moments of all triangles.
  template <class F>
  void fill_moments(const double* angles, const double* phi, double* moments, ThreadPool* pool,
                    F&& strain) const;
  template <class F>
  void fill_angles(double* angles, ThreadPool* pool, F&& f) const;
  /// dE/dtheta of the edges of a batch.
  Pack hinge_moment(int batch, const double* moments) const;
  void add_own_forces(VecX<double>& f, const double* moments) const;
  /// What the turns of angles at dx do to angles and moments.
  void fill_changes(const Coordinates& x, const Coordinates& dx, double* angles, double* moments,
                    ThreadPool* pool) const;
  /// What moments push on nodes at x and on the own coordinates.
  void push(const Coordinates& x, const double* moments, VecX<double>& f, double* corners,
            ThreadPool* pool) const;
  template <class Visit>
  void each_element(const Coordinates& x, Visit&& visit) const;

  Eigen::Index n_nodes_;
  Eigen::Matrix3Xi corners_;
  std::vector<ShellEdge> edges_;
  int n_inside_ = 0;  ///< edges between two triangles
  ElementBatches<4> batches_;
  ElementBatches<3> corner_batches_;
  bool curved_ = false;  ///< at rest; C = 0 on a flat mesh
  Hinges hinges_;
  std::vector<Triangles> triangles_;
  std::vector<std::array<int, 2>> moment_places_;  ///< of an edge: on its left, on its right
  VecX<double> own_inertia_;
};

using LinearBending = MidEdgeBending<LinearHinges>;
using FoldingBending = MidEdgeBending<FoldingHinges>;

extern template class MidEdgeBending<LinearHinges>;
extern template class MidEdgeBending<FoldingHinges>;

}  // namespace pliant
