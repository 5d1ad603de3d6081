// A of a part that deforms locally, in (I - c A) k = r with c = gamma h: its linearised elasticity and
// damping under the reference conditions. K is the stiffness over its local coordinates, of which w w^T is
// left out (NodalEnergy::rank_one) and K_p is of energies of position; G = [I, -[s]x, J], W = M G. With the
// rates of coordinates k_q = r_q + c k_v the change x = k_v - r_v of those of (v_r, d_dot) is
//   [ S        W  c^2 P  c w ] [ x_d   ]   [ -c alpha M r_v - (K + w w^T) w_d - P w_r ]
//   [ W^T      0             ] [ kappa ] = [ 0                                        ]
//   [ c^2 P^T     S_r        ] [ x_r   ]   [ -c D_r r_v - K_r w_r - P^T w_d           ]
//   [ c w^T             -1   ] [ zeta  ]   [ 0                                        ]
// S = (1 + c alpha) M + (c beta + c^2) K is sparse, S_r = H0 + c D_r + c^2 K_r, P = (K_p + w w^T) [0, 0, J],
// w_. = (c^2 + c beta) r_v + c r_q. S is factored once while K stays; the few columns beside it, "the
// border", are solved for with that factor, again at each step where global parameters change W. A stage then
// costs one sparse solve.
#pragma once

#include <memory>
#include <vector>

#include <Eigen/LU>

#include <pliant/math/sparse_factor.h>
#include <pliant/part/local/nodal_deformation.h>

#include <pliant/method/implicit/implicit_part.h>

namespace pliant {

class ImplicitNodes final : public ImplicitPart {
 public:
  ImplicitNodes(const PartModel& part, std::unique_ptr<SparseFactor> factor);

  /// S is factored when c is another one than before; with energies of position, each time: with their
  /// stiffness at rest, steps of 10 times the explicit limit fail where a part is bent or stretched far.
  int prepare(const PartWorkspace<double>& w, double c, double t) override;
  void filter(const VecX<double>& q_dot, const Mat3<double>& R, VecX<double>& v_dot) override;
  /// Of pushes on rates: x for S x = push.
  MatX<double> compliance() const override;
  void push(const VecX<double>& g, Eigen::Ref<VecX<double>> d_ddot) const override;
  void respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_d) const override;

 private:
  const NodalDeformation& local() const { return *part_->local->nodal(); }
  /// Where x_r stands in the border; only global parameters have stiffness there.
  bool frame_in_border() const { return part_->n_s > 0; }
  void make_pattern();
  int factor(double c, const VecX<double>& x, double t);
  int factor_definite(double factor, double t);
  void make_border(const NodalWorkspace& at, double c);
  void make_core(const LocalWorkspace& now);
  /// Values of a vector, or of each column, over the local coordinates at the points of joints.
  MatX<double> at_joints(const MatX<double>& of_nodes) const;

  std::unique_ptr<SparseFactor> factor_;
  VecX<double> none_;          ///< zeros, as many as local coordinates
  NodalWorkspace rest_;        ///< the part at rest
  bool follows_;               ///< whether it has energies of position
  double c_ = 0;               ///< of the factor
  Eigen::Index analysed_ = 0;  ///< entries of the pattern that was analysed
  std::vector<Eigen::Triplet<double>> entries_;
  SparseMatrix K_, S_;       ///< lower triangles of one pattern: stiffness of the energies of displacement, S
  MatX<double> B_, T_;       ///< border, S^-1 border
  MatX<double> Z_;           ///< S^-1 N^T, N that at_joints() applies
  MatX<double> B_Z_, T_at_;  ///< B^T Z, N T
  MatX<double> core_fixed_;  ///< of the Schur complement of S, what the state does not change
  Eigen::PartialPivLU<MatX<double>> core_;
  MatX<double> K_elastic_;   ///< of K_r: J^T P
  MatX<double> K_s_, D_s_;   ///< blocks of K_r and D_r of the global parameters
  MatX<double> H0_inverse_;  ///< where x_r is not in the border
  VecX<double> e_, y_, right_;
};

}  // namespace pliant
