// Bending of thin shells by mid-edge normals (plate element of Morley 1968; on surfaces Grinspun et al.
// 2006). Each edge has a normal at its middle, which can rotate about the edge. phi (rad) is the angle from
// the mean of the normals of both triangles to this normal. With LinearHinges the own coordinate of an edge
// (nodal_energy.h) is phi. With FoldingHinges the own coordinate is y = phi + g(dtheta), so that a fold can
// pass half a turn (fold_turn.h); g = 0 for folds of up to a right angle.
// Relative to the two triangles the normal has rotated since rest by
//   alpha = dtheta/2 + phi on the left,  dtheta/2 - phi on the right   (boundary edge: alpha = phi),
// with dtheta the change of the angle between the triangles (hinge.h). The curvature of a triangle is
// constant,
//   kappa = 1/A sum_k alpha_k |e_k| n_k n_k^T,   n_k normal to edge k in the plane of the triangle, outwards,
// and the energy is
//   E = 1/2 sum over triangles of alpha Q alpha,
//   Q_kl = D/A [(1 - nu)(e_k . e_l)^2/(|e_k||e_l|) + nu |e_k||e_l|]   (D: sheet.h).
// On a curved rest shape alpha also has a term C q of the strain q of the triangle (edge_strain.h). With this
// term kappa is the bending strain of Koiter and Sanders. The element converges on any mesh; an energy of
// dtheta alone does not. phi has the rotary inertia rho t^3/12 for each unit of area, with the density rho
// and the thickness t. This inertia does not contribute to the momentum of the part, and rigid motion does
// not change phi. Boundary edges are free of moments.
#pragma once

#include <array>
#include <vector>

#include <pliant/local/nodal_energy.h>
#include <pliant/local/shell/hinges.h>
#include <pliant/local/shell/shell_edges.h>

namespace pliant {

/// Hinges: LinearHinges (energy of displacements, dtheta is linear in the displacements) or FoldingHinges
/// (energy of positions, for any number of turns of a fold; |phi| must be below pi/2).
template <class Hinges>
class MidEdgeBending final : public NodalEnergy {
 public:
  /// area_density: mass of the shell for each unit of area, kg/m^2. Throws std::invalid_argument unless
  /// area_density is positive and finite. Also throws the errors of Sheet::check and shell_edges.
  MidEdgeBending(const ShellMesh& mesh, const Sheet& sheet, double area_density);

  Of of() const override { return Hinges::kOf; }
  /// Returns the inertia of the own coordinates for the edges in the order of shell_edges, kg m^2.
  VecX<double> own_inertia() const override { return own_inertia_; }
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
  /// One number for each edge of a triangle.
  using PerEdge = std::array<Pack, 3>;
  using Corners = HingeCorners<Pack>;
  using TriangleCorners = ElementBatches<3>::Corners;
  /// Constants of four triangles.
  struct Triangles {
    PerEdge Q_diagonal, Q_off_diagonal;  ///< Q_00 Q_11 Q_22, Q_12 Q_20 Q_01, N m
    std::array<PerEdge, 3> C;            ///< C_kl, 1/m^2
    PerEdge side;                        ///< 1: the triangle is on the left of its edge; -1: on the right
    std::array<std::array<int, Pack::kLanes>, 3> edge, angle;  ///< indices of phi and of dtheta of each edge
  };
  /// Sections of the buffer: corner forces of batches, dtheta of hinges, moments m = dE/dalpha of triangles,
  /// g' of hinges (fold_turn.h) and phi of edges. LinearHinges do not use the last two.
  struct Scratch {
    double *corners, *angles, *moments, *slopes, *phi;
  };
  Scratch scratch(Buffer& buffer) const;
  /// Length of an array of dtheta. Its last entry is 0, for boundary edges.
  int n_angles() const { return Pack::kLanes * hinge_batches_.n_batches() + 1; }
  std::size_t n_moments() const { return 3 * Pack::kLanes * triangles_.size(); }

  // The constructor computes Triangles::C from the curvature at rest with these four functions.
  void set_coupling(const ShellMesh& mesh);
  void set_coupling(const ShellMesh& mesh, int t, const double* angles, const double* phi);
  std::vector<double> rest_angles(const ShellMesh& mesh) const;
  VecX<double> rest_rotations(const double* angles) const;

