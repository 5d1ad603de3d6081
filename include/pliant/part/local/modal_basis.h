// A global basis of local deformation, Eq. (5). It consists of N scalar fields phi_a of material points u,
// which are orthogonal over the mass of the part, and of n modes (columns of B) with amplitudes q. A mode is
// a displacement whose components are combinations of the fields:
//   d(u) = sum_a phi_a(u) d_a,   d_a = (B q)_a,   int phi_a phi_b dm = m_a delta_ab
// The indices a play the role of nodes ("spectral nodes") with masses m_a and displacements d_a: the integral
// over mass of a product of two fields f and g is a sum over spectral nodes, int f g dm = sum_a m_a f_a g_a.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <pliant/part/local/local_deformation.h>

namespace pliant {

struct ModalBasis {
  VecX<double> mass;    ///< m_a, kg; N numbers
  Nodes X;              ///< coefficients of the rest shape: X = sum_a phi_a X_a, m
  MatX<double> B;       ///< 3N x n; rows: x of all N fields, then y, then z; B^T M B = I; W^T d = 0 at rest
  VecX<double> omega2;  ///< squared angular frequencies of the modes, increasing, 1/s^2
  /// Returns the values of all phi_a at a material point; empty for a point inside a shell.
  std::function<NodeWeights(const Part&, const Material<double>&)> weights;
  // `project` times the values of a field at `points` gives the coefficients of the projection of this field
  // on the phi_a.
  std::vector<Material<double>> points;
  Nodes points_at_rest;  ///< body frame, m
  MatX<double> project;  ///< N x points
  LocalMesh mesh;        ///< its surface is used for pictures and for contact detection
  MatX<double> shown;    ///< phi at the nodes of `mesh`: nodes x N
  std::string made_of;   ///< for messages, for example "polynomials of degree 4"
};

/// Returns the modes that diagonalise the linear elasticity of a solid among displacement polynomials of
/// settings.degree. The integrals are exact to rounding for most shapes. Throws std::invalid_argument for a
/// shell, for a law other than linear elasticity, for a degree outside 1 to 10, and if the degree is too high
/// or too low for the part.
ModalBasis make_polynomials(const Part& part, const LocalSettings& settings);
/// Returns the lowest settings.modes modes of a mesh under W^T d = 0. Throws std::invalid_argument if there
/// is no law, if a law is not quadratic in d, if the stiffness or the mass matrix is not positive definite,
/// if the eigenvalue search fails, for less than one mode, and for more modes than the mesh has or memory
/// allows.
ModalBasis make_mesh_modes(const Part& part, const LocalSettings& settings);

}  // namespace pliant
