// The work of external forces and torques during displacements by contact impulses and by the separation of
// overlapping bodies.
#pragma once

#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

class LoadWork {
 public:
  /// from: the state before the displacement.
  LoadWork(const Dynamics& dynamics, const State& from);
  /// Returns the work of the forces and torques at time t (s) during the displacement to the state `to`, J.
  double work_until(double t, const State& to);

 private:
  void evaluate_frames(const State& state);

  const Dynamics& dynamics_;
  std::vector<int> loaded_;  // moving parts with forces or torques
  Workspace<double> work_;
  // Before the displacement:
  std::vector<Vec3<double>> x_;  // attachment point of each force, m, world
  std::vector<Mat3<double>> R_;  // orientation of each loaded part, body to world
};

}  // namespace pliant
