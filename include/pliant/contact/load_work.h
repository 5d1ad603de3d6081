// The work of loads without potential energy during displacements by contact impulses and by the separation
// of overlapping bodies. These loads are forces, torques, muscles and drives (body/actuation/README.md).
#pragma once

#include <vector>

#include <pliant/body/dynamics.h>
#include <pliant/body/stages/evaluation.h>

namespace pliant {

class LoadWork {
 public:
  /// from: the state before the displacement.
  LoadWork(const Dynamics& dynamics, const State& from);
  /// Returns the work of the loads at time t (s) during the displacement to the state `to`, J.
  double work_until(double t, const State& to);

 private:
  /// The positions at which the loads act, before or after a displacement.
  struct Places {
    std::vector<Vec3<double>> forces;                    // attachment point of each force, m, world
    std::vector<std::vector<Vec3<double>>> distributed;  // ports of each distributed force, m, world
    std::vector<Mat3<double>> rotations;                 // of both parts of each torque, body to world
    std::vector<Vec3<double>> springs;                   // from end a to end b of each muscle, m, world
    std::vector<double> drives;                          // coordinate of each drive that is not passive
  };

  /// Evaluates the positions of the parts that the loads act on or read.
  Evaluation<double> evaluate(double t, const State& state);
  Places places(const Evaluation<double>& e) const;

  const Dynamics& dynamics_;
  std::vector<int> loaded_;  // parts that the loads act on or read
  Workspace<double> work_;
  Places before_;
};

}  // namespace pliant
