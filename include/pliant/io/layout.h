// layout.json: names, units and meanings of the columns of all tables of a run, and the times of frames.
// Columns that repeat are written once per kind of part or joint; README.md of this folder describes the
// format.
#pragma once

#include <filesystem>

#include <pliant/body/model.h>
#include <pliant/io/frame_schedule.h>
#include <pliant/io/table_columns.h>

namespace pliant {

/// Writes layout.json. trajectory: columns of trajectory.csv. contacts: whether the run records contacts.
/// Throws std::system_error.
void write_layout(const std::filesystem::path& folder, const Model& model, const FrameSchedule& schedule,
                  const TableColumns& trajectory, bool contacts = false);

/// Throws RecordingMismatch if layout.json is missing or damaged, has another version, or lists columns of
/// q.npy and v.npy that differ from the columns of the model.
void compare_layout(const std::filesystem::path& folder, const Model& model);

}  // namespace pliant
