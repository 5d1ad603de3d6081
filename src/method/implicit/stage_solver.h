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

  /// A step begins at (t, q, v), q and v of the state. c: of all its stages. scale: of what is left of the
  /// equations.
  void begin(const Dynamics& dynamics, const State& state, double c, const ErrorScale& scale);
  /// Solves for q, v, which begin as a guess; work: of the last evaluation. Throws NumericalFailure where
  /// the iteration does not converge, naming what is worst.
  void solve(double t, const VecX<double>& r_q, const VecX<double>& r_v, VecX<double>& q, VecX<double>& v,
             Workspace<double>& work, StepCounters& counters);
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
  bool iterate(double t, const VecX<double>& r_q, const VecX<double>& r_v, VecX<double>& q, VecX<double>& v,
               Workspace<double>& work, StepCounters& counters);
  /// Takes the matrices at (t, q, v).
  void linearise(double t, const VecX<double>& q, const VecX<double>& v, Workspace<double>& work,
                 StepCounters& counters);
  /// (rho_q, rho_v) <- the change of (q, v) that takes these off the equations.
  void correct(const VecX<double>& q, VecX<double>& rho_q, VecX<double>& rho_v) const;

  const Model& model_;
  std::vector<Cluster> clusters_;
  VecX<double> difference_;  ///< of each velocity's coordinate, m or rad or 1
  int most_free_;            ///< iterations without the matrix that a stage may take
  // Of the step.
  const Dynamics* dynamics_ = nullptr;
  const State* state_ = nullptr;
  const ErrorScale* scale_ = nullptr;
  double c_ = 0;
  bool linear_ = false;  ///< whether the matrices are there
  mutable VecX<double> tangent_, right_;
  VecX<double> rho_q_, rho_v_, q_guess_, v_guess_;
};

}  // namespace pliant
