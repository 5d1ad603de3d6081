// The states between two recorded states, for pictures and tracks.
#pragma once

#include <pliant/body/model.h>
#include <pliant/body/state.h>
#include <pliant/method/step_path.h>

namespace pliant {

/// Interpolates between consecutive recorded states. The formulas are in the README of this folder.
class RecordedStep {
 public:
  /// model, low, high: must outlive the object. If the state `high` is the end of a step with error control,
  /// the accelerations at both states are evaluated.
  RecordedStep(const Model& model, const State& low, const State& high);

  /// Whether `high` is the end of a step with error control.
  bool is_long() const { return high_->error > 0; }
  double start() const { return low_->time(); }  ///< time of `low`, s
  double end() const { return high_->time(); }   ///< time of `high`, s
  /// Returns the state at a time t (s) from start() to end().
  State at(double t) const;

 private:
  const State *low_, *high_;
  double span_;  // s
  StepPath q_;
};

}  // namespace pliant
