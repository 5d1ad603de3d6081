// The matrix A of (I - c A) k = r (implicit_part.h) for a part that deforms by modes. The mass and the
// stiffness of the modes are diagonal. A omits the coupling of the modes to (c, theta, q_s), which vanishes
// at rest. For the rates r = (r_q, r_v), the changes are x_j for mode j and x_r for v_r = (R^T c_dot, omega,
// q_s_dot). H0 is the mass matrix of v_r without local deformation; D_r and K_r are the damping and stiffness
// of v_r, which are zero except for q_s:
//   x_j = -c (omega_j^2 (r_q + c r_v) + D_j r_v) / (1 + c D_j + c^2 omega_j^2)
//   (H0 + c D_r + c^2 K_r) x_r = -c D_r r_v - K_r (c^2 r_v + c r_q)
#pragma once

#include <Eigen/LU>

#include <pliant/method/implicit/implicit_part.h>

namespace pliant {

class ImplicitModes final : public ImplicitPart {
 public:
  explicit ImplicitModes(const PartModel& part);

  int prepare(const PartWorkspace<double>& w, double c, double t) override;
  void filter(const VecX<double>& q_dot, const Mat3<double>& R, VecX<double>& v_dot) override;
  MatX<double> compliance() const override;
  void push(const VecX<double>& g, Eigen::Ref<VecX<double>> d_ddot) const override;
  void respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_d) const override;

 private:
  Oscillators oscillators_;  ///< with the LocalWorkspace::law_factor of the last prepare()
  MatX<double> P_;           ///< one column for each mode: displacements of the attachment points of joints
  double c_ = 0;
  VecX<double> sigma_;        ///< 1 + c D + c^2 omega^2
  MatX<double> D_s_;          ///< damping of the global parameters
  MatX<double> S_r_inverse_;  ///< inverse of H0 + c D_r + c^2 K_r
};

}  // namespace pliant
