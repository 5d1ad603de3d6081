// Coordinates between the ends of a step, without an evaluation: by cubic Hermite interpolation, O(h^4).
#pragma once

#include <pliant/body/dynamics.h>

namespace pliant {

class StepPath {
 public:
  /// low, high: the ends; both must outlive it.
  StepPath(const Dynamics& dynamics, const State& low, double h, const State& high);

  /// q at a part x of the way, from 0 to 1; quaternions are of unit length.
  void at(double x, VecX<double>& q) const;

 private:
  const Model& model_;
  const State &low_, &high_;
  double h_;  // s
  VecX<double> low_rate_, high_rate_;
};

}  // namespace pliant
