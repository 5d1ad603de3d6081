// Elastic energy of a solid made of tetrahedra: E = sum over elements and quadrature points of weight * W(G).
// The weight is the weight of the quadrature rule times det dX/dxi. For nodal vectors x the gradient is
//   G = sum_a x_a (dN_a/dX)^T = (dx/dxi) (dX/dxi)^-1,
// where x = d for the linear law and x = p = s + d for the other laws. The force on node a is
//   f_a = -sum of weight * P (dX/dxi)^-T dN_a/dxi,   P = dW/dG.
// K dx at node a is -f_a with P replaced by dP, the change of P along the gradient of dx. One kernel serves
// every element (tetrahedron.h) and every law. (dX/dxi)^-1 is stored for each quadrature point.
#pragma once

#include <array>
#include <vector>

#include <pliant/local/linear_law.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/local/solid/corotated.h>
#include <pliant/local/solid/element_corners.h>
#include <pliant/local/solid/hooke.h>
#include <pliant/local/solid/neo_hookean.h>
#include <pliant/local/solid/neo_hookean_log.h>
#include <pliant/local/solid/st_venant_kirchhoff.h>
#include <pliant/local/solid/tetrahedron.h>

namespace pliant {

/// Element: a type of tetrahedron.h. Law: LinearLaw, StVenantKirchhoff, NeoHookean, NeoHookeanLog or
/// Corotated.
template <class Element, class Law>
class SolidEnergy final : public NodalEnergy {
 public:
  static constexpr int N = Element::n_nodes;

  /// rest: positions X of the nodes at rest, m. elements: N node numbers in each column. Throws
  /// std::invalid_argument for another number of rows, for node numbers that `rest` does not have, and if
  /// det dX/dxi <= 0 at a quadrature point.
  SolidEnergy(const Nodes& rest, const Eigen::MatrixXi& elements, const Law& law);

  Of of() const override { return Law::of; }
  double energy(const Coordinates& x) const override;
  void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const override;
  void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override;
  void add_viscous_force(const Coordinates& x, const Coordinates& x_dot, VecX<double>& f, Buffer& buffer,
                         ThreadPool* pool) const override;
  void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const override;
  void add_viscosity(const Coordinates& x, std::vector<Eigen::Triplet<double>>& V) const override;
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const override;

  const Law& law() const { return law_; }
  int n_elements() const { return corners_.n_elements(); }
  /// Returns K of one element at x; row 3 a + i is direction i of corner a.
  Eigen::Matrix<double, 3 * N, 3 * N> element_stiffness(const Coordinates& x, int element) const;
  /// Returns the volume of an element by its quadrature rule, m^3.
  double volume(int element) const;

 private:
  static constexpr int kPoints = static_cast<int>(Element::rule.size());
  /// One quadrature point in four elements.
  struct Point {
    Mat3<Pack> inverse;  ///< (dX/dxi)^-1, 1/m
    Pack weight;  ///< weight of the quadrature rule times det dX/dxi, m^3; 0 in lanes without an element
  };
  /// dP/dG and dG/dx_a: results of stress_matrix() and gradient_matrix().
  using StressDerivative = Eigen::Matrix<double, 9, 9>;
  using GradientMatrix = Eigen::Matrix<double, 9, 3 * N>;
  /// Subtracts from f the nodal sums of weight * P (dX/dxi)^-T dN_a/dxi over all elements, with P =
  /// stress(G). G[k] is the gradient of the nodal vectors fields[k] at a quadrature point.
  template <int Fields, class Stress>
  void subtract_forces(const std::array<const double*, Fields>& fields, VecX<double>& f, Buffer& buffer,
                       ThreadPool* pool, Stress&& stress) const;
  /// Returns dG/dx_a at a quadrature point of an element. Row 3 r + c is G_rc, column 3 a + i is direction i
  /// of corner a.
  static GradientMatrix gradient_matrix(const TetrahedronPoint& at, const Mat3<double>& inverse);
  /// Returns the 9 x 9 matrix of a linear map of gradients to stresses, components in the order of
  /// gradient_matrix.
  template <class Stress>
  static StressDerivative stress_matrix(Stress&& stress);
  /// Returns sum over the quadrature points of B^T (weight C) B of one element at x, with B of
  /// gradient_matrix and C = derivative(G).
  template <class Derivative>
  Eigen::Matrix<double, 3 * N, 3 * N> element_matrix(const Coordinates& x, int element,
                                                     Derivative&& derivative) const;
  /// Appends the entries of matrix(element) of all elements.
  template <class Matrix>
  void add_entries(std::vector<Eigen::Triplet<double>>& entries, Matrix&& matrix) const;
  const Point* points(int pack) const { return points_.data() + static_cast<std::ptrdiff_t>(pack) * kPoints; }

  Law law_;
  ElementCorners<N> corners_;
  std::vector<Point> points_;  // [pack][quadrature point]
};

/// The linear solid: K does not depend on x.
template <class Element>
using LinearSolid = SolidEnergy<Element, LinearLaw>;

/// Every combination of element and law that the library contains.
#define PLIANT_SOLID_ENERGIES(prefix)                                         \
  prefix template class SolidEnergy<LinearTetrahedron, LinearLaw>;            \
  prefix template class SolidEnergy<LinearTetrahedron, StVenantKirchhoff>;    \
  prefix template class SolidEnergy<LinearTetrahedron, NeoHookean>;           \
  prefix template class SolidEnergy<LinearTetrahedron, NeoHookeanLog>;        \
  prefix template class SolidEnergy<LinearTetrahedron, Corotated>;            \
  prefix template class SolidEnergy<QuadraticTetrahedron, LinearLaw>;         \
  prefix template class SolidEnergy<QuadraticTetrahedron, StVenantKirchhoff>; \
  prefix template class SolidEnergy<QuadraticTetrahedron, NeoHookean>;        \
  prefix template class SolidEnergy<QuadraticTetrahedron, NeoHookeanLog>;     \
  prefix template class SolidEnergy<QuadraticTetrahedron, Corotated>;         \
  prefix template class SolidEnergy<EnrichedTetrahedron, LinearLaw>;          \
  prefix template class SolidEnergy<EnrichedTetrahedron, StVenantKirchhoff>;  \
  prefix template class SolidEnergy<EnrichedTetrahedron, NeoHookean>;         \
  prefix template class SolidEnergy<EnrichedTetrahedron, NeoHookeanLog>;      \
  prefix template class SolidEnergy<EnrichedTetrahedron, Corotated>;
PLIANT_SOLID_ENERGIES(extern)

}  // namespace pliant
