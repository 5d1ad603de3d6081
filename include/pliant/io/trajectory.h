// trajectory.csv: the recorded motion for people and for plotting. Made from the recording, so that the file
// is whole or absent. One header line, one line a recorded state, numbers in the shortest form that reads
// back exactly. Columns:
//   t                                        s
//   of every moving part, by its name (of up to kMaxParts parts, or as the scene asks; else totals alone):
//     NAME.c.x y z, NAME.quat.w x y z        position (m) and orientation (body to world) of the frame
//     NAME.PARAMETER                         dynamic parameters
//     NAME.c_dot.x y z, NAME.omega.x y z     m/s in the world, rad/s in the body frame
//     NAME.PARAMETER_dot                     rates
//     NAME.com.x y z                         true centre of mass (m, world), where not the frame's origin
//   track.NAME.x y z                         points that the scene tracks, m
//   joint.NAME.force.x y z, joint.NAME.gap   N in the world, on its first side; m (likewise)
//   joint.NAME.torque.x y z                  N m, about the joint, of hinges, sliders and welds
//   energy.kinetic gravity elastic springs total, work.KIND   J
//   balance                                  J: energy.total - its value at time 0 - all works
//   momentum.x y z, angular_momentum.x y z   kg m/s; kg m^2/s about the world's origin
// layout.json says the same of every single column.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pliant/body/placed_point.h>
#include <pliant/io/format/column.h>
#include <pliant/io/recording.h>
#include <pliant/scene/scene.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

class TrajectoryTable {
 public:
  static constexpr std::size_t kMaxParts = 100;

  /// scene: the tracks; simulation: the model, its dynamics and the energy that the balance refers to. Both
  /// must outlive the table.
  TrajectoryTable(const Scene& scene, const Simulation& simulation);

  std::vector<Column> columns() const;
  /// The numbers of a state, in the order of columns().
  void row(const State& state, std::vector<double>& numbers);

 private:
  void add_part(const State& state, std::size_t part, std::vector<double>& numbers) const;

  const Scene* scene_;
  const Simulation* simulation_;
  Workspace<double> work_;
  bool parts_shown_;
  bool local_shown_ = false;        // whether any part deforms locally
  std::vector<bool> centre_shown_;  // of each part
  std::vector<PlacedPoint> tracked_;
};

/// Writes the table of all states of a recording. Throws std::system_error, RecordingMismatch.
void write_trajectory(const std::filesystem::path& path, const Scene& scene, const Simulation& simulation,
                      const Recording& recording);

}  // namespace pliant
