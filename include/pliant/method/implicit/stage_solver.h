// The solver of implicit stages,
//   Q = r_q + c q_dot(Q, V),   V = r_v + c v_dot(t, Q, V),
// for Q and V, by simplified Newton iteration (Hairer & Wanner, Solving Ordinary Differential Equations II,
// section IV.8). r_q and r_v are known from the earlier stages. The matrix is I - c A_v - c^2 A_q, with the
// derivatives A_q and A_v of v_dot by q and v. A_q and A_v are computed by difference quotients, as a rule at
// most once in a step, and only if the iteration without the matrix would cost more. A_q and A_v are computed
// again if the iteration with the matrix does not converge, for example because stiff parts have turned far.
// A cluster contains the parts that joints or loads connect (Model::load_connections()), and has one matrix.
// The matrix is in the frames of the parts, because stiff directions turn with the parts.
#pragma once

#include <string>
#include <vector>

#include <Eigen/LU>

#include <pliant/method/integrator.h>

namespace pliant {

class StageSolver {
 public:
  /// Largest number of velocities of a cluster, whose matrix is dense.
  static constexpr Eigen::Index kMaxVelocities = 1000;

  explicit StageSolver(const Model& model);

  /// Prepares the stages of a step from the state of the context. The context and the scale must outlive the
  /// stages. c: gamma h of all stages, s. scale: the norm of the changes of the iteration.
  void begin_step(StepContext& step, double c, const ErrorScale& scale);
  /// Solves the stage at time t (s) for q and v, whose values before the call are the first guess. On return
  /// the workspace of the step contains the last evaluation. Throws NumericalFailure, with the unknown that
  /// changes most, if the iteration does not converge. Throws NumericalFailure, naming the first part, if a
  /// cluster has too many velocities for a matrix.
  void solve(double t, const VecX<double>& r_q, const VecX<double>& r_v, VecX<double>& q, VecX<double>& v);
  /// Multiplies an error estimate by the inverse matrix, so that components that the step damps away vanish.
  /// Without a matrix the estimate does not change.
  void damp(VecX<double>& q_error, VecX<double>& v_error) const;

 private:
  /// Parts whose states affect the accelerations of each other.
  struct Cluster {
    std::vector<int> parts;
    std::vector<Eigen::Index> velocities;  ///< indices of the velocities of these parts in v
    MatX<double> A_q, A_v;
    VecX<double> scale;  ///< powers of two near the entries of difference_ for these velocities
    /// Factor of the matrix for velocities in units of their scales. The pivots thus do not depend on units.
    Eigen::PartialPivLU<MatX<double>> factor;
  };
  /// Iterates until q and v have converged, until a fixed number of iterations is reached, or until a new
  /// matrix is expected to be cheaper. Returns whether the iteration converged.
  bool iterate(double t, const VecX<double>& r_q, const VecX<double>& r_v, VecX<double>& q, VecX<double>& v);
  /// Evaluates A_q and A_v of each cluster at (t, q, v) by difference quotients, and factors its matrix.
  void linearise(double t, const VecX<double>& q, const VecX<double>& v);
  /// Sets one column of A_q or A_v of each cluster to a difference quotient: the change of the accelerations
  /// in the workspace from v_dot_, divided by the difference. difference: differences(column) for A_q, and
  /// slow_rate() times differences(column) for A_v.
  void set_column(Eigen::Index column, const VecX<double>& difference, MatX<double> Cluster::*A);
  /// Returns the differences for one column of the matrices of all clusters: n_v numbers, with at most one
  /// nonzero number for each cluster.
  VecX<double> differences(Eigen::Index column) const;
  /// Allocates the matrices. Throws NumericalFailure, with the time t (s), if a cluster is too large.
  void allocate_matrices(double t);
  /// Replaces the residuals (rho_q, rho_v) by the Newton change of (q, v).
  void correct(const VecX<double>& q, VecX<double>& rho_q, VecX<double>& rho_v) const;

  const Model& model_;
  std::vector<Cluster> clusters_;
  VecX<double> difference_;  ///< n_v: step of the difference quotients, m, rad, 1 or kg^(1/2) m
  int max_free_iterations_;  ///< largest number of iterations of a stage without the matrix
  // The current step.
  StepContext* step_ = nullptr;
  const ErrorScale* scale_ = nullptr;
  double c_ = 0;
  bool has_matrix_ = false;  ///< whether the matrices are valid for this step
  mutable VecX<double> tangent_, right_;
  VecX<double> rho_q_, rho_v_, q_guess_, v_guess_, v_dot_;
};

}  // namespace pliant
