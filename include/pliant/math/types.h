// Vectors and matrices of the engine: fixed size, bounded size, run-time size.
#pragma once

#include <Eigen/Core>

namespace pliant {

/// Maximum number of global parameters n_s of a part that are degrees of freedom.
inline constexpr int kMaxGlobal = 32;
/// Maximum number of velocities of a part without local deformation: 6 + n_s.
inline constexpr int kMaxVelocities = 6 + kMaxGlobal;

template <class T, int N>
using Vec = Eigen::Matrix<T, N, 1>;
template <class T>
using Vec3 = Vec<T, 3>;
template <class T>
using Mat3 = Eigen::Matrix<T, 3, 3>;

/// Run-time size with a bound at compile time. The entries are stored in the object, without heap allocation.
template <class T, int Max = kMaxVelocities>
using VecMax = Eigen::Matrix<T, Eigen::Dynamic, 1, 0, Max, 1>;
template <class T, int Max = kMaxVelocities>
using MatMax = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic, 0, Max, Max>;

/// Returns [a]x, the matrix of the cross product: skew(a) b = a x b.
template <class T>
Mat3<T> skew(const Vec3<T>& a) {
  const T zero(0.0);
  Mat3<T> A;
  A << zero, -a[2], a[1], a[2], zero, -a[0], -a[1], a[0], zero;
  return A;
}

template <class T>
using VecX = Eigen::Matrix<T, Eigen::Dynamic, 1>;
template <class T>
using MatX = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace pliant
