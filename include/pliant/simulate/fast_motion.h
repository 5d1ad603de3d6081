// The fastest small motions about a state: eigenvalues of the Jacobian of the equations of motion. Let x be a
// small change of the coordinates, with one entry for each velocity, and x_dot its rate. Then
//   d/dt (x, x_dot) = (x_dot, da/dq x + da/dv x_dot),
// where a(t, q, v) are the accelerations with joints, limits, springs, elasticity and damping. An eigenvalue
// -sigma +- i omega is a damped oscillation. Arnoldi's method (Saad, Numerical Methods for Large Eigenvalue
// Problems, chapter 6) computes the eigenvalues of large modulus. The method needs only products with the
// Jacobian, which are central differences of the accelerations.
#pragma once

#include <complex>
#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

/// An approximate eigenvalue and its eigenvector.
struct FastMotion {
  std::complex<double> value;              ///< 1/s
  double residual = 0;                     ///< norm of the residual, relative to |value|
  VecX<std::complex<double>> combination;  ///< the eigenvector, in the basis of FastMotions
};

/// The part, and the coordinates of this part, with most of the kinetic energy of a motion.
struct MotionPlace {
  int part = -1;  ///< number of the part with the largest kinetic energy
  /// Whether the local coordinates, or the global parameters, have the largest share of the energy of the
  /// part.
  bool is_local = false, is_of_parameters = false;
};

/// Arnoldi's method about a state.
class FastMotions {
 public:
  /// moves: for each velocity, whether it takes part in the motion; all other velocities are kept constant.
  /// The dynamics must outlive this object. state: its step length determines the gains of Baumgarte's terms.
  FastMotions(const Dynamics& dynamics, const State& state, std::vector<bool> moves);

  /// Adds up to `count` vectors to the Krylov space. Returns false if no more vectors can be added, because
  /// the space is invariant or contains its largest number of vectors.
  bool extend(int count);
  /// Returns the eigenvalues in the current space, without those that rounding errors cause.
  std::vector<FastMotion> motions() const;
  /// Returns the place of a motion.
  MotionPlace place(const FastMotion& motion) const;
  /// The stiffness K (1/s^2) and the damping D (1/s) against a motion: x_ddot + D x_dot + K x = 0.
  struct Resistance {
    double K = 0, D = 0;
  };
  /// Returns the resistance against a motion. A pair of complex eigenvalues determines the resistance. For a
  /// real eigenvalue, the second eigenvalue of the motion is unknown; K and D are then computed from
  /// derivatives of the accelerations along the eigenvector.
  Resistance resistance(const FastMotion& motion);

 private:
  VecX<double> scaled(const VecX<double>& x, const VecX<double>& x_dot) const;
  void set_scales();
  /// Returns the derivative of the accelerations along a change x of the coordinates and x_dot of the
  /// velocities.
  VecX<double> derivative(const VecX<double>& x, const VecX<double>& x_dot);
  VecX<double> image(const VecX<double>& u);
  /// Returns the velocities of a motion times their weights.
  VecX<std::complex<double>> velocities(const FastMotion& motion) const;

  const Dynamics& dynamics_;
  State state_;
  std::vector<bool> moves_;
  Workspace<double> work_;
  VecX<double> length_;  ///< size of a large change of each coordinate: m, or 1 for other units
  VecX<double> weight_;  ///< square root of the inertia of each velocity
  double rate_ = 0;      ///< a typical rate of change, 1/s; 0: nothing is stiff or damped
  double largest_ = 0;   ///< largest norm of a product of the Jacobian with a vector of basis_
  std::vector<VecX<double>> basis_;
  MatX<double> H_;  ///< the projection of the Jacobian onto the basis, with one row more
};

}  // namespace pliant
