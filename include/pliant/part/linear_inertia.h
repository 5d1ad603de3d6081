// Inertia of a part whose material points move in straight lines with its dynamic parameters,
//   s = s_0 + sum s_k q_k,   J = (s_1 ... s_n) constant:
// moments of s_0 and s_k, taken once, stand in for the sums over mass points of Eq. (11).
#pragma once

#include <pliant/math/scalar/dual.h>
#include <pliant/part/inertia.h>

namespace pliant {

class LinearInertia {
 public:
  /// n dynamic parameters.
  explicit LinearInertia(int n);
  /// A mass m (kg) at a point, of which columns are s_0, s_1 ... s_n.
  void add(const Eigen::Matrix3Xd& s, double m);

  /// M at q_s.
  MatMax<double> mass_matrix(const VecMax<double>& q_s) const;
  /// Mass matrix and inertial forces, as Part::inertia().
  void inertia(const VecMax<double>& q_s, const VecMax<double>& q_s_dot, const Vec3<double>& omega,
               Inertia<double>& out) const;
  void inertia(const VecMax<Dual<1>>& q_s, const VecMax<Dual<1>>& q_s_dot, const Vec3<Dual<1>>& omega,
               Inertia<Dual<1>>& out) const;

 private:
  /// 3 x 3 blocks side by side, one for each s_k.
  template <class P>
  using Blocks = Eigen::Matrix<P, 3, Eigen::Dynamic, 0, 3, 3 * (1 + kMaxGlobal)>;
  /// sum m s s_k^T at q_s, k = 0 ... n.
  template <class P>
  Blocks<P> with_s(const VecMax<P>& q_s) const;
  /// Returns sum m s s^T.
  template <class P, class Matrix>
  Mat3<P> fill_mass_matrix(const VecMax<P>& q_s, const Blocks<P>& s_sk, Matrix& M, Vec3<P>& moment) const;
  template <class P>
  void fill(const VecMax<P>& q_s, const VecMax<P>& q_s_dot, const Vec3<P>& omega, Inertia<P>& out) const;

  int n_;
  double mass_ = 0;
  Eigen::Matrix3Xd first_;  // sum m s_k
  MatX<double> second_;     // sum m s_k s_l^T, in 3 x 3 blocks
};

}  // namespace pliant
