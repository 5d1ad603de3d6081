// A global basis of local deformation: scalar fields phi_a of material points, orthogonal over the mass of
// the part, and the modes that displacements along them make,
//   d(u) = sum_a phi_a(u) d_a,   d_a = (B q)_a,   int phi_a phi_b dm = m_a delta_ab
// The numbers d_a stand for nodes ("spectral nodes"): an integral over mass of a product of fields is a sum
// over them, int f g dm = sum_a m_a f_a g_a.
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
  VecX<double> omega2;  ///< of the modes, increasing, 1/s^2
  /// phi at a material point; none where the deformation does not reach.
  std::function<NodeWeights(const Part&, const Material<double>&)> weights;
  // Fields that are no sums of phi are projected by their values at points.
  std::vector<Material<double>> points;
  Nodes points_at_rest;  ///< body frame, m
  MatX<double> project;  ///< N x points: coefficients from values
  LocalMesh mesh;        ///< by which it is shown
  MatX<double> shown;    ///< phi at the nodes of that: nodes x N
  std::string made_of;   ///< "polynomials of degree 4"
};

/// Displacement polynomials of settings.degree over the body of a solid, with exact integrals, that
/// diagonalise its linear elasticity. Throws std::invalid_argument for a shell, and for other laws.
ModalBasis make_polynomials(const Part& part, const LocalSettings& settings);
/// The lowest settings.modes modes of a mesh under W^T d = 0. Throws std::invalid_argument for laws that are
/// not quadratic in d.
ModalBasis make_mesh_modes(const Part& part, const LocalSettings& settings);

}  // namespace pliant
