// Function bodies of LinearInertia: M and g_q of Eq. (11) from moments.
#pragma once

#include <Eigen/Geometry>

#include <pliant/math/header_only.h>
#include <pliant/part/axial.h>
#include <pliant/part/linear_inertia.h>

namespace pliant {

PLIANT_INLINE LinearInertia::LinearInertia(int n)
    : n_(n), first_(Eigen::Matrix3Xd::Zero(3, 1 + n)), second_(MatX<double>::Zero(3 + 3 * n, 3 + 3 * n)) {}

PLIANT_INLINE void LinearInertia::add(const Eigen::Matrix3Xd& s, double m) {
  const Eigen::Map<const VecX<double>> all(s.data(), s.size());
  mass_ += m;
  first_ += m * s;
  second_ += m * all * all.transpose();
}

template <class P>
LinearInertia::Blocks<P> LinearInertia::sum_s_sk(const VecMax<P>& q_s) const {
  Blocks<P> blocks = second_.topRows<3>().cast<P>();
  for (int k = 0; k < n_; ++k) blocks += second_.middleRows<3>(3 + 3 * k).cast<P>() * q_s[k];
  return blocks;
}

template <class P, class Matrix>
Mat3<P> LinearInertia::fill_mass_matrix(const VecMax<P>& q_s, const Blocks<P>& s_sk, Matrix& M,
                                        Vec3<P>& moment) const {
  moment = first_.col(0).cast<P>();
  Mat3<P> ss = s_sk.template leftCols<3>();
  for (int k = 0; k < n_; ++k) {
    moment += first_.col(1 + k).cast<P>() * q_s[k];
    ss += s_sk.template middleCols<3>(3 + 3 * k) * q_s[k];
  }
  M.resize(6 + n_, 6 + n_);
  M.template topLeftCorner<3, 3>() = Mat3<P>::Identity() * P(mass_);
  M.template block<3, 3>(3, 0) = skew(moment);
  M.template block<3, 3>(3, 3) = Mat3<P>::Identity() * ss.trace() - ss;
  for (int k = 0; k < n_; ++k) {
    M.template block<1, 3>(6 + k, 0) = first_.col(1 + k).transpose().cast<P>();
    M.template block<1, 3>(6 + k, 3) = axial<P>(s_sk.template middleCols<3>(3 + 3 * k)).transpose();
    for (int j = 0; j <= k; ++j) M(6 + k, 6 + j) = P(second_.block<3, 3>(3 + 3 * k, 3 + 3 * j).trace());
  }
  for (Eigen::Index j = 1; j < M.cols(); ++j)
    for (Eigen::Index i = 0; i < j; ++i) M(i, j) = M(j, i);
  return ss;
}

template <class P>
void LinearInertia::fill(const VecMax<P>& q_s, const VecMax<P>& q_s_dot, const Vec3<P>& omega,
                         Inertia<P>& out) const {
  const Blocks<P> s_sk = sum_s_sk(q_s);
  const Mat3<P> ss = fill_mass_matrix(q_s, s_sk, out.M, out.moment);
  out.mass = mass_;
  // Eq. (11): g_q = -sum m G^T b with b = omega x (omega x s) + 2 omega x s1. The rate of s is
  // s1 = J q_s_dot = sum s_k q_k_dot.
  const Mat3<P> spin = skew(omega), spin2 = spin * spin;
  Vec3<P> s1 = Vec3<P>::Constant(P(0.0));
  Mat3<P> s_s1 = Mat3<P>::Constant(P(0.0));
  Blocks<P> s1_sk = Blocks<P>::Constant(3, 3 + 3 * n_, P(0.0));
  for (int k = 0; k < n_; ++k) {
    s1 += first_.col(1 + k).cast<P>() * q_s_dot[k];
    s_s1 += s_sk.template middleCols<3>(3 + 3 * k) * q_s_dot[k];
    s1_sk += second_.middleRows<3>(3 + 3 * k).cast<P>() * q_s_dot[k];
  }
  const P two(2.0);
  out.g_q.resize(6 + n_);
  out.g_q.template head<3>() = -(spin2 * out.moment + spin * s1 * two);
  out.g_q.template segment<3>(3) = -axial<P>(ss * spin2.transpose() + s_s1 * spin.transpose() * two);
  for (int k = 0; k < n_; ++k) {
    const Mat3<P> b_sk =
        spin2 * s_sk.template middleCols<3>(3 + 3 * k) + spin * s1_sk.template middleCols<3>(3 + 3 * k) * two;
    out.g_q[6 + k] = -b_sk.trace();
  }
}

PLIANT_INLINE MatMax<double> LinearInertia::mass_matrix(const VecMax<double>& q_s) const {
  MatMax<double> M;
  Vec3<double> moment;
  fill_mass_matrix(q_s, sum_s_sk(q_s), M, moment);
  return M;
}
PLIANT_INLINE void LinearInertia::evaluate(const VecMax<double>& q_s, const VecMax<double>& q_s_dot,
                                           const Vec3<double>& omega, Inertia<double>& out) const {
  fill<double>(q_s, q_s_dot, omega, out);
}
PLIANT_INLINE void LinearInertia::evaluate(const VecMax<Dual<1>>& q_s, const VecMax<Dual<1>>& q_s_dot,
                                           const Vec3<Dual<1>>& omega, Inertia<Dual<1>>& out) const {
  fill<Dual<1>>(q_s, q_s_dot, omega, out);
}

}  // namespace pliant
