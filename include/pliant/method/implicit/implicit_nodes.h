// The implicit part for a part with nodes: its linearised elasticity and damping under the reference
// conditions W^T d = 0 (include/pliant/part/local/README.md). K is the stiffness over the local coordinates
// without its dense term w w^T (NodalEnergy::rank_one). K_p is the stiffness of energies of the position.
// G = [I, -[s]x, J], W = M G. With k_q = r_q + c k_v, the change x = k_v - r_v of the rates of (v_r, d_dot)
// solves
//   [ S        W  c^2 P  c w ] [ x_d   ]   [ -c alpha M r_v - (K + w w^T) w_d - P w_r ]
//   [ W^T      0             ] [ kappa ] = [ 0                                        ]
//   [ c^2 P^T     S_r        ] [ x_r   ]   [ -c D_r r_v - K_r w_r - P^T w_d           ]
//   [ c w^T             -1   ] [ zeta  ]   [ 0                                        ]
// with S = (1 + c alpha) M + (c beta + c^2) K sparse, S_r = H0 + c D_r + c^2 K_r, P = (K_p + w w^T) [0, 0, J]
// and w_. = (c^2 + c beta) r_v + c r_q. S is factored once while K is constant. The few columns beside S, the
// border, are solved with its factor, and again at each step if global parameters change W. A stage then
// costs one sparse solve.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/LU>

#include <pliant/math/sparse_factor.h>
#include <pliant/method/implicit/implicit_part.h>
#include <pliant/part/local/nodal_deformation.h>

namespace pliant {

class ImplicitNodes final : public ImplicitPart {
 public:
  ImplicitNodes(const PartModel& part, std::unique_ptr<SparseFactor> factor);

  /// Factors S if c has changed, and at every call if there are energies of the position. With only their
  /// stiffness at rest, steps of 10 times the explicit limit fail for parts that are bent or stretched far.
  int prepare(const PartWorkspace<double>& w, double c, double t) override;
  void filter(const VecX<double>& q_dot, const Mat3<double>& R, VecX<double>& v_dot) override;
  MatX<double> compliance() const override;
  void push(const VecX<double>& g, Eigen::Ref<VecX<double>> d_ddot) const override;
  void respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_d) const override;

 private:
  const NodalDeformation& local() const { return *part_->local->nodal(); }
  /// Returns whether the border contains x_r: only if there are global parameters.
  bool frame_in_border() const { return part_->n_s > 0; }
  /// Computes K_ of the energies of displacement, with the pattern of all energies.
  void make_pattern();
  /// Computes S_ and its factor at positions x and time t (s). Returns the number of factorisations.
  int factor(double c, const VecX<double>& x, double t);
  /// Adds `factor` times the masses to the stiffness in S_ and factors S_, with additional mass if S_ is not
  /// definite. Returns the number of factorisations. Throws NumericalFailure if no mass suffices.
  int factor_definite(double factor, double t);
  /// Computes the border B_, S^-1 B_ and the constant part of the Schur complement.
  void make_border(const NodalWorkspace& w, double c);
  /// Computes and factors the Schur complement of S.
  void make_core(const LocalWorkspace& w);
  /// Returns each column, a vector over the local coordinates, interpolated at the points of joints.
  MatX<double> at_joints(const MatX<double>& nodal) const;

  std::unique_ptr<SparseFactor> factor_;
  VecX<double> zeros_;         ///< n_d zeros
  NodalWorkspace rest_;        ///< the part at rest
  bool stiffness_changes_;     ///< whether the part has energies of the position
  double c_ = 0;               ///< c of the factor, s; 0: none
  Eigen::Index analysed_ = 0;  ///< number of entries of the analysed pattern
  std::vector<Eigen::Triplet<double>> entries_;
  SparseMatrix K_, S_;       ///< lower triangles of one pattern: stiffness of the energies of displacement, S
  MatX<double> B_, T_;       ///< border, S^-1 border
  MatX<double> Z_;           ///< S^-1 N^T with the interpolation N of at_joints()
  MatX<double> B_Z_, N_T_;   ///< B^T Z, N T
  MatX<double> core_fixed_;  ///< the constant part of the Schur complement of S
  Eigen::PartialPivLU<MatX<double>> core_;
  MatX<double> K_elastic_;   ///< J^T P, a block of K_r
  MatX<double> K_s_, D_s_;   ///< blocks of K_r and D_r of the global parameters
  MatX<double> H0_inverse_;  ///< used if x_r is not in the border
  VecX<double> e_, y_, right_;
};

}  // namespace pliant
