// Corotated linear elasticity. F = dx/dX = R S with R the rotation nearest to F,
//   W = mu |F - R|^2 + lambda/2 (tr S - 3)^2,   P = 2 mu (F - R) + lambda (tr S - 3) R
//   dR = R [omega]x,   (tr(S) I - S) omega = axial vector of R^T dF - dF^T R.
// The polar decomposition uses scaled Newton iteration (Higham 1986).
#pragma once

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>
#include <pliant/local/solid/inverted_element.h>
#include <pliant/local/tensor.h>

namespace pliant {

/// Returns the rotation nearest to F. Throws InvertedElement if det F > 0 is not true, or if the iteration
/// does not converge because F is almost singular.
template <class T>
Mat3<T> nearest_rotation(const Mat3<T>& F) {
  using std::sqrt;
  constexpr int max_iterations = 60;
  // Bound on the squared norm of the change of R in an iteration. Convergence is quadratic, so that the error
  // after such a change is below rounding.
  constexpr double tolerance = 1e-20;
  Mat3<T> R = F;
  for (int iteration = 0; iteration < max_iterations; ++iteration) {
    const Mat3<T> C = cofactors(R);
    const T J = determinant(R, C);
    if (!(min_lane(J) > 0))
      throw InvertedElement(
          "an element of corotated material is inverted (det F <= 0); the neo-Hookean law allows inverted "
          "elements");
    const T g = sqrt(sqrt(contraction(C, C) / (contraction(R, R) * J * J)));
    const T a = T(0.5) * g, b = T(0.5) / (g * J);  // next R = a R + b cofactors(R)
    T step(0.0);
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) {
        const T next = a * R(i, j) + b * C(i, j), change = next - R(i, j);
        step += change * change;
        R(i, j) = next;
      }
    if (min_lane(T(tolerance) - step) > 0) return R;
  }
  throw InvertedElement(
      "an element of corotated material is almost flat: no nearest rotation was found in 60 iterations");
}

struct Corotated {
  static constexpr NodalEnergy::Of of = NodalEnergy::Of::position;
  static constexpr bool constant = false;
  double lambda, mu;

  explicit Corotated(const Elasticity& material) : lambda(material.lambda()), mu(material.mu()) {}

  template <class T>
  T density(const Mat3<T>& F) const {
    const Mat3<T> R = nearest_rotation(F);
    const Mat3<T> strain = F - R;
    const T dilatation = contraction(R, F) - T(3);
    return T(mu) * contraction(strain, strain) + T(lambda / 2) * dilatation * dilatation;
  }
  template <class T>
  Mat3<T> stress(const Mat3<T>& F) const {
    const Mat3<T> R = nearest_rotation(F);
    const T p = pressure(F, R);
    Mat3<T> P;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) P(i, j) = T(2 * mu) * F(i, j) + p * R(i, j);
    return P;
  }
  template <class T>
  Mat3<T> stress_along(const Mat3<T>& F, const Mat3<T>& dF) const {
    const Mat3<T> R = nearest_rotation(F), S = transposed_product(R, F), A = transposed_product(R, dF);
    Mat3<T> B = scaled(T(-1), S);
    for (int i = 0; i < 3; ++i) B(i, i) += trace(S);
    const Mat3<T> C = cofactors(B);
    const T inverse = T(1) / determinant(B, C);
    const T axial[3]{A(2, 1) - A(1, 2), A(0, 2) - A(2, 0), A(1, 0) - A(0, 1)};
    Vec3<T> omega;
    for (int i = 0; i < 3; ++i)
      omega[i] = (C(i, 0) * axial[0] + C(i, 1) * axial[1] + C(i, 2) * axial[2]) * inverse;
    const Mat3<T> dR = product(R, skew(omega));
    const T p = pressure(F, R), dp = T(lambda) * contraction(R, dF);
    Mat3<T> dP;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) dP(i, j) = T(2 * mu) * dF(i, j) + dp * R(i, j) + p * dR(i, j);
    return dP;
  }

 private:
  /// Returns the factor of R in P.
  template <class T>
  T pressure(const Mat3<T>& F, const Mat3<T>& R) const {
    return T(lambda) * (contraction(R, F) - T(3)) - T(2 * mu);
  }
};

}  // namespace pliant
