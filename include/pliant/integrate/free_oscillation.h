// Local coordinates that are oscillators, q_ddot = -omega^2 q - D q_dot + what else acts, are moved by the
// exact solution of the first two terms, and a method of integration sees the rest alone (Lawson 1967; Strang
// 1968). Held by joints they are left to the method: what holds them is as stiff as they are. All other
// coordinates stay as they are.
#pragma once

#include <pliant/body/model.h>

namespace pliant {

/// Whether the local coordinates of a part are moved so.
bool oscillates_freely(const PartModel& part);

class FreeOscillation {
 public:
  /// For moves by h (s); at once when it is for that already.
  void prepare(const Model& model, double h);
  /// Whether there is none.
  bool empty() const { return parts_.empty(); }
  /// (q, v) <- exp(A h) (q, v), of coordinates and velocities or of changes of them.
  void move(VecX<double>& q, VecX<double>& v) const;
  /// Takes A (q, v) off v_dot, and off the rates of q all that they are.
  void take_off(const VecX<double>& q, const VecX<double>& v, VecX<double>& v_dot) const;
  void take_off(VecX<double>& q_dot) const;

 private:
  struct OfPart {
    const Oscillators* oscillators;
    int q0, v0;
    VecX<double> qq, qv, vq, vv;  ///< q <- qq q + qv v,  v <- vq q + vv v
  };
  const Model* model_ = nullptr;
  double h_ = 0;
  std::vector<OfPart> parts_;
};

}  // namespace pliant
