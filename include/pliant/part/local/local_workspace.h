// The workspace of a local deformation: the quantities that an evaluation recomputes, in the order of the
// stages (local_deformation.h). Each choice of the basis S adds fields in a derived class.
#pragma once

#include <bitset>
#include <new>

#include <pliant/math/types.h>

namespace pliant {

/// The response of a part to impulses on (v_r, the attachment points of joints), instead of M^-1. A method
/// that integrates the elasticity of the part implicitly supplies this response for a step.
class LocalResponse {
 public:
  virtual ~LocalResponse() = default;
  /// Returns the compliance, see LocalDeformation::compliance().
  virtual MatX<double> compliance() const = 0;
  /// Adds to d_dot the changes of the local rates that impulses g on (v_r, the attachment points) cause.
  virtual void push(const VecX<double>& g, Eigen::Ref<VecX<double>> d_dot) const = 0;
  /// Replaces impulses on v_r (on_frame) and on all local coordinates (on_d) by the changes of v_r and of the
  /// local rates that these impulses cause.
  virtual void respond(VecX<double>& on_frame, Eigen::Ref<VecX<double>> on_d) const = 0;
};

struct LocalWorkspace {
  virtual ~LocalWorkspace() = default;

  // Input: the local coordinates and their rates. The maps refer to q and v of the evaluation.
  Eigen::Map<const VecX<double>> d{nullptr, 0}, d_dot{nullptr, 0};
  // Input: the factor of the laws (PartDescription::scale_local) and its rate, 1/s.
  double law_factor = 1, law_factor_rate = 0;

  // Stage masses().
  MatX<double> H0;      ///< M over (c, theta, q_s) at d = 0
  Vec3<double> moment;  ///< sum m p, kg m
  /// One bit for each coordinate of (c, theta, q_s): true if the coordinate has no inertia because it moves
  /// no material at the current shape. The acceleration of this coordinate is zero.
  std::bitset<kMaxVelocities> without_inertia;

  // Stage forces().
  double damping = 0, drag = 0;  ///< powers of the local damping and of the drag, W, at most 0
  double actuation = 0;          ///< power of the change of law_factor, W
  VecX<double> force;            ///< forces on the local coordinates

  // Stage accelerations().
  VecX<double> a_free;  ///< (a_r, d_ddot at the attachment points) without joints and limits

  // Joints.
  MatX<double> A, A_inverse;  ///< compliance, see LocalDeformation::compliance(), and its (pseudo-)inverse
  const LocalResponse* response = nullptr;  ///< if not nullptr, A is response->compliance(), not M^-1

  /// Sets d and d_dot to n local coordinates and their rates. The arrays must outlive the use of the
  /// workspace.
  void place(const double* q_d, const double* q_d_dot, Eigen::Index n) {
    new (&d) Eigen::Map<const VecX<double>>(q_d, n);
    new (&d_dot) Eigen::Map<const VecX<double>>(q_d_dot, n);
  }
  /// Returns an estimate of the condition number of the small matrix that remains when d_ddot is eliminated:
  /// for nodes the matrix K of the reference conditions, for modes the Schur complement S of M. README.md
  /// defines both; K is not the stiffness, and S is not the shape matrix. The best value is 1.
  virtual double condition() const { return 1; }
  /// Stores A and its inverse. A is nearly singular if attachment points are close together; the
  /// pseudo-inverse then replaces the inverse.
  void set_compliance(MatX<double> compliance);
};

}  // namespace pliant
