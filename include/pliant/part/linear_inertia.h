// Inertia of a part whose s is linear in its dynamic parameters q_1 ... q_n,
//   s = s_0 + sum s_k q_k,   J = (s_1 ... s_n) constant.
// The first moments sum m s_k and the second moments sum m s_k s_l^T, k, l = 0 ... n, are summed once over
// the mass points. In a step, these moments replace the sums of Eq. (11).
#pragma once

#include <pliant/math/scalar/dual.h>
#include <pliant/part/inertia.h>

namespace pliant {

class LinearInertia {
 public:
  /// n: number of dynamic parameters.
  explicit LinearInertia(int n);
  /// Adds a mass point of mass m (kg). The columns of s (3 x (1 + n)) are s_0, s_1 ... s_n at this point.
  void add(const Eigen::Matrix3Xd& s, double m);

  /// Returns M at q_s, (6 + n) x (6 + n).
  MatMax<double> mass_matrix(const VecMax<double>& q_s) const;
  /// Computes M, g_q, the mass and the first moment. The arguments are those of Part::evaluate_inertia().
  void evaluate(const VecMax<double>& q_s, const VecMax<double>& q_s_dot, const Vec3<double>& omega,
                Inertia<double>& out) const;
  void evaluate(const VecMax<Dual<1>>& q_s, const VecMax<Dual<1>>& q_s_dot, const Vec3<Dual<1>>& omega,
                Inertia<Dual<1>>& out) const;

 private:
  /// 3 x 3 blocks side by side, one for each s_k, k = 0 ... n.
  template <class P>
  using Blocks = Eigen::Matrix<P, 3, Eigen::Dynamic, 0, 3, 3 * (1 + kMaxGlobal)>;
  /// Returns the blocks sum m s s_k^T at q_s.
  template <class P>
  Blocks<P> sum_s_sk(const VecMax<P>& q_s) const;
  /// Fills M and the first moment. Returns sum m s s^T.
  template <class P, class Matrix>
  Mat3<P> fill_mass_matrix(const VecMax<P>& q_s, const Blocks<P>& s_sk, Matrix& M, Vec3<P>& moment) const;
  template <class P>
  void fill(const VecMax<P>& q_s, const VecMax<P>& q_s_dot, const Vec3<P>& omega, Inertia<P>& out) const;

  int n_;
  double mass_ = 0;
  Eigen::Matrix3Xd first_;  // columns sum m s_k
  MatX<double> second_;     // 3 x 3 blocks sum m s_k s_l^T
};

}  // namespace pliant
