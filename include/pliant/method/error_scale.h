// The norm of the error of a step, in units of the tolerance. Each block of the coordinates of a part has its
// own scale: position in sizes of the part, rotation in radians, parameters that are lengths in sizes of the
// part, other parameters as they are, local displacement (root mean square over the nodes) in sizes of the
// part. Rates have the same scales per second. If the part moves fast, they are measured per the time in
// which its fastest rate moves it by one unit.
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

  /// Returns the largest error of a block, in tolerances. of_q, of_v: errors of the coordinates (of
  /// quaternions their components) and of the velocities. v: the velocities.
  double norm(const VecX<double>& of_q, const VecX<double>& of_v, const VecX<double>& v) const;
  /// Returns the largest error of the coordinates alone.
  double norm(const VecX<double>& of_q) const;
  /// Names the block with the largest error, for example "the velocity of part 'ball'".
  std::string worst(const VecX<double>& of_q, const VecX<double>& of_v, const VecX<double>& v) const;

 private:
  template <class Take>
  void of_coordinates(const VecX<double>& of_q, Take&& take) const;
  template <class Take>
  void of_velocities(const VecX<double>& of_v, const VecX<double>& v, Take&& take) const;

  const Model* model_;
  double tolerance_;
  VecX<double> parameter_;  ///< scale of each velocity, 1/m or 1
};

}  // namespace pliant
