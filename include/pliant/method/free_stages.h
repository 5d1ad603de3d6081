// Stages of an explicit Runge-Kutta method for what oscillates freely (free_oscillation.h). With u = (q, v),
// u_dot = A u + (0, n) and n_j at stage j,
//   u_i = exp(A c_i h) u_0 + int_0^(c_i h) exp(A t) (0, n_0) dt + h sum_j a_ij exp(A (c_i - c_j) h) (0, n_j -
//   n_0)
// (Lawson 1967, Krogstad 2005), and so at the end of the step, with b for a, and for its error: a constant
// load is as exact as none. Where a method goes back in time from one stage to the next, a decay grows:
// strongly damped oscillators are not for dop853.
#pragma once

#include <vector>

#include <pliant/body/model.h>
#include <pliant/method/butcher_tableau.h>
#include <pliant/method/free_oscillation.h>

namespace pliant {

class FreeStages {
 public:
  /// For steps of h (s); at once when it is for those already.
  void prepare(const Model& model, const ButcherTableau& of, double h);
  bool any() const { return !parts_.empty(); }
  /// Keeps n of a stage, at (q, v), and leaves v_dot of these coordinates zero; and their q_dot.
  void take(int stage, const VecX<double>& q, const VecX<double>& v, VecX<double>& v_dot);
  void still(VecX<double>& q_dot) const;
  /// What was kept at the end of a step is that of the start of this one.
  void reuse_end_rates();
  /// The coordinates and velocities of a stage, or at the end of the step for the number of stages. start:
  /// those at the start of the step; may be q and v themselves.
  void move(int stage, const VecX<double>& q_start, const VecX<double>& v_start, VecX<double>& q,
            VecX<double>& v) const;
  /// h sum_j weights_j exp(A (1 - c_j) h) (0, n_j - n_0).
  void weigh(const double* weights, int count, VecX<double>& q, VecX<double>& v) const;

 private:
  struct OfPart {
    const Oscillators* oscillators;
    int q0, v0;
    MatX<double> n;                                     ///< a column a stage, and one of the end
    std::vector<OscillatorMoves> from_start;            ///< over c_i h, of each stage and the end
    std::vector<std::vector<OscillatorKicks>> between;  ///< over (c_i - c_j) h, where a_ij is not zero
  };
  /// The weights of the stages before a stage, or of all for the end.
  const double* weights(int stage) const {
    return stage == of_->stages ? of_->b : of_->a + stage * (stage - 1) / 2;
  }
  /// Adds weight exp(A t) (0, n_stage - n_0), by kicks over t.
  static void add_kicks(const OfPart& part, const OscillatorKicks& kicks, int stage, double weight,
                        VecX<double>& q, VecX<double>& v);
  double node(int stage) const { return stage >= of_->stages ? 1 : of_->c[stage]; }

  const Model* model_ = nullptr;
  const ButcherTableau* of_ = nullptr;
  double h_ = 0;
  std::vector<OfPart> parts_;
};

}  // namespace pliant
