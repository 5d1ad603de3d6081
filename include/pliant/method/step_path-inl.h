// Function bodies of step_path.h: Horner evaluation of the polynomial and cubic Hermite interpolation.
#pragma once

#include <pliant/method/step_path.h>

#include <utility>

#include <pliant/body/advance.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE void StepPolynomial::at(double x, VecX<double>& u) const {
  Eigen::Index k = terms.cols() - 1;
  u = terms.col(k);
  while (k-- > 0) u = terms.col(k) + (k % 2 == 0 ? 1 - x : x) * u;
  u = start + x * u;
}

PLIANT_INLINE MatX<double> hermite_terms(const VecX<double>& low,
                                         const Eigen::Ref<const VecX<double>>& low_rate, double h,
                                         const VecX<double>& high,
                                         const Eigen::Ref<const VecX<double>>& high_rate, int extra_columns) {
  MatX<double> terms(low.size(), 3 + extra_columns);
  terms.col(0) = high - low;
  terms.col(1) = h * low_rate - terms.col(0);
  terms.col(2) = terms.col(0) - h * high_rate - terms.col(1);
  return terms;
}

PLIANT_INLINE StepPath::StepPath(const Dynamics& dynamics, const State& low, double h, const State& high)
    : model_(&dynamics.model()) {
  VecX<double> low_rate, high_rate;
  dynamics.coordinate_rates(low.q, low.v, low_rate);
  dynamics.coordinate_rates(high.q, high.v, high_rate);
  q_ = {low.q, hermite_terms(low.q, low_rate, h, high.q, high_rate)};
}

PLIANT_INLINE StepPath::StepPath(const Model& model, StepPolynomial q) : model_(&model), q_(std::move(q)) {}

PLIANT_INLINE void StepPath::at(double x, VecX<double>& q) const {
  q_.at(x, q);
  normalise_rotations(*model_, q);
}

}  // namespace pliant
