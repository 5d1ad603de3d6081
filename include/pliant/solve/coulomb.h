// Coulomb's law at one contact: what push p = (p_n, p_t) meets the velocity u = W p + b there,
//   0 <= p_n  _|_  u_n >= 0,   |p_t| <= mu p_n,   and p_t against u_t with |p_t| = mu p_n where it slides.
#pragma once

#include <Eigen/Cholesky>

#include <pliant/math/types.h>

namespace pliant {

/// The law of one contact, for many b. Exact but for rounding: it lifts off, sticks, or slides, the rate of
/// sliding found as the root of one equation.
class CoulombLaw {
 public:
  CoulombLaw();
  /// W: of full rank, symmetric positive definite; rows: normal, then the two tangents.
  CoulombLaw(const Mat3<double>& W, double mu);
  Vec3<double> push(const Vec3<double>& b) const;

 private:
  Vec3<double> slide(const Vec3<double>& b, double p_alone) const;

  double mu_ = 0, W_n_ = 1;
  bool even_ = false;  ///< whether W is a multiple of 1, as where points push on points
  Eigen::Vector2d coupling_ = Eigen::Vector2d::Zero();  ///< of the tangents with the normal
  // Of the Schur complement A of the normal.
  Eigen::Array2d stiffness_ = Eigen::Array2d::Ones();
  Eigen::Matrix2d modes_ = Eigen::Matrix2d::Identity();
  Eigen::LDLT<Mat3<double>> factor_{Mat3<double>(Mat3<double>::Identity())};  ///< of W
};

inline Vec3<double> solve_coulomb(const Mat3<double>& W, const Vec3<double>& b, double mu) {
  return CoulombLaw(W, mu).push(b);
}

}  // namespace pliant
