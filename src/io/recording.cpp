#include <pliant/io/recording.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include <pliant/io/layout.h>
#include <pliant/io/recorded_step.h>
#include <pliant/io/run/run_files.h>
#include <pliant/io/state_row.h>

#include "step_between.h"

namespace pliant {
namespace {

NpyReader open_table(const std::filesystem::path& path, int columns) {
  try {
    NpyReader reader(path);
    if (reader.columns() != columns)
      throw RecordingMismatch(path.string() + " has " + std::to_string(reader.columns()) +
                              " columns, and this scene needs " + std::to_string(columns));
    return reader;
  } catch (const std::system_error&) {
    throw;
  } catch (const RecordingMismatch&) {
    throw;
  } catch (const std::runtime_error& fault) {
    throw RecordingMismatch(fault.what());
  }
}

/// Opens modes.npy, with or without columns for clusters.
NpyReader open_modes(const std::filesystem::path& folder, const Model& model) {
  const std::filesystem::path path = folder / kModesFile;
  const int in_clusters = static_cast<int>(mode_count(model, true));
  try {
    NpyReader reader(path);
    if (model.forms_clusters() && reader.columns() == in_clusters) return reader;
  } catch (const std::runtime_error&) {
    // open_table() reports the fault
  }
  return open_table(path, static_cast<int>(mode_count(model, false)));
}

bool has_contact_cache(const Model& model) {
  return model.body().contact.active;
}

}  // namespace

std::vector<CheckedTable> checked_tables(const Model& model) {
  std::vector<CheckedTable> tables{{kTimesFile, true},
                                   {kCoordinatesFile, true},
                                   {kVelocitiesFile, true},
                                   {kModesFile, true},
                                   {kWorkFile, true}};
  if (has_contact_cache(model)) tables.push_back({kContactCacheFile, false});
  return tables;
}

ChecksumReader state_checksums(const std::filesystem::path& folder, const Model& model) {
  return {folder, kChecksumsFile, checked_tables(model)};
}

namespace {

int work_count() {
  return static_cast<int>(work_columns().size());
}

int cached_contact_count() {
  return static_cast<int>(contact_cache_columns().size());
}

/// The rows of supports.npy that belong to a state: the first, and one past the last. Both are -1 if the row
/// of the state in modes.npy is damaged.
struct CachedContactRows {
  std::int64_t first = -1, end = -1;
};
CachedContactRows cached_contact_rows(const std::vector<double>& modes) {
  const double first = modes[kFirstCachedContact], end = modes[kEndOfCachedContacts];
  if (!(0 <= first && first <= end && end < 0x1p53 && first == std::floor(first) && end == std::floor(end)))
    return {};
  return {static_cast<std::int64_t>(first), static_cast<std::int64_t>(end)};
}

/// Indices of the tables of checked_tables().
enum : std::size_t { kTimes, kCoordinates, kVelocities, kModes, kWorkOfState, kContactCache };

std::vector<double> read_row(const NpyReader& table, std::int64_t row) {
  std::vector<double> numbers(static_cast<std::size_t>(table.columns()));
  table.read(row, numbers.data());
  return numbers;
}

}  // namespace

RecordingWriter::RecordingWriter(Tables tables, ChecksumWriter checksums)
    : tables_(std::move(tables)), checksums_(std::move(checksums)) {}

RecordingWriter RecordingWriter::create(const std::filesystem::path& folder, const Model& model,
                                        bool in_clusters) {
  std::optional<NpyWriter> contact_cache;
  if (has_contact_cache(model))
    contact_cache.emplace(NpyWriter::create(folder / kContactCacheFile, cached_contact_count()));
  return {{NpyWriter::create(folder / kTimesFile, kNpyVector),
           NpyWriter::create(folder / kCoordinatesFile, model.n_q()),
           NpyWriter::create(folder / kVelocitiesFile, model.n_v()),
           NpyWriter::create(folder / kModesFile, static_cast<int>(mode_count(model, in_clusters))),
           NpyWriter::create(folder / kWorkFile, work_count()), std::move(contact_cache)},
          ChecksumWriter::create(folder / kChecksumsFile, checked_tables(model))};
}

RecordingWriter RecordingWriter::resume(const std::filesystem::path& folder, const Model& model,
                                        std::int64_t rows) {
  std::optional<NpyWriter> contact_cache;
  if (has_contact_cache(model)) {
    const std::int64_t end =
        rows > 0 ? cached_contact_rows(read_row(open_modes(folder, model), rows - 1)).end : 0;
    if (end < 0)
      throw RecordingMismatch((folder / kModesFile).string() + " is damaged at row " +
                              std::to_string(rows - 1));
    contact_cache.emplace(NpyWriter::resume(folder / kContactCacheFile, cached_contact_count(), end));
  }
  return {{NpyWriter::resume(folder / kTimesFile, kNpyVector, rows),
           NpyWriter::resume(folder / kCoordinatesFile, model.n_q(), rows),
           NpyWriter::resume(folder / kVelocitiesFile, model.n_v(), rows),
           NpyWriter::resume(folder / kModesFile, open_modes(folder, model).columns(), rows),
           NpyWriter::resume(folder / kWorkFile, work_count(), rows), std::move(contact_cache)},
          ChecksumWriter::resume(folder / kChecksumsFile, checked_tables(model), rows)};
}

void RecordingWriter::append(const State& state, const RunWork& work) {
  const double time = state.time();
  tables_.times.append(&time);
  checksums_.add(kTimes, &time, 1);
  tables_.coordinates.append(state.q.data());
  checksums_.add(kCoordinates, state.q.data(), static_cast<std::size_t>(state.q.size()));
  tables_.velocities.append(state.v.data());
  checksums_.add(kVelocities, state.v.data(), static_cast<std::size_t>(state.v.size()));
  if (tables_.contact_cache)
    for (const CachedContact& contact : state.contact_cache) {
      const std::vector<double> row = cached_contact_row(contact);
      tables_.contact_cache->append(row.data());
      checksums_.add(kContactCache, row.data(), row.size());
    }
  write_modes(state, tables_.contact_cache ? tables_.contact_cache->rows() : 0, row_);
  tables_.modes.append(row_.data());
  checksums_.add(kModes, row_.data(), row_.size());
  row_ = work_row(work);
  tables_.work.append(row_.data());
  checksums_.add(kWorkOfState, row_.data(), row_.size());
  checksums_.end_state();
}

void RecordingWriter::flush(bool to_disk) {
  auto flush_table = [to_disk](auto& table) { to_disk ? table.flush_to_disk() : table.flush(); };
  if (tables_.contact_cache) flush_table(*tables_.contact_cache);
  for (NpyWriter* table :
       {&tables_.coordinates, &tables_.velocities, &tables_.modes, &tables_.work, &tables_.times})
    flush_table(*table);
  flush_table(checksums_);
}

std::size_t RecordingWriter::pending_bytes() const {
  return tables_.coordinates.pending_bytes() + tables_.velocities.pending_bytes() +
         tables_.modes.pending_bytes() + tables_.work.pending_bytes() + checksums_.pending_bytes() +
         (tables_.contact_cache ? tables_.contact_cache->pending_bytes() : 0);
}

Recording::Recording(const std::filesystem::path& folder, const Model& model)
    : model_(&model),
      coordinates_((compare_layout(folder, model), open_table(folder / kCoordinatesFile, model.n_q()))),
      velocities_(open_table(folder / kVelocitiesFile, model.n_v())),
      modes_(open_modes(folder, model)),
      work_(open_table(folder / kWorkFile, work_count())),
      checksums_(state_checksums(folder, model)) {
  const NpyReader times = open_table(folder / kTimesFile, kNpyVector);
  if (has_contact_cache(model))
    contact_cache_.emplace(open_table(folder / kContactCacheFile, cached_contact_count()));
  const std::int64_t rows = checksums_.whole_states();
  times_.resize(static_cast<std::size_t>(rows));
  for (std::int64_t row = 0; row < rows; ++row) times.read(row, &times_[static_cast<std::size_t>(row)]);
  for (std::size_t row = 1; row < times_.size(); ++row)
    if (!(times_[row] > times_[row - 1]))
      throw RecordingMismatch((folder / kTimesFile).string() + " is damaged: time does not increase at row " +
                              std::to_string(row));
}

State Recording::state(std::int64_t row) const {
  auto damaged = [&] {
    return RecordingMismatch("the recorded state at row " + std::to_string(row) +
                             " is damaged: its check number does not match");
  };
  State state;
  const std::vector<double> modes = read_row(modes_, row);
  const CachedContactRows rows = cached_contact_rows(modes);
  if (rows.first < 0 || rows.end > (contact_cache_ ? contact_cache_->rows() : 0)) throw damaged();
  if (rows.end > rows.first) {
    const auto columns = static_cast<std::size_t>(cached_contact_count());
    std::vector<double> numbers(static_cast<std::size_t>(rows.end - rows.first) * columns);
    contact_cache_->read(rows.first, numbers.data(), rows.end - rows.first);
    for (std::size_t i = 0; i < numbers.size(); i += columns)
      if (!read_cached_contact(numbers.data() + i, state.contact_cache.emplace_back())) throw damaged();
  }
  state.q.resize(coordinates_.columns());
  state.v.resize(velocities_.columns());
  coordinates_.read(row, state.q.data());
  velocities_.read(row, state.v.data());
  if (!read_modes(modes, *model_, state) || !(state.time() == time(row))) throw damaged();
  return state;
}

RunWork Recording::work(std::int64_t row) const {
  return read_work_row(read_row(work_, row).data());
}

State Recording::at(double t) const {
  if (times_.empty()) throw std::out_of_range("the recording contains no state");
  const auto next = std::lower_bound(times_.begin(), times_.end(), t);
  const std::int64_t after = next - times_.begin();
  if (after == rows()) return state(rows() - 1);
  if (after == 0) return state(0);
  const State low = state(after - 1), high = state(after);
  // A frame at the time of a recorded state shows this state, also if the two times differ by rounding.
  const double span = high.time() - low.time(), tolerance = 1e-6 * std::max(high.h, low.h);
  if (high.time() - t <= tolerance) return high;
  if (t - low.time() <= tolerance) return low;
  const RecordedStep step(*model_, low, high);
  if (step.is_long())
    if (std::optional<State> there =
            step_between(*model_, low, high, (t - low.time()) / span, step.at(low.time() + 0.5 * span).q))
      return *there;
  return step.at(t);
}

}  // namespace pliant
