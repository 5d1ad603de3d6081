// run.json: the options of a run, its progress, its cost and its notes. The file is replaced as a whole
// during the run, so that its status always agrees with the other files of the folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pliant/io/checksums.h>
#include <pliant/io/run/build_info.h>
#include <pliant/io/run/estimate_error.h>
#include <pliant/io/work_row.h>

namespace pliant {

struct RunRecord {
  enum class Status { running, complete, stopped, failed };

  Status status = Status::running;
  std::string message;  ///< why the run was stopped or failed

  // Options.
  BuildInfo build;
  std::vector<std::string> command;  ///< the command line
  std::string scene;                 ///< name of the scene
  std::string scene_file;
  std::vector<std::string> overrides;  ///< assignments "/json/pointer=value" applied to the scene
  std::uint64_t scene_hash = 0;
  double end = 0;             ///< requested end time, s
  double requested_step = 0;  ///< requested fixed step, s; 0 with a tolerance
  double step = 0;  ///< fixed step in use, s: requested_step, or slightly less so that steps divide the run;
                    ///< 0 with a tolerance
  double tolerance = 0;                          ///< bound on the error of a step; 0: fixed steps
  double frame_rate = 0;                         ///< frames per second, 1/s
  std::string integrator, requested_integrator;  ///< method in use; requested method, which may be kAutomatic
  std::string joint_solver;                      ///< "blocks", "augmented", both, or empty without joints
  int threads = 1;
  int width = 0, height = 0;  ///< size of pictures, pixels
  std::string graphics;       ///< graphics library of the pictures; empty without pictures

  // Progress.
  /// Number of steps of the whole run (0 with a tolerance), and of steps done so far.
  std::int64_t steps = 0, steps_done = 0;
  double time = 0;          ///< time of the last state, s
  std::int64_t states = 0;  ///< number of recorded states
  /// Number of the first recorded states that are on the disk, so that they survive a power cut.
  std::int64_t durable_states = 0;
  int resumed = 0;  ///< number of times the run was resumed

  // Cost, summed over all sessions of a resumed run.
  std::vector<std::pair<std::string, double>> seconds;  ///< wall time of each stage, s
  RunWork work;

  // Monitors and notes.
  double stable_step = std::numeric_limits<double>::infinity();  ///< predicted largest stable step, s
  double max_balance_error = 0;  ///< largest |Ledger::balance| at a recorded state, J
  double max_kinetic = 0;        ///< largest kinetic energy at a recorded state, J
  double movable_energy = 0;     ///< the energy that could move (EnergyMonitor), J
  double energy_share = 0;       ///< largest error of the balance as a share of the energy that could move
  double max_energy = 0;         ///< largest |total energy| at a recorded state, J; its zero is arbitrary
  double max_gap = 0;            ///< largest gap of a closed joint at a recorded state, m
  /// Largest ratio of a contact depth to the size of the smaller part, at a recorded state.
  double max_depth = 0;
  double open_gap = 0;                 ///< widest gap of an open joint at the last state, m
  int asleep = 0;                      ///< number of sleeping parts at the last state
  std::optional<ErrorEstimate> error;  ///< error estimate, if requested
  std::vector<std::string>
      velocities_without_inertia;    ///< parameters and frame velocities without inertia, kept constant
  std::vector<std::string> skipped;  ///< computations that the engine skipped, see skipped.h
  std::vector<std::string> notes;    ///< warnings and automatic choices
  /// Written files, relative to the folder. A series of files is one entry, for example "meshes/frame_*.obj".
  std::vector<std::string> files;

  /// Checksums of the files that are in the folder for the whole run: of the numbers of tables with the
  /// recorded states so far, and of all bytes of other files.
  Checksums checksums;

  /// Adds to the wall time of a stage.
  void add_seconds(const std::string& stage, double seconds);
  /// Adds a file or a series of files, unless it is listed already.
  void add_file(const std::string& name);
  /// Adds or replaces the checksum of a file.
  void set_checksum(const std::string& name, std::uint32_t checksum);
  /// Returns the hash of the recorded motion: the CRC-32 of q.npy and the CRC-32 of v.npy, as 16 hexadecimal
  /// digits.
  std::string trajectory_hash() const;
};

/// Writes run.json (whole or absent, see io/format/whole_file.h). Throws std::system_error.
void write_run_record(const std::filesystem::path& file, const RunRecord& record);
/// Reads run.json and compares it with its checksum. Throws FileError if there is none, RecordingMismatch if
/// it is damaged.
RunRecord read_run_record(const std::filesystem::path& file);

}  // namespace pliant
