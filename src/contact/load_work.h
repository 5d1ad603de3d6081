// The work of forces and torques during displacements by contact impulses and separations within a step.
#pragma once

#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

class LoadWork {
 public:
  /// Starts from the positions of the parts in a state.
  LoadWork(const Dynamics& dynamics, const State& from);
  /// Returns the work up to the positions in another state at time t (s), J.
  double until(double t, const State& to);

 private:
  void place(const State& state);

  const Dynamics& dynamics_;
  std::vector<int> loaded_;  // parts with forces and torques
  Workspace<double> work_;
  std::vector<Vec3<double>> x_;  // position of each force
  std::vector<Mat3<double>> R_;  // orientation of each loaded part
};

}  // namespace pliant
