// The columns of q.npy and v.npy, and the entries of a state besides t, q and v as rows of numbers: one row
// of modes.npy per state, and one row of supports.npy per cached contact.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/body/state.h>
#include <pliant/io/table_columns.h>

namespace pliant {

/// Returns the columns of a part in q.npy, in order, with "*" for its name; no columns if the part does not
/// move.
std::vector<Column> coordinate_columns(const Model& model, const PartModel& part);
/// Returns the columns of a part in v.npy, in order, with "*" for its name; no columns if the part does not
/// move.
std::vector<Column> velocity_columns(const Model& model, const PartModel& part);
/// Return the columns of q.npy and of v.npy. The model must outlive the columns.
TableColumns coordinate_columns(const Model& model);
TableColumns velocity_columns(const Model& model);
/// Returns the columns of modes.npy. in_clusters: whether the parts step in clusters (simulate/clusters.h);
/// there are then columns for State::step_memory. The model must outlive the columns.
TableColumns mode_columns(const Model& model, bool in_clusters);
/// Returns the number of columns of modes.npy.
std::size_t mode_count(const Model& model, bool in_clusters);

/// Numbers of the two columns of modes.npy that give the rows of a state in supports.npy: its first row, and
/// one past its last row.
inline constexpr std::size_t kFirstCachedContact = 5, kEndOfCachedContacts = 6;
/// Returns the columns of supports.npy, in order.
std::vector<Column> contact_cache_columns();
/// Returns the row of supports.npy for a cached contact.
std::vector<double> cached_contact_row(const CachedContact& contact);
/// Sets a cached contact from a row of supports.npy. Returns false if an index is not an integer >= -1, or if
/// "lasting" is neither 0 nor 1.
[[nodiscard]] bool read_cached_contact(const double* row, CachedContact& contact);

/// Computes the row of modes.npy for a state. end_of_cached_contacts: one past the last row of the state in
/// supports.npy. The last number of the row is the upper 53 bits of a hash of all bits of the state.
void write_modes(const State& state, std::int64_t end_of_cached_contacts, std::vector<double>& row);

/// Completes a state from its row of modes.npy. The q, v and contact cache of the state must already be set.
/// Returns false if the row is damaged or its last number does not match the hash of the state.
[[nodiscard]] bool read_modes(const std::vector<double>& row, const Model& model, State& state);

}  // namespace pliant
