// What a state holds beside t, q and v, as one row of numbers, modes.npy, and some for what rests on
// contacts: supports.npy.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pliant/body/model.h>
#include <pliant/body/state.h>
#include <pliant/io/format/column.h>

namespace pliant {

/// The columns of a moving part in q.npy, in order.
std::vector<Column> coordinate_columns(const Model& model, const PartModel& part);
/// The columns of a moving part in v.npy, in order.
std::vector<Column> velocity_columns(const Model& model, const PartModel& part);
/// The columns of modes.npy, in order.
std::vector<Column> mode_columns_of(const Model& model);

/// The columns that tell which rows of supports.npy are of a state: the first, and the one after the last.
inline constexpr std::size_t kFirstCachedContact = 5, kEndOfCachedContacts = 6;
/// The columns of supports.npy, in order.
std::vector<Column> contact_cache_columns();
std::vector<double> cached_contact_row(const CachedContact& support);
/// Of a row. False when one of its numbers is not that of a part, plane or obstacle.
[[nodiscard]] bool read_cached_contact(const double* row, CachedContact& support);

/// The row of a state whose supports end before a row of theirs. Its last number is a hash of all bits of the
/// state.
void write_modes(const State& state, std::int64_t end_of_cached_contacts, std::vector<double>& row);

/// Fills in the rest of a state whose q, v and supports are set, of a model with so many limits, and parts
/// whose rest is told. False when the row's hash is not that of the state.
[[nodiscard]] bool read_modes(const std::vector<double>& row, int n_limits, std::size_t n_resting,
                              State& state);

}  // namespace pliant