  /// Returns alpha of four triangles with strain q.
  static PerEdge rotations(const Triangles& triangles, const double* angles, const double* phi,
                           const PerEdge& q);
  /// Returns m = Q alpha, N m.
  static PerEdge moments(const Triangles& triangles, const PerEdge& alpha);
  /// Returns the tensions C^T m, N/m.
  static PerEdge tensions(const Triangles& triangles, const PerEdge& m);
  PerEdge moments_at(int batch, const double* m) const;
  /// Calls act(batch) for all batches of hinges.
  template <class Act>
  void for_each_hinge_batch(ThreadPool* pool, Act&& act) const;
  /// Computes dtheta, g' and phi at x. Returns phi of all edges.
  const double* compute_rotations(const Coordinates& x, const Scratch& to, ThreadPool* pool) const;
  /// Computes g' at x and the changes of dtheta and phi along dx. Returns the changes of phi of all edges.
  const double* compute_rotation_changes(const Coordinates& x, const Coordinates& dx, const Scratch& to,
                                         ThreadPool* pool) const;
  /// Computes phi = y - g of the hinges of a batch, without half turns (remove_turns). turn: g; own: y of all
  /// edges.
  void unwrap(int batch, const Pack& turn, const double* own, const Scratch& to) const;
  /// Computes the moments of all triangles from dtheta and phi. strain(batch) returns q of four triangles.
  template <class Strain>
  void compute_moments(const double* angles, const double* phi, double* moments, ThreadPool* pool,
                       Strain&& strain) const;
  /// Computes angles and moments at x.
  void compute_state(const Coordinates& x, const Scratch& to, ThreadPool* pool) const;
  /// Computes the changes of angles and moments along dx.
  void compute_changes(const Coordinates& x, const Coordinates& dx, const Scratch& to,
                       ThreadPool* pool) const;
  /// Returns dE/dphi of the hinges of a batch, N m.
  Pack own_moment(int batch, const double* moments) const;
  /// Returns dE/dtheta of the hinges of a batch with constant own coordinates, N m.
  Pack hinge_moment(int batch, const Scratch& at) const;
  /// Adds to f the forces of the moments on the nodes and on the own coordinates. x: current coordinates.
  void add_forces(const Coordinates& x, const Scratch& at, VecX<double>& f, ThreadPool* pool) const;
  /// Adds to f the changes of the nodal forces along dx with constant moments.
  void add_geometric_change(const Coordinates& x, const Coordinates& dx, const Scratch& now, VecX<double>& f,
                            ThreadPool* pool) const;
  /// Adds to f the forces of the moments on the own coordinates.
  void add_own_forces(VecX<double>& f, const double* moments) const;

  /// Stiffness of one triangle while it is assembled.
  struct Stiffness;
  /// Terms of a matrix: K, or V of add_viscosity(), which is K without the geometric stiffness.
  enum class Terms { stiffness, viscosity };
  /// Returns the matrix of triangle t at x. angles, phi: dtheta of all hinges and phi of all edges at x.
  Stiffness triangle_matrix(int t, const Coordinates& x, const double* angles, const double* phi,
                            Terms terms) const;
  /// Adds the terms of edge k of triangle t to its stiffness. moment: dE/dalpha at this edge, N m. A boundary
  /// edge has no hinge.
  void add_edge(int t, int k, double moment, const Coordinates& x, Stiffness& to) const;
  /// Adds the terms of the strain q of the triangle in `lane`. edges, tension: values of its batch.
  static void add_strain(const Triangles& triangles, int lane, const Edges<Pack>& edges,
                         const PerEdge& tension, Stiffness& to);
  /// Calls visit(ElementMatrix) with the matrix of every triangle at x.
  template <class Visit>
  void each_element(const Coordinates& x, Terms terms, Visit&& visit) const;

  Eigen::Index n_nodes_;
  Eigen::Matrix3Xi triangle_nodes_;
  std::vector<ShellEdge> edges_;
  int n_hinges_ = 0;  ///< number of edges between two triangles, which come first in edges_
  ElementBatches<4> hinge_batches_;
  ElementBatches<3> triangle_batches_;
  bool curved_ = false;  ///< whether the rest shape is curved; C = 0 on a flat mesh
  Hinges hinges_;
  std::vector<Triangles> triangles_;
  std::vector<std::array<int, 2>> moment_index_;  ///< of each edge: indices of its left and right moment
  VecX<double> own_inertia_;
};

using LinearBending = MidEdgeBending<LinearHinges>;
using FoldingBending = MidEdgeBending<FoldingHinges>;

extern template class MidEdgeBending<LinearHinges>;
extern template class MidEdgeBending<FoldingHinges>;

}  // namespace pliant
