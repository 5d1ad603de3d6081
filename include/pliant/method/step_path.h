// Coordinates between the ends of a step, as polynomials of the place in it.
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// u_0 + x (t_1 + y (t_2 + x (t_3 + y (...)))), y = 1 - x, x from 0 to 1: of degree m with m terms. It is u_0
/// at 0, u_0 + t_1 at 1.
struct StepPolynomial {
  VecX<double> start;  ///< u_0
  MatX<double> terms;  ///< t_1, t_2, ..., a column each

  void at(double x, VecX<double>& u) const;
};

class StepPath {
 public:
  /// Without an evaluation, by cubic Hermite interpolation, O(h^4). low, high: the ends; h: the time between
  /// them, s. The model must outlive the path, here and below.
  StepPath(const Dynamics& dynamics, const State& low, double h, const State& high);
  /// As a method tells it (Integrator::path).
  StepPath(const Model& model, StepPolynomial q);

  /// q at a part x of the way, from 0 to 1; quaternions are of unit length.
  void at(double x, VecX<double>& q) const;

 private:
  const Model* model_;
  StepPolynomial q_;
};

/// The terms of cubic Hermite interpolation, with room for more, which are any. rate: of u, at the ends.
MatX<double> hermite_terms(const VecX<double>& low, const Eigen::Ref<const VecX<double>>& low_rate, double h,
                           const VecX<double>& high, const Eigen::Ref<const VecX<double>>& high_rate,
                           int more = 0);

}  // namespace pliant
