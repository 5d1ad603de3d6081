// A checkpoint is a vector in NumPy's format: the number of recorded states, the number of cached contacts,
// then time, the row of work.npy, coordinates, velocities, the row of modes.npy, the rows of supports.npy,
// and the CRC-32 of all numbers before.
#include <pliant/io/run/checkpoint.h>

#include <array>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include <pliant/io/checksums.h>
#include <pliant/io/format/npy.h>
#include <pliant/io/format/whole_file.h>
#include <pliant/io/run/run_files.h>
#include <pliant/io/state_row.h>

namespace fs = std::filesystem;

namespace pliant {
namespace {

std::size_t cached_contact_size() {
  return contact_cache_columns().size();
}

double crc32_of(const std::vector<double>& numbers, std::size_t count) {
  return crc32_after(0, numbers.data(), count * sizeof(double));
}

std::vector<double> numbers_of(const Checkpoint& checkpoint) {
  const State& state = checkpoint.state;
  std::vector<double> numbers{static_cast<double>(checkpoint.states),
                              static_cast<double>(state.contact_cache.size()), state.time()};
  std::vector<double> row = work_row(checkpoint.work);
  numbers.insert(numbers.end(), row.begin(), row.end());
  numbers.insert(numbers.end(), state.q.begin(), state.q.end());
  numbers.insert(numbers.end(), state.v.begin(), state.v.end());
  write_modes(state, static_cast<std::int64_t>(state.contact_cache.size()), row);
  numbers.insert(numbers.end(), row.begin(), row.end());
  for (const CachedContact& contact : state.contact_cache) {
    row = cached_contact_row(contact);
    numbers.insert(numbers.end(), row.begin(), row.end());
  }
  numbers.push_back(crc32_of(numbers, numbers.size()));
  return numbers;
}

/// Returns the numbers of a file. Throws std::runtime_error if it cannot be read or is damaged.
std::vector<double> read_numbers(const fs::path& path) {
  const NpyReader reader(path);
  std::vector<double> numbers(reader.columns() == kNpyVector ? static_cast<std::size_t>(reader.rows()) : 0);
  if (numbers.size() < 4) throw std::runtime_error(path.string() + " is too short for a checkpoint");
  reader.read(0, numbers.data(), reader.rows());
  if (crc32_of(numbers, numbers.size() - 1) != numbers.back())
    throw std::runtime_error(path.string() + " is damaged: its checksum does not match");
  return numbers;
}

/// Returns a checkpoint from the numbers of a file, or std::nullopt if the numbers do not fit the model.
std::optional<Checkpoint> checkpoint_of(const std::vector<double>& numbers, const Model& model) {
  const auto n_q = static_cast<std::size_t>(model.n_q()), n_v = static_cast<std::size_t>(model.n_v());
  const std::size_t n_contacts = static_cast<std::size_t>(numbers[1]), n_work = work_columns().size(),
                    fixed = 3 + n_work + n_q + n_v + n_contacts * cached_contact_size() + 1;
  if (numbers.size() < fixed) return std::nullopt;
  Checkpoint checkpoint;
  checkpoint.states = static_cast<std::int64_t>(numbers[0]);
  State& state = checkpoint.state;
  const double* next = numbers.data() + 3;
  checkpoint.work = read_work_row(next);
  next += n_work;
  state.q = Eigen::Map<const VecX<double>>(next, model.n_q());
  state.v = Eigen::Map<const VecX<double>>(next + n_q, model.n_v());
  next += n_q + n_v;
  const std::vector<double> modes(next, next + (numbers.size() - fixed));
  next += modes.size();
  for (std::size_t i = 0; i < n_contacts; ++i, next += cached_contact_size())
    if (!read_cached_contact(next, state.contact_cache.emplace_back())) return std::nullopt;
  if (!read_modes(modes, model, state)) return std::nullopt;
  return checkpoint;
}

}  // namespace

void write_checkpoint(const fs::path& folder, const Checkpoint& checkpoint) {
  std::array<double, 2> times{-1, -1};
  for (std::size_t i = 0; i < times.size(); ++i) {
    try {
      times[i] = read_numbers(folder / kCheckpointFiles[i])[2];
    } catch (const std::runtime_error&) {
      // An absent or damaged checkpoint is replaced first.
    }
  }
  const fs::path path = folder / kCheckpointFiles[times[0] <= times[1] ? 0 : 1];
  const std::vector<double> numbers = numbers_of(checkpoint);
  WholeFile file(path);
  file.write(npy_header(kNpyVector, static_cast<std::int64_t>(numbers.size())));
  file.write(numbers.data(), numbers.size() * sizeof(double));
  file.become_target(Durable::yes);
}

FoundCheckpoint find_checkpoint(const fs::path& folder, const Model& model, std::int64_t states, double end) {
  FoundCheckpoint found;
  for (const char* name : kCheckpointFiles) {
    if (!fs::exists(folder / name)) continue;
    try {
      std::optional<Checkpoint> checkpoint = checkpoint_of(read_numbers(folder / name), model);
      if (!checkpoint) throw std::runtime_error((folder / name).string() + " does not fit the scene");
      if (checkpoint->states != states || checkpoint->state.time() > end) continue;
      if (found.checkpoint && found.checkpoint->state.time() > checkpoint->state.time()) continue;
      found.checkpoint = std::move(checkpoint);
    } catch (const std::runtime_error& fault) {
      found.damage += (found.damage.empty() ? "" : "; ") + std::string(fault.what());
    }
  }
  return found;
}

void remove_checkpoints(const fs::path& folder) {
  for (const char* name : kCheckpointFiles) fs::remove(folder / name);
}

}  // namespace pliant
