// Checkpoints: complete states between two recorded states, from which a killed run is resumed. A run writes
// a checkpoint every RunOptions::checkpoint_every seconds. A folder has at most two checkpoints. A new
// checkpoint replaces the older of them, so that one remains if the newest is damaged.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include <pliant/body/model.h>
#include <pliant/body/state.h>
#include <pliant/io/work_row.h>

namespace pliant {

struct Checkpoint {
  std::int64_t states = 0;  ///< number of states that were recorded before
  State state;
  RunWork work;  ///< of the run up to this state
};

/// Writes a checkpoint in place of the older of the two checkpoints of a folder. The new checkpoint survives
/// a power cut. Throws std::system_error.
void write_checkpoint(const std::filesystem::path& folder, const Checkpoint& checkpoint);

/// A checkpoint that was found, and texts for the user about damaged checkpoints.
struct FoundCheckpoint {
  std::optional<Checkpoint> checkpoint;
  std::string damage;
};
/// Returns the latest checkpoint of a folder that is undamaged, is after exactly `states` recorded states,
/// and is not later than the time `end`, s.
FoundCheckpoint find_checkpoint(const std::filesystem::path& folder, const Model& model, std::int64_t states,
                                double end);

/// Removes the checkpoints of a run that has reached its end.
void remove_checkpoints(const std::filesystem::path& folder);

}  // namespace pliant
