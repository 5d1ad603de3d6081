// Stages of an explicit Runge-Kutta method for free oscillators (free_oscillation.h): an exponential
// integrator (Lawson 1967, Krogstad 2005). With u = (q, v), u_dot = A u + (0, n) and n_j at stage j,
//   u_i = exp(A c_i h) u_0 + int_0^(c_i h) exp(A t) (0, n_0) dt + h sum_j a_ij exp(A (c_i - c_j) h) (0, n_j -
//   n_0)
// The end of the step has b in place of a, and so has its error estimate. A constant load is exact. If the
// nodes c_i decrease from one stage to the next, as in dop853, decays grow there: such methods do not suit
// strong damping.
#pragma once

#include <vector>

#include <pliant/body/model.h>
#include <pliant/method/butcher_tableau.h>
#include <pliant/method/free_oscillation.h>

namespace pliant {

class FreeStages {
 public:
  /// Prepares steps of length h, s. Returns at once if h has not changed.
  void prepare(const Model& model, const ButcherTableau& of, double h);
  bool any() const { return !parts_.empty(); }
  /// Stores n of a stage at (q, v) and sets v_dot and q_dot of the free oscillators to zero.
  void take(int stage, const VecX<double>& q, const VecX<double>& v, VecX<double>& v_dot);
  void still(VecX<double>& q_dot) const;
  /// Reuses the n of the end of the last step as that of the first stage.
  void reuse_end_rates();
  /// Computes the coordinates and velocities of a stage, or of the end of the step if `stage` is the number
  /// of stages. q_start, v_start: at the start of the step; they may be q and v themselves.
  void move(int stage, const VecX<double>& q_start, const VecX<double>& v_start, VecX<double>& q,
            VecX<double>& v) const;
  /// Computes h sum_j weights_j exp(A (1 - c_j) h) (0, n_j - n_0).
  void weigh(const double* weights, int count, VecX<double>& q, VecX<double>& v) const;

 private:
  struct OfPart {
    const Oscillators* oscillators;
    int q0, v0;
    MatX<double> n;                           ///< one column for each stage, and one for the end of the step
    std::vector<OscillatorMoves> from_start;  ///< over c_i h, for each stage and the end
    std::vector<std::vector<OscillatorKicks>> between;  ///< over (c_i - c_j) h, if a_ij is not zero
  };
  /// Returns the weights of the earlier stages for a stage, or b for the end.
  const double* weights(int stage) const {
    return stage == of_->stages ? of_->b : of_->a + stage * (stage - 1) / 2;
  }
  /// Adds weight exp(A t) (0, n_stage - n_0); kicks: the coefficients over t.
  static void add_kicks(const OfPart& part, const OscillatorKicks& kicks, int stage, double weight,
                        VecX<double>& q, VecX<double>& v);
  double node(int stage) const { return stage >= of_->stages ? 1 : of_->c[stage]; }

  const Model* model_ = nullptr;
  const ButcherTableau* of_ = nullptr;
  double h_ = 0;
  std::vector<OfPart> parts_;
};

}  // namespace pliant
