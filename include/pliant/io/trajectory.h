// trajectory.csv: the recorded motion as a table for plotting. It is computed from the recording when the run
// ends. The table has a header line and one line per recorded state. Numbers have the shortest form that
// reads back exactly. Columns:
//   t                                        s
//   for every part NAME that is not fixed and has no prescribed motion (scenes of up to kMaxParts parts, or
//   if the scene requests it):
//     NAME.c.x y z, NAME.quat.w x y z        position (m) and orientation (body to world) of its frame
//     NAME.PARAMETER                         dynamic parameters
//     NAME.c_dot.x y z, NAME.omega.x y z     m/s, world; rad/s, body frame
//     NAME.PARAMETER_dot                     rates of the dynamic parameters
//     NAME.com.x y z                         centre of mass (m, world), if it may differ from NAME.c
//   track.NAME.x y z                         tracked points, m, world
//   sensor.NAME                              value of a sensor
//   if the parts have columns, for every joint NAME:
//     joint.NAME.force.x y z                 force on the first side of the joint, N, world
//     joint.NAME.torque.x y z                torque on this side about the joint, N m, if the joint has a
//                                            torque
//     joint.NAME.gap                         gap, m
//   energy.kinetic gravity elastic springs total, work.KIND   J; energy.local with local deformation
//   balance                                  J: energy.total - its value at time 0 - all works
//   momentum.x y z, angular_momentum.x y z   kg m/s; kg m^2/s about the world's origin
// layout.json contains the unit and meaning of every column.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include <pliant/body/placed_point.h>
#include <pliant/io/recording.h>
#include <pliant/io/table_columns.h>
#include <pliant/scene/scene.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

class TrajectoryTable {
 public:
  static constexpr std::size_t kMaxParts = 100;

  /// scene: provides the tracks. simulation: provides the model, its dynamics, the workspace of its ledger,
  /// and the initial energy for the energy balance. Scene and simulation must outlive the table.
  TrajectoryTable(const Scene& scene, Simulation& simulation);

  /// Returns the columns of the table. The table must outlive the columns.
  TableColumns columns() const;
  /// Computes the row of a state: one number for each of columns(), in the same order.
  void row(const State& state, std::vector<double>& numbers);

 private:
  std::vector<Column> part_columns(std::size_t part) const;
  std::vector<Column> joint_columns(std::size_t joint) const;
  std::vector<Column> total_columns() const;
  void evaluate_row(const State& state, Workspace<double>& work, std::vector<double>& numbers) const;
  void add_part(const State& state, std::size_t part, const Workspace<double>& work,
                std::vector<double>& numbers) const;

  const Scene* scene_;
  Simulation* simulation_;
  bool parts_shown_;
  bool local_shown_ = false;        // whether a part deforms locally
  std::vector<bool> centre_shown_;  // per part: whether its centre of mass has columns
  std::vector<PlacedPoint> tracked_;
};

/// Writes trajectory.csv for all states of a recording. If the function throws, there is no new file. Throws
/// std::system_error, RecordingMismatch.
void write_trajectory(const std::filesystem::path& path, const Scene& scene, Simulation& simulation,
                      const Recording& recording);

}  // namespace pliant
