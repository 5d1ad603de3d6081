// Energy of a solid over tetrahedra: E = sum over elements and points of weight * W(G),
//   G = grad of d (linear law) or of p = s + d (the others),  from nodal vectors x: G = (dx/dxi) (dX/dxi)^-1
//   f_a = -sum of weight * P (dX/dxi)^-T dN_a/dxi,  P = dW/dG;   K dx likewise with dP along the gradient of
//   dx
// One kernel for every element (tetrahedron.h) and law; the inverse of dX/dxi is kept for each point.
#pragma once

#include <type_traits>

#include <pliant/local/linear_law.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/local/solid/corotated.h>
#include <pliant/local/solid/element_corners.h>
#include <pliant/local/solid/hooke.h>
#include <pliant/local/solid/neo_hookean.h>
#include <pliant/local/solid/st_venant_kirchhoff.h>
#include <pliant/local/solid/tetrahedron.h>

namespace pliant {

template <class Element, class Law>
class SolidEnergy final : public NodalEnergy {
 public:
  static constexpr int N = Element::n_nodes;

  /// rest: positions X of the nodes at rest, m. elements: N rows; their Jacobians must be positive at the
  /// points of the rule, else std::invalid_argument.
  SolidEnergy(const Nodes& rest, const Eigen::MatrixXi& elements, const Law& law);

  Of of() const override { return Law::of; }
  double energy(const Coordinates& x) const override;
  void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const override;
  void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override;
  void add_viscous_force(const Coordinates& x, const Coordinates& x_dot, VecX<double>& f, Buffer& buffer,
                         ThreadPool* pool) const override;
  void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const override;
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const override;

  const Law& law() const { return law_; }
  int n_elements() const { return corners_.n_elements(); }
  /// K of one element, corner by corner: row 3 a + i is direction i of corner a.
  Eigen::Matrix<double, 3 * N, 3 * N> element_stiffness(const Coordinates& x, int element) const;
  /// The volume of an element by its rule, m^3.
  double volume(int element) const;

 private:
  static constexpr int kPoints = static_cast<int>(Element::rule.size());
  /// Of a point of the rule in four elements: (dX/dxi)^-1 and weight times its determinant.
  struct Point {
    Mat3<Pack> inverse;
    Pack weight;
  };
  /// Sums what P(point, gradients) pushes, over all packs, into f.
  template <int Fields, class Stress>
  void add(const std::array<const double*, Fields>& fields, VecX<double>& f, Buffer& buffer, ThreadPool* pool,
           Stress&& stress) const;
  const Point* points(int pack) const { return points_.data() + static_cast<std::ptrdiff_t>(pack) * kPoints; }

  Law law_;
  ElementCorners<N> corners_;
  std::vector<Point> points_;  // pack, point of the rule; weight 0 in lanes without an element
};

template <class Element>
using LinearSolid = SolidEnergy<Element, LinearLaw>;

#define PLIANT_SOLID_ENERGIES(prefix)                                         \
  prefix template class SolidEnergy<LinearTetrahedron, LinearLaw>;            \
  prefix template class SolidEnergy<LinearTetrahedron, StVenantKirchhoff>;    \
  prefix template class SolidEnergy<LinearTetrahedron, NeoHookean>;           \
  prefix template class SolidEnergy<LinearTetrahedron, Corotated>;            \
  prefix template class SolidEnergy<QuadraticTetrahedron, LinearLaw>;         \
  prefix template class SolidEnergy<QuadraticTetrahedron, StVenantKirchhoff>; \
  prefix template class SolidEnergy<QuadraticTetrahedron, NeoHookean>;        \
  prefix template class SolidEnergy<QuadraticTetrahedron, Corotated>;         \
  prefix template class SolidEnergy<EnrichedTetrahedron, LinearLaw>;          \
  prefix template class SolidEnergy<EnrichedTetrahedron, StVenantKirchhoff>;  \
  prefix template class SolidEnergy<EnrichedTetrahedron, NeoHookean>;         \
  prefix template class SolidEnergy<EnrichedTetrahedron, Corotated>;
PLIANT_SOLID_ENERGIES(extern)

}  // namespace pliant
