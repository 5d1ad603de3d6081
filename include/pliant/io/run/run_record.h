// run.json: what a run was asked to do, how far it came, what it cost and what was noticed. Rewritten whole
// while the run goes on, so that its status always tells the truth about the files beside it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pliant/io/run/build_info.h>
#include <pliant/io/run/estimate_error.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

struct RunRecord {
  enum class Status { running, complete, stopped, failed };

  Status status = Status::running;
  std::string message;  ///< why it stopped or failed

  // What was asked.
  BuildInfo build;
  std::vector<std::string> command;  ///< the command line, for people
  std::string scene;                 ///< name
  std::string scene_file;
  std::vector<std::string> overrides;  ///< of the scene, "/json/pointer=value"
  std::uint64_t scene_hash = 0;
  double end = 0;         ///< s, as asked
  double asked_step = 0;  ///< s
  double step = 0;        ///< s, as taken: asked_step, or a little less so that steps fill the run
  double tolerance = 0;   ///< of the error of steps that find their own length, both above are 0 then; or 0
  double frame_rate = 0;  ///< 1/s
  std::string integrator, asked_integrator;  ///< the latter may be kAutomatic
  std::string joint_solver;                  ///< "blocks", "augmented", both, or empty without joints
  int threads = 1;
  int width = 0, height = 0;  ///< of pictures
  std::string graphics;       ///< library that drew them; empty without

  // How far it came.
  std::int64_t steps = 0, steps_done = 0;
  double time = 0;          ///< of the last state, s
  std::int64_t states = 0;  ///< recorded
  int resumed = 0;          ///< how often it was gone on with

  // What it cost, over all resumptions.
  std::vector<std::pair<std::string, double>> seconds;  ///< wall time of each stage
  StepCounters step_counters;
  Counters counters;

  // What was noticed.
  double stable_step = std::numeric_limits<double>::infinity();  ///< predicted largest, s
  double max_balance_error = 0;                                  ///< J, largest |balance| at a recorded state
  double max_energy = 0;                                         ///< J, largest |energy| at a recorded state
  double max_kinetic = 0;                                        ///< J
  double max_gap = 0;                                            ///< m, of a closed joint at a recorded state
  double max_depth = 0;                ///< of contacts at a recorded state, in sizes of the smaller part
  double open_gap = 0;                 ///< m, widest of the joints that have yet to close at the last state
  int asleep = 0;                      ///< parts that sleep in the last state
  std::optional<ErrorEstimate> error;  ///< where it was asked for
  std::vector<std::string> held;       ///< parameters that had no inertia and were held
  std::vector<std::string> skipped;    ///< what the scene did not need
  std::vector<std::string> notes;      ///< warnings and choices
  std::vector<std::string> files;      ///< written, relative to the folder; series as "meshes/frame_*.obj"

  /// Adds to the wall time of a stage.
  void add_seconds(const std::string& stage, double seconds);
  /// Adds a file or series once.
  void add_file(const std::string& name);
};

/// Throws std::system_error.
void write_run_record(const std::filesystem::path& file, const RunRecord& record);
/// Throws FileError when there is none, RecordingMismatch when it is damaged.
RunRecord read_run_record(const std::filesystem::path& file);

}  // namespace pliant
