// The matrix A of (I - c A) k = r (implicit_part.h) for a part with nodes: linearised elasticity and damping,
// D = alpha M + beta K of Eq. (11), under the reference conditions W^T d = 0
// (include/pliant/part/local/README.md). Here W = M G0, G0 = [I, -[s]x, J] and G = [I, -[p]x, J] = G0 + delta
// at the nodes, with the reference positions s and p = s + d. Energies of displacements have the stiffness
// K_d and the damping beta K_d. Energies of positions (NodalEnergy::Of::position) have K_p + w w^T and the
// damping beta V_p (NodalEnergy::add_viscosity); the dense term w w^T comes from internal pressure. Let r_q,
// r_v be the given rates, k_q = r_q + c k_v, and v_r = (R^T c_dot, omega, q_s_dot) with the damping D_r and
// the stiffness K_r, which are zero except for q_s. The changes k_v - r_v are x_d for the local coordinates
// and x_r for v_r. kappa is the sum of x_r and of the multipliers of the conditions. Lagrange's equations are
//   S x_d + N x_r + W kappa + c w zeta = M e_a - S e - Q e_s + E
//   N^T x_d + S_r x_r + P^T kappa      = -c D_r r_v - K_r e_r - Q^T e - J^T (Q e_s - E)
//   W^T x_d + P x_r                    = 0
//   c w^T x_d - zeta                   = -c w^T e
// with the unknown zeta of the dense term, the number s = 1/(c + beta) and
//   S = (1 + c alpha) M + c (beta + c) K_d + c^2 K_p + c beta V_p (sparse),   N = M delta + Q,
//   Q = (c^2 (K_p + w w^T) + c beta V_p) [0, 0, J],   S_r = G^T M G - P - P^T + c D_r + c^2 K_r + J^T Q,
//   e = r_v + s r_q and e_a = e + s c alpha r_q of the local coordinates,
//   e_s = r_v + s r_q and e_r = c^2 r_v + c r_q of the parameters,
//   E = c beta s (V_p - K_p - w w^T) (r_q + J r_q,s) with r_q,s of the parameters.
// Without energies of positions delta and P are neglected, because linear elasticity is for small
// displacements. If there are no parameters either, x_r is 0. While K and c are constant, S is factored once.
// The border consists of the few columns beside S. It is solved with the factor of S: once for each factor,
// or in each step if global parameters change W. A stage then costs one sparse solve.
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

  /// Factors S if c or LocalWorkspace::law_factor has changed, and at every call if an energy depends on
  /// positions. If S had the stiffness of these energies at rest, long steps would fail for parts that are
  /// bent or stretched far.
  int prepare(const PartWorkspace<double>& w, double c, double t) override;
  void filter(const VecX<double>& q_dot, const Mat3<double>& R, VecX<double>& v_dot) override;
  MatX<double> compliance() const override;
  void push(const VecX<double>& g, Eigen::Ref<VecX<double>> d_ddot) const override;
  void respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_d) const override;

 private:
  const NodalDeformation& local() const { return *part_->local->nodal(); }
  /// Returns whether the border contains x_r.
  bool frame_in_border() const { return part_->n_s > 0 || stiffness_changes_; }
  /// Computes K_: the stiffness of the energies of displacements, in the sparsity pattern of all energies.
  void make_pattern();
  /// Computes S_ and its factor at positions x (m) and time t (s), and Z_. Returns the number of
  /// factorisations.
  int factor(double c, const VecX<double>& x, double t);
  /// Adds `factor` times the masses to S_, which must contain all other terms of S, and factors S_. Adds more
  /// mass if S_ is not definite. Returns the number of factorisations. Throws NumericalFailure if no mass
  /// suffices.
  int factor_definite(double factor, double t);
  /// Computes the border B_, S^-1 B_ and the constant part of the Schur complement.
  void make_border(const NodalWorkspace& w, double c);
  void add_frame_columns(const NodalWorkspace& w, double c);
  VecX<double> damping_excess(const VecX<double>& r_q_s, const VecX<double>& r_q) const;
  /// Computes and factors the Schur complement of S.
  void make_core(const LocalWorkspace& w);
  /// Returns the Schur complement's inverse times b.
  template <class B>
  typename B::PlainObject solve_core(const Eigen::MatrixBase<B>& b) const {
    const typename B::PlainObject scaled = core_scale_.asDiagonal() * b;
    return core_scale_.asDiagonal() * core_.solve(scaled);
  }
  /// Returns the values of fields at the attachment points of joints, three rows for each point. nodal: one
  /// field over the local coordinates in each column.
  MatX<double> at_joints(const MatX<double>& nodal) const;

  std::unique_ptr<SparseFactor> factor_;
  VecX<double> zeros_;         ///< n_d zeros
  NodalWorkspace rest_;        ///< the part at rest
  bool stiffness_changes_;     ///< whether an energy depends on positions
  double law_factor_ = 1;      ///< factor of the laws, LocalWorkspace::law_factor
  double c_ = 0;               ///< c of the current factor, s; 0 without a factor
  Eigen::Index analysed_ = 0;  ///< number of entries of the analysed pattern
  std::vector<Eigen::Triplet<double>> entries_;
  SparseMatrix K_, S_;       ///< lower triangles with a common pattern: K_d, and S
  MatX<double> B_, T_;       ///< border, S^-1 border
  MatX<double> Z_;           ///< S^-1 times the transpose of the interpolation by at_joints()
  MatX<double> B_Z_, N_T_;   ///< B^T Z, at_joints(T)
  MatX<double> core_fixed_;  ///< the constant part of the Schur complement of S
  VecX<double> core_scale_;  ///< powers of two that equalise the diagonal of the Schur complement
  Eigen::PartialPivLU<MatX<double>> core_;  ///< factor of the Schur complement, with scaled rows and columns
  MatX<double> J_Q_;                        ///< J^T Q over the global parameters
  MatX<double> K_s_, D_s_;                  ///< blocks of K_r and D_r of the global parameters
  MatX<double> P_, M_r_;                    ///< P, and G^T M G - P - P^T
  VecX<double> x_;                          ///< positions in the current S, m; used if the stiffness changes
  MatX<double> J_;                          ///< J at these positions; used if the stiffness changes
  MatX<double> H0_inverse_;                 ///< inverse of H0; used if x_r is not in the border
  VecX<double> e_, y_, right_;
};

}  // namespace pliant
