// What errors of a step are measured in: a tolerance times what belongs to each block of a part's numbers.
// Its place in sizes of the part, its rotation in radians, lengths among its parameters in sizes of the part
// and others as they are, its local displacement in sizes of the part (root mean square over its nodes).
// Their rates are measured in the same per second or, where that is more, per the time in which the fastest
// of the part's rates would move it by as much.
#pragma once

#include <string>

#include <pliant/body/model.h>

namespace pliant {

/// The least and the greatest tolerance that a simulation takes.
inline constexpr double kLeastTolerance = 1e-12, kGreatestTolerance = 0.1;

class ErrorScale {
 public:
  /// tolerance: > 0. model: must outlive it.
  ErrorScale(const Model& model, double tolerance);
  double tolerance() const { return tolerance_; }

  /// The largest error of a block, in tolerances; of changes of coordinates and of velocities (of quaternions
  /// their derivatives). v: velocities there.
  double norm(const VecX<double>& of_q, const VecX<double>& of_v, const VecX<double>& v) const;
  /// The same of coordinates alone.
  double norm(const VecX<double>& of_q) const;
  /// The block with the largest error, in words: "the velocity of part 'ball'".
  std::string worst(const VecX<double>& of_q, const VecX<double>& of_v, const VecX<double>& v) const;

 private:
  template <class Take>
  void of_coordinates(const VecX<double>& of_q, Take&& take) const;
  template <class Take>
  void of_velocities(const VecX<double>& of_v, const VecX<double>& v, Take&& take) const;

  const Model* model_;
  double tolerance_;
  VecX<double> parameter_;  ///< by velocity, 1 / m or 1
};

}  // namespace pliant
