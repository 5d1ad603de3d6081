// The norm of the error of a step, in units of the tolerance (README.md of this folder, Error of a step).
// Each block of the coordinates of a part has its own scale: the position and parameters that are lengths in
// sizes of the part, the rotation in radians, other parameters in their own unit, and the root mean square of
// the local displacement in sizes of the part. Rates have these scales per second. If the part moves fast,
// its rates are measured per the time in which the fastest one changes its coordinate by one unit.
#pragma once

#include <string>

#include <pliant/body/model.h>

namespace pliant {

/// The smallest and the largest tolerance of a simulation.
inline constexpr double kLeastTolerance = 1e-12, kGreatestTolerance = 0.1;

class ErrorScale {
 public:
  /// tolerance: > 0. The model must outlive the scale.
  ErrorScale(const Model& model, double tolerance);
  double tolerance() const { return tolerance_; }

  /// Returns the largest error of a block, in tolerances. q_error, v_error:
  /// errors of the coordinates (of quaternions their components) and of the velocities. v: the velocities.
  double norm(const VecX<double>& q_error, const VecX<double>& v_error, const VecX<double>& v) const;
  /// Returns the largest error of the coordinates alone, in tolerances.
  double norm(const VecX<double>& q_error) const;
  /// Names the block with the largest error, for example "the velocity of part 'ball'".
  std::string worst(const VecX<double>& q_error, const VecX<double>& v_error, const VecX<double>& v) const;

 private:
  template <class Visit>
  void visit_coordinates(const VecX<double>& q_error, Visit&& visit) const;
  template <class Visit>
  void visit_velocities(const VecX<double>& v_error, const VecX<double>& v, Visit&& visit) const;

  const Model* model_;
  double tolerance_;
  VecX<double> parameter_;  ///< scale of each velocity, 1/m or 1
};

}  // namespace pliant
