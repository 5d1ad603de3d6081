// What keeps nearly incompressible solids from locking: the dilatation enters by means over patches c,
//   E = lambda/2 sum_c V_c theta_c^2,   V_c theta_c = int over c of div d
// instead of point by point. 4 nodes: a patch is a node with a quarter of each element around it (nodal
// pressure, Bonet & Burton 1998); 10 and 15 nodes: the element. By Jensen no more than the energy with the
// dilatation itself.
#pragma once

#include <pliant/local/nodal_energy.h>
#include <pliant/local/solid/element_corners.h>
#include <pliant/local/solid/solid_energy.h>
#include <pliant/local/solid/tetrahedron.h>

namespace pliant {

/// Linear elasticity with averaged dilatation, mu eps:eps and E above: for nu_P up to 0.4999.
template <class Element>
class AveragedLinearSolid final : public NodalEnergy {
 public:
  static constexpr int N = Element::n_nodes;
  /// As SolidEnergy; throws std::invalid_argument for nu_P < 0, where averages would weaken the solid.
  AveragedLinearSolid(const Nodes& rest, const Eigen::MatrixXi& elements, const Elasticity& material);

  Of of() const override { return Of::displacement; }
  double energy(const Coordinates& x) const override;
  void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const override;
  void add_derivative(const Coordinates&, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const override {
    add_force(dx, f, buffer, pool);
  }
  void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const override;
  /// That of the solid without averages, which is no less.
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const override;

 private:
  static constexpr bool kNodal = N == 4;
  /// int of div d over the elements of a pack.
  Pack spread(const Coordinates& x, int pack) const;
  /// lambda theta of all patches. sums: room for corners_.buffer_size(1) numbers.
  void pressures(const Coordinates& x, double* sums, double* pressure, ThreadPool* pool) const;
  const Pack* gradients(int pack) const {
    return gradients_.data() + static_cast<std::ptrdiff_t>(pack) * 3 * N;
  }

  SolidEnergy<Element, LinearLaw> whole_, shear_;
  ElementCorners<N> corners_;
  std::vector<Pack> gradients_;  // pack, corner, direction: int of dN_a/dX_r
  std::vector<double> volume_;   // of patches
  double lambda_;
};

extern template class AveragedLinearSolid<LinearTetrahedron>;
extern template class AveragedLinearSolid<QuadraticTetrahedron>;
extern template class AveragedLinearSolid<EnrichedTetrahedron>;

}  // namespace pliant
