// What forces and torques do while impulses at contacts, and what parts bodies, move these within a step.
#pragma once

#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

class LoadWork {
 public:
  /// From where the parts of a state are.
  LoadWork(const Dynamics& dynamics, const State& from);
  /// To where they are in another state at time t (s), J.
  double until(double t, const State& to);

 private:
  void place(const State& state);

  const Dynamics& dynamics_;
  std::vector<int> loaded_;  // parts that forces and torques act on
  Workspace<double> work_;
  std::vector<Vec3<double>> x_;  // of each force
  std::vector<Mat3<double>> R_;  // of each loaded part
};

}  // namespace pliant
