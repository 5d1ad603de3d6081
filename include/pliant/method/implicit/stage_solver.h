// The equations of an implicit stage,
//   Q = r_q + c q_dot(Q, V),   V = r_v + c v_dot(t, Q, V),
// by simplified Newton iteration. The matrix I - c A_v - c^2 A_q, of the derivatives A_q and A_v of v_dot, is
// only formed where the iteration without it would cost more, by differences, once a step, and again where
// stiff parts turn so far on each other in it that it no longer helps; parts that no joint, spring or torque
// against each other ties together have one each. It stands in the frames of the parts, with which stiff
// directions turn.
#pragma once

#include <string>
#include <vector>

#include <Eigen/LU>

#include <pliant/method/integrator.h>

namespace pliant {

class StageSolver {
 public:
  explicit StageSolver(const Model& model);

  /// Begins a step at the state of the context. The context and the scale must outlive the stages of the
  /// step. c: gamma h of all stages, s. scale: measures the residual of the equations.
  void begin(StepContext& step, double c, const ErrorScale& scale);
  /// Solves the stage at time t (s) for q and v, from the guess that they hold. On return the workspace of
  /// the step holds the last evaluation. Throws NumericalFailure, naming the worst unknown, if the iteration
  /// diverges.
  void solve(double t, const VecX<double>& r_q, const VecX<double>& r_v, VecX<double>& q, VecX<double>& v);
  /// What the matrix leaves of an error: of one that dies out in the step nothing.
  void damp(VecX<double>& of_q, VecX<double>& of_v) const;

 private:
  /// Parts that act on each other's accelerations.
  struct Cluster {
    std::vector<int> parts;
    std::vector<Eigen::Index> velocities;
    MatX<double> A_q, A_v;
    Eigen::PartialPivLU<MatX<double>> factor;
  };
  /// Iterates at most as often as pays; returns whether the iteration converged.
  bool iterate(double t, const VecX<double>& r_q, const VecX<double>& r_v, VecX<double>& q, VecX<double>& v);
  /// Evaluates the matrices A_q and A_v at (t, q, v) by differences and factors the clusters.
  void linearise(double t, const VecX<double>& q, const VecX<double>& v);
  /// Sets one column of A_q or A_v of each cluster to the difference of the accelerations in the workspace.
  void set_column(Eigen::Index column, const VecX<double>& by, MatX<double> Cluster::*A);
  /// Returns the changes of the coordinates whose accelerations give the column of each cluster.
  VecX<double> differences(Eigen::Index column) const;
  void allocate_matrices(double t);
  /// (rho_q, rho_v) <- the change of (q, v) that takes these off the equations.
  void correct(const VecX<double>& q, VecX<double>& rho_q, VecX<double>& rho_v) const;

  const Model& model_;
  std::vector<Cluster> clusters_;
  VecX<double> difference_;  ///< of each velocity's coordinate, m or rad or 1
  int max_free_iterations_;  ///< iterations without the matrix that a stage may take
  // Of the step.
  StepContext* step_ = nullptr;
  const ErrorScale* scale_ = nullptr;
  double c_ = 0;
  bool linear_ = false;  ///< whether the matrices are there
  mutable VecX<double> tangent_, right_;
  VecX<double> rho_q_, rho_v_, q_guess_, v_guess_, v_dot_;
};

}  // namespace pliant
