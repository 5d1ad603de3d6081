// Stages of an explicit Runge-Kutta method for free oscillators (free_oscillation.h): an exponential
// integrator (Lawson 1967, Krogstad 2005). With u = (q, v), u_dot = A u + (0, n), A = [0, I; -omega^2, -D],
// the load n_j at stage j, and the nodes c_i and weights a_ij of the tableau, stage i is
//   u_i = exp(A c_i h) u_0 + int_0^(c_i h) exp(A t) (0, n_0) dt
//         + h sum_j a_ij exp(A (c_i - c_j) h) (0, n_j - n_0)
// For the end of the step the weights b replace a_ij. For the error estimate the weights of the estimate
// replace a_ij. The motion under a constant load is exact. If the nodes c_i decrease from one stage to the
// next, as in dop853, exp(A (c_i - c_j) h) runs backwards in time, and damped motion grows. Tableaux with
// decreasing nodes therefore do not suit strong damping.
#pragma once

#include <vector>

#include <pliant/body/model.h>
#include <pliant/method/butcher_tableau.h>
#include <pliant/method/free_oscillation.h>

namespace pliant {

class FreeStages {
 public:
  /// Prepares steps of length h, s. Returns at once if model, tableau and h have not changed.
  void prepare(const Model& model, const ButcherTableau& tableau, double h);
  /// Returns whether the model of the last prepare() has free oscillators. Without free oscillators all
  /// functions return at once.
  bool has_oscillators() const { return !parts_.empty(); }
  /// Stores the loads n = v_dot + omega^2 q + D v of a stage, where v_dot are the accelerations at (q, v).
  /// Sets v_dot of the free oscillators to zero.
  void store_loads(int stage, const VecX<double>& q, const VecX<double>& v, VecX<double>& v_dot);
  /// Sets q_dot of the free oscillators to zero.
  void clear_rates(VecX<double>& q_dot) const;
  /// Copies the loads at the end of the last step to the first stage.
  void reuse_end_rates();
  /// Computes the coordinates and velocities of a stage, or of the end of the step if `stage` is the number
  /// of stages. q_start, v_start: at the start of the step; they may be q and v themselves.
  void advance(int stage, const VecX<double>& q_start, const VecX<double>& v_start, VecX<double>& q,
               VecX<double>& v) const;
  /// Computes the error estimate h sum_j weights_j exp(A (1 - c_j) h) (0, n_j - n_0) of the free oscillators.
  /// weights: `count` numbers, one for each stage, and one more if the estimate uses the rates at the end of
  /// the step.
  void estimate_error(const double* weights, int count, VecX<double>& q_error, VecX<double>& v_error) const;

 private:
  struct PartStages {
    const Oscillators* oscillators;
    int q0, v0;      ///< first entries of the oscillators in q and v
    MatX<double> n;  ///< loads: one column for each stage, and one for the end of the step
    std::vector<OscillatorPropagator> from_start;        ///< over c_i h, for each stage and the end
    std::vector<std::vector<VelocityResponse>> between;  ///< [i][j]: over (c_i - c_j) h, if a_ij is not 0
  };
  /// Returns the weights of the earlier stages for a stage, or b for the end.
  const double* weights(int stage) const {
    return stage == tableau_->stages ? tableau_->b : tableau_->a + stage * (stage - 1) / 2;
  }
  /// Adds weight exp(A t) (0, n_stage - n_0) to (q, v). response: velocity_response() over t.
  static void add_load_change(const PartStages& part, const VelocityResponse& response, int stage,
                              double weight, VecX<double>& q, VecX<double>& v);
  double node(int stage) const { return stage >= tableau_->stages ? 1 : tableau_->c[stage]; }

  const Model* model_ = nullptr;
  const ButcherTableau* tableau_ = nullptr;
  double h_ = 0;
  std::vector<PartStages> parts_;
};

}  // namespace pliant
