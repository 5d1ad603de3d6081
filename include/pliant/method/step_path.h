// Coordinates within a step, as polynomials in the fraction x of the step (Hairer, Norsett & Wanner, Solving
// Ordinary Differential Equations I, section II.6).
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

/// The polynomial u(x) = u_0 + x (t_1 + y (t_2 + x (t_3 + y (...)))), y = 1 - x, x from 0 to 1. With the
/// terms t_1 to t_m its degree is m. u(0) = u_0 and u(1) = u_0 + t_1.
struct StepPolynomial {
  VecX<double> start;  ///< u_0
  MatX<double> terms;  ///< t_1, t_2, ..., one column each

  /// Computes u at the fraction x of the step.
  void at(double x, VecX<double>& u) const;
};

class StepPath {
 public:
  /// Cubic Hermite interpolation of q from q and q_dot at both ends, with an error O(h^4). No accelerations
  /// are evaluated. low, high: the states at the ends; h: the time between low and high, s. The model must
  /// outlive the path.
  StepPath(const Dynamics& dynamics, const State& low, double h, const State& high);
  /// The dense output of a method (Integrator::path).
  StepPath(const Model& model, StepPolynomial q);

  /// Computes q at the fraction x of the step, from 0 to 1, with normalised quaternions.
  void at(double x, VecX<double>& q) const;

 private:
  const Model* model_;
  StepPolynomial q_;
};

/// Returns the terms t_1 to t_3 of cubic Hermite interpolation in columns 0 to 2, and `extra_columns` columns
/// that are not set. low, high: u at the ends of a step of h s; low_rate, high_rate: the rates of u there.
MatX<double> hermite_terms(const VecX<double>& low, const Eigen::Ref<const VecX<double>>& low_rate, double h,
                           const VecX<double>& high, const Eigen::Ref<const VecX<double>>& high_rate,
                           int extra_columns = 0);

}  // namespace pliant
