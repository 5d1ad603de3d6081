// The norm of the error of a step, in units of the tolerance (README.md of this folder, Error of a step).
// Each block of the coordinates of a part has its own unit. The unit is the size of the part for the
// position, for parameters that are lengths, and for the root mean square of the local displacement. The unit
// of the rotation is the radian. Other parameters keep their own unit. Errors of rates, in these units per
// second, are divided by slow_rate() + r, where r is the fastest rate of the part in the same units.
#pragma once

#include <string>

#include <pliant/body/model.h>

namespace pliant {

/// The smallest and the largest tolerance of a simulation.
inline constexpr double kMinTolerance = 1e-12, kMaxTolerance = 0.1;

class ErrorScale {
 public:
  /// tolerance: > 0. The model must outlive the scale.
  ErrorScale(const Model& model, double tolerance);
  double tolerance() const { return tolerance_; }

  /// Returns the largest error of all blocks, in tolerances. q_error: errors of the coordinates q; for
  /// quaternions, errors of the four components. v_error: errors of the velocities. v: the velocities, which
  /// scale v_error.
  double norm(const VecX<double>& q_error, const VecX<double>& v_error, const VecX<double>& v) const;
  /// Returns the largest error of the coordinates alone, in tolerances.
  double norm(const VecX<double>& q_error) const;
  /// Returns the name of the block with the largest error, for example "the velocity of part 'ball'"; empty
  /// if no part moves.
  std::string worst(const VecX<double>& q_error, const VecX<double>& v_error, const VecX<double>& v) const;

 private:
  template <class Visit>
  void visit_coordinates(const VecX<double>& q_error, Visit&& visit) const;
  template <class Visit>
  void visit_velocities(const VecX<double>& v_error, const VecX<double>& v, Visit&& visit) const;

  const Model* model_;
  double tolerance_;
  /// For each velocity, the factor that scales the error of the parameter or local coordinate: 1/m, 1 for
  /// angles, 1/(kg^(1/2) m) for modes. The entries of c_dot and omega are not used.
  VecX<double> parameter_;
};

}  // namespace pliant
