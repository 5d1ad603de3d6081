// Linear elasticity with averaged dilatation, which prevents nearly incompressible solids from locking. The
// dilatation div d enters the energy through its means theta_c over patches c of volume V_c,
//   E = int mu eps:eps + lambda/2 sum_c V_c theta_c^2,   V_c theta_c = int over c of div d.
// For elements with 4 nodes, a patch is a node with a quarter of each adjacent element (Bonet & Burton 1998).
// For 10 and 15 nodes, a patch is an element. By Jensen's inequality, E is at most the energy without
// averages.
#pragma once

#include <pliant/local/nodal_energy.h>
#include <pliant/local/solid/element_corners.h>
#include <pliant/local/solid/solid_energy.h>
#include <pliant/local/solid/tetrahedron.h>

namespace pliant {

/// Suitable for nu_P from 0 to 0.4999.
template <class Element>
class AveragedLinearSolid final : public NodalEnergy {
 public:
  static constexpr int N = Element::n_nodes;
  /// rest, elements: as in SolidEnergy. Throws the errors of SolidEnergy, and std::invalid_argument for
  /// nu_P < 0, because averages would then increase E, and frequency_bound would not be a bound.
  AveragedLinearSolid(const Nodes& rest, const Eigen::MatrixXi& elements, const Elasticity& material);

  Of of() const override { return Of::displacement; }
  double energy(const Coordinates& x) const override;
  void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const override;
  void add_derivative(const Coordinates&, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override {
    add_force(dx, f, buffer, pool);
  }
  void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const override;
  /// Returns the bound of the solid without averages, which is also a bound of this solid.
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const override;

 private:
  static constexpr bool kNodal = N == 4;
  /// Returns int of div d over each element of a pack, m^3.
  Pack volume_change(const Coordinates& x, int pack) const;
  /// Computes lambda theta_c of all patches, Pa, positive in expansion. sums: scratch storage of
  /// corners_.buffer_size(1) numbers.
  void compute_pressures(const Coordinates& x, double* sums, double* pressure, ThreadPool* pool) const;
  const Pack* gradients(int pack) const {
    return gradients_.data() + static_cast<std::ptrdiff_t>(pack) * 3 * N;
  }

  SolidEnergy<Element, LinearLaw> full_, shear_;  // full_: without averages; shear_: lambda = 0
  ElementCorners<N> corners_;
  std::vector<Pack> gradients_;  // [pack][corner][direction]: int of dN_a/dX_r, m^2
  std::vector<double> volume_;   // of each patch, m^3
  double lambda_;                // Pa
};

extern template class AveragedLinearSolid<LinearTetrahedron>;
extern template class AveragedLinearSolid<QuadraticTetrahedron>;
extern template class AveragedLinearSolid<EnrichedTetrahedron>;

}  // namespace pliant
