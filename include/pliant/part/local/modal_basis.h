// A global basis of local deformation: scalar fields phi_a of material points, orthogonal over the mass of
// the part, and modes, which are combinations of displacements along these fields, Eq. (5),
//   d(u) = sum_a phi_a(u) d_a,   d_a = (B q)_a,   int phi_a phi_b dm = m_a delta_ab
// The coefficients d_a play the role of nodes ("spectral nodes"): the integral over mass of a product of two
// fields is a sum over them, int f g dm = sum_a m_a f_a g_a.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <pliant/part/local/local_deformation.h>

namespace pliant {

struct ModalBasis {
  VecX<double> mass;    ///< m_a, kg; N numbers
  Nodes X;              ///< coefficients of the rest shape: X = sum_a phi_a X_a, m
  MatX<double> B;       ///< 3N x n, all x, then y, then z; B^T M B = I, and W^T d = 0 at the rest shape
  VecX<double> omega2;  ///< squared angular frequencies of the modes, increasing, 1/s^2
  /// Returns phi at a material point; empty where the deformation has no value.
  std::function<NodeWeights(const Part&, const Material<double>&)> weights;
  // `project` gives the coefficients of a field that is not in the span of the phi, from its values at
  // points.
  std::vector<Material<double>> points;
  Nodes points_at_rest;  ///< body frame, m
  MatX<double> project;  ///< N x points
  LocalMesh mesh;        ///< the mesh whose surface pictures show and contact detection uses
  MatX<double> shown;    ///< phi at the nodes of `mesh`: nodes x N
  std::string made_of;   ///< for messages, as in "polynomials of degree 4"
};

/// Makes displacement polynomials of settings.degree over the body of a solid, with exact integrals, and
/// diagonalises its linear elasticity. Throws std::invalid_argument for a shell, for other laws, and for a
/// degree outside 1 to 10 or too high for the part.
ModalBasis make_polynomials(const Part& part, const LocalSettings& settings);
/// Makes the lowest settings.modes modes of a mesh under W^T d = 0. Throws std::invalid_argument for laws
/// that are not quadratic in d, for no law, and for more modes than the mesh has or than fit in memory.
ModalBasis make_mesh_modes(const Part& part, const LocalSettings& settings);

}  // namespace pliant
