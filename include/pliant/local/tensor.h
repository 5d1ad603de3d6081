// Operations on 3x3 tensors for any scalar type, mainly Pack (four elements at once). The code is plain loops
// that compilers unroll.
#pragma once

#include <pliant/math/max_or_nan.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/math/scalar/pack.h>
#include <pliant/math/types.h>

namespace pliant {

/// Returns A B.
template <class T>
Mat3<T> product(const Mat3<T>& A, const Mat3<T>& B) {
  Mat3<T> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = A(i, 0) * B(0, j) + A(i, 1) * B(1, j) + A(i, 2) * B(2, j);
  return C;
}
/// Returns A B^T.
template <class T>
Mat3<T> product_transposed(const Mat3<T>& A, const Mat3<T>& B) {
  Mat3<T> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = A(i, 0) * B(j, 0) + A(i, 1) * B(j, 1) + A(i, 2) * B(j, 2);
  return C;
}
/// Returns A^T B.
template <class T>
Mat3<T> transposed_product(const Mat3<T>& A, const Mat3<T>& B) {
  Mat3<T> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) C(i, j) = A(0, i) * B(0, j) + A(1, i) * B(1, j) + A(2, i) * B(2, j);
  return C;
}
/// Returns A : B, the sum of A_ij B_ij.
template <class T>
T contraction(const Mat3<T>& A, const Mat3<T>& B) {
  T sum = A(0, 0) * B(0, 0);
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      if (i + j > 0) sum += A(i, j) * B(i, j);
  return sum;
}
template <class T>
T trace(const Mat3<T>& A) {
  return A(0, 0) + A(1, 1) + A(2, 2);
}
/// Returns a A.
template <class T>
Mat3<T> scaled(const T& a, const Mat3<T>& A) {
  Mat3<T> B;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) B(i, j) = a * A(i, j);
  return B;
}
/// Returns the derivative of cofactors(A) along B. The result is bilinear and symmetric in A and B, and
/// equals twice cofactors(A) for B = A.
template <class T>
Mat3<T> mixed_cofactors(const Mat3<T>& A, const Mat3<T>& B) {
  Mat3<T> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int r = (i + 1) % 3, s = (i + 2) % 3, k = (j + 1) % 3, l = (j + 2) % 3;
      C(i, j) = A(r, k) * B(s, l) - A(r, l) * B(s, k) + B(r, k) * A(s, l) - B(r, l) * A(s, k);
    }
  return C;
}
/// Returns the cofactors det(A) A^-T of A, also for singular A.
template <class T>
Mat3<T> cofactors(const Mat3<T>& A) {
  Mat3<T> C;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) {
      const int r = (i + 1) % 3, s = (i + 2) % 3, k = (j + 1) % 3, l = (j + 2) % 3;
      C(i, j) = A(r, k) * A(s, l) - A(r, l) * A(s, k);
    }
  return C;
}
/// Returns det A, from A and its cofactors.
template <class T>
T determinant(const Mat3<T>& A, const Mat3<T>& cofactors_of_A) {
  return A(0, 0) * cofactors_of_A(0, 0) + A(0, 1) * cofactors_of_A(0, 1) + A(0, 2) * cofactors_of_A(0, 2);
}

/// Returns the smallest lane, or NaN if a lane is NaN. A double has one lane.
inline double min_lane(double x) {
  return x;
}
inline double min_lane(const Pack& x) {
  double min = x[0];
  for (int i = 1; i < Pack::kLanes; ++i) min = -max_or_nan(-x[i], -min);
  return min;
}
template <int N, class T>
double min_lane(const Dual<N, T>& x) {
  return min_lane(x.v);
}

}  // namespace pliant
