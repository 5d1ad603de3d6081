// Coulomb's law at one contact: find the impulse p = (p_n, p_t) such that the velocity u = W p + b satisfies
//   0 <= p_n  _|_  u_n >= 0,   |p_t| <= mu p_n;   if the contact slides, |p_t| = mu p_n and p_t opposes u_t.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// The law of one contact for a given W and many b. The solution is exact to rounding: the contact separates,
/// sticks or slides. If the contact slides, u_t = -s p_t, and s > 0 is the root of one scalar equation.
class CoulombLaw {
 public:
  CoulombLaw();
  /// W: 3 x 3, symmetric positive definite; rows: normal, then the two tangents. mu: coefficient of friction;
  /// no friction if mu <= 0.
  CoulombLaw(const Mat3<double>& W, double mu);
  /// Returns the impulse p for a velocity b without impulse.
  Vec3<double> impulse(const Vec3<double>& b) const;

 private:
  /// Returns the impulse of a sticking contact. p_frictionless: the normal impulse without friction. c: the
  /// tangential velocity with this impulse.
  Vec3<double> stick(double p_frictionless, const Eigen::Vector2d& c) const;
  /// Returns the impulse of a sliding contact. p_frictionless, c: as for stick(). If s exceeds the range of a
  /// double, the result is p_frictionless along the normal and no tangential impulse.
  Vec3<double> slide(double p_frictionless, const Eigen::Vector2d& c) const;

  double mu_ = 0, W_n_ = 1;
  bool isotropic_ = false;  ///< whether W is a multiple of the identity, for example between two point masses
  Eigen::Vector2d coupling_ = Eigen::Vector2d::Zero();  ///< entries of W between the tangents and the normal
  /// A = W_tt - W_tn W_nt / W_nn, the Schur complement of the normal, its eigenvalues and its eigenvectors.
  Eigen::Matrix2d A_ = Eigen::Matrix2d::Identity();
  Eigen::Array2d stiffness_ = Eigen::Array2d::Ones();
  Eigen::Matrix2d modes_ = Eigen::Matrix2d::Identity();
};

/// Returns the impulse of one contact for W (3 x 3), the velocity b without impulse and the coefficient of
/// friction mu.
inline Vec3<double> solve_coulomb(const Mat3<double>& W, const Vec3<double>& b, double mu) {
  return CoulombLaw(W, mu).impulse(b);
}

}  // namespace pliant
