// What a state holds beside t, q and v, as one row of numbers: modes.npy.
#pragma once

#include <string>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/io/column.h>

namespace pliant {

/// The columns of a moving part in q.npy, in order.
std::vector<Column> coordinate_columns(const Model& model, const PartModel& part);
/// The columns of a moving part in v.npy, in order.
std::vector<Column> velocity_columns(const Model& model, const PartModel& part);
/// The columns of modes.npy, in order.
std::vector<Column> mode_columns_of(const Model& model);

/// The row of a state. Its last number is a hash of all bits of the state.
void write_modes(const State& state, std::vector<double>& row);

/// Fills in the rest of a state whose q and v are set, of a model with so many limits, and parts whose rest
/// is told. False when the row's hash is not that of the state.
[[nodiscard]] bool read_modes(const std::vector<double>& row, int n_limits, std::size_t n_resting,
                              State& state);

}  // namespace pliant
