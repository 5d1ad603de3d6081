#include <pliant/io/checksums.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstdio>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <unistd.h>
#include <zlib.h>

#include <pliant/io/format/whole_file.h>
#include <pliant/io/recording.h>
#include <pliant/io/retry.h>

namespace pliant {
namespace {

std::uint32_t crc32_of_numbers(std::uint32_t before, const double* numbers, std::size_t count) {
  return crc32_after(before, numbers, count * sizeof(double));
}

/// Returns the number of numbers in a row of a table of checksums.
std::size_t row_size(const std::vector<CheckedTable>& tables) {
  std::size_t size = 1;
  for (const CheckedTable& table : tables) size += table.one_row ? 1 : 2;
  return size;
}

/// Returns a table of a recording. Throws RecordingMismatch if the file is not a table.
NpyReader open_checked(const std::filesystem::path& path) {
  try {
    return NpyReader(path);
  } catch (const std::system_error&) {
    throw;
  } catch (const std::runtime_error& fault) {
    throw RecordingMismatch(fault.what());
  }
}

std::size_t numbers_in_row(const NpyReader& table) {
  return static_cast<std::size_t>(table.columns() == kNpyVector ? 1 : table.columns());
}

}  // namespace

std::uint32_t crc32_after(std::uint32_t before, const void* bytes, std::size_t size) {
  return static_cast<std::uint32_t>(::crc32_z(before, static_cast<const Bytef*>(bytes), size));
}

std::uint32_t crc32_of_file(const std::filesystem::path& path) {
  constexpr std::size_t kBlock = std::size_t{1} << 20;  // a table may be larger than the memory
  std::vector<char> block(kBlock);
  const int file = retry([&] { return ::open(path.c_str(), O_RDONLY | O_CLOEXEC); });
  const auto fail = [&] {
    const int error = errno;
    if (file >= 0) ::close(file);
    throw std::system_error(error, std::generic_category(), "cannot read " + path.string());
  };
  if (file < 0) fail();
  std::uint32_t checksum = 0;
  for (;;) {
    const ssize_t count = retry([&] { return ::read(file, block.data(), block.size()); });
    if (count < 0) fail();
    if (count == 0) break;
    checksum = crc32_after(checksum, block.data(), static_cast<std::size_t>(count));
  }
  ::close(file);
  return checksum;
}

std::string crc32_text(std::uint32_t checksum) {
  char text[12];
  std::snprintf(text, sizeof text, "%08lx", static_cast<unsigned long>(checksum));
  return text;
}

std::vector<Column> checksum_columns(const std::vector<CheckedTable>& tables) {
  std::vector<Column> columns;
  for (const CheckedTable& table : tables) {
    const std::string name = table.file;
    columns.push_back({name + ".crc32", "1", "CRC-32 of all numbers of this table up to this state"});
    if (!table.one_row) columns.push_back({name + ".rows", "1", "number of rows up to this state"});
  }
  columns.push_back({"check", "1", "CRC-32 of the other numbers of this row"});
  return columns;
}

ChecksumWriter::ChecksumWriter(NpyWriter writer, std::vector<CheckedTable> tables)
    : writer_(std::move(writer)), tables_(std::move(tables)), sums_(tables_.size()) {}

ChecksumWriter ChecksumWriter::create(const std::filesystem::path& path, std::vector<CheckedTable> tables) {
  return {NpyWriter::create(path, static_cast<int>(row_size(tables))), std::move(tables)};
}

ChecksumWriter ChecksumWriter::resume(const std::filesystem::path& path, std::vector<CheckedTable> tables,
                                      std::int64_t states) {
  const ChecksumReader reader(path.parent_path(), path.filename().c_str(), tables);
  std::vector<Sum> sums(tables.size());
  if (states > 0) {
    const Checksums last = reader.checksums(states);
    for (std::size_t k = 0; k < sums.size(); ++k) sums[k] = {last[k].second, reader.rows(k, states)};
  }
  const auto columns = static_cast<int>(row_size(tables));
  ChecksumWriter writer(NpyWriter::resume(path, columns, states), std::move(tables));
  writer.sums_ = std::move(sums);
  return writer;
}

void ChecksumWriter::add(std::size_t table, const double* numbers, std::size_t count, std::int64_t rows) {
  sums_[table].crc = crc32_of_numbers(sums_[table].crc, numbers, count);
  sums_[table].rows += rows;
}

void ChecksumWriter::end_state() {
  row_.clear();
  for (std::size_t k = 0; k < tables_.size(); ++k) {
    row_.push_back(sums_[k].crc);
    if (!tables_[k].one_row) row_.push_back(static_cast<double>(sums_[k].rows));
  }
  row_.push_back(crc32_of_numbers(0, row_.data(), row_.size()));
  writer_.append(row_.data());
}

Checksums ChecksumWriter::checksums() const {
  Checksums all;
  for (std::size_t k = 0; k < tables_.size(); ++k) all.emplace_back(tables_[k].file, sums_[k].crc);
  return all;
}

ChecksumReader::ChecksumReader(std::filesystem::path folder, const char* file,
                               std::vector<CheckedTable> tables)
    : folder_(std::move(folder)), tables_(std::move(tables)), reader_(open_checked(folder_ / file)) {
  const std::size_t expected = row_size(tables_);
  if (reader_.columns() != static_cast<int>(expected))
    throw RecordingMismatch(reader_.path().string() + " has " + std::to_string(reader_.columns()) +
                            " columns, and this recording needs " + std::to_string(expected));
}

ChecksumReader::Entry ChecksumReader::entry(std::int64_t state) const {
  std::vector<double> row(row_size(tables_));
  reader_.read(state, row.data());
  Entry entry;
  bool good = row.back() == crc32_of_numbers(0, row.data(), row.size() - 1);
  auto whole_number = [&](double x, double below) {
    good = good && x >= 0 && x < below && x == std::floor(x);
    return good ? static_cast<std::int64_t>(x) : 0;
  };
  const double* next = row.data();
  for (const CheckedTable& table : tables_) {
    entry.crc.push_back(static_cast<std::uint32_t>(whole_number(*next++, 0x1p32)));
    entry.rows.push_back(table.one_row ? state + 1 : whole_number(*next++, 0x1p53));
  }
  if (!good)
    throw RecordingMismatch(reader_.path().string() + " is damaged at row " + std::to_string(state) +
                            ": its checksum does not match");
  return entry;
}

std::int64_t ChecksumReader::whole_states() const {
  std::int64_t states = reader_.rows();
  for (std::size_t k = 0; k < tables_.size(); ++k) {
    const std::int64_t rows = open_checked(folder_ / tables_[k].file).rows();
    while (states > 0 && entry(states - 1).rows[k] > rows) --states;
  }
  return states;
}

std::int64_t ChecksumReader::rows(std::size_t table, std::int64_t states) const {
  return states > 0 ? entry(states - 1).rows[table] : 0;
}

Checksums ChecksumReader::checksums(std::int64_t states) const {
  Checksums all;
  const std::vector<std::uint32_t> crc =
      states > 0 ? entry(states - 1).crc : std::vector<std::uint32_t>(tables_.size());
  for (std::size_t k = 0; k < tables_.size(); ++k) all.emplace_back(tables_[k].file, crc[k]);
  return all;
}

namespace {

/// Compares the rows of one table, state by state.
class RowCheck {
 public:
  explicit RowCheck(NpyReader table) : table_(std::move(table)), width_(numbers_in_row(table_)) {}

  /// Returns whether the table contains the rows up to `end`.
  bool has_rows(std::int64_t end) const { return end <= table_.rows(); }
  /// Reads the rows up to `end`, which the table contains, and compares the checksum of all rows so far with
  /// `expected`. Returns whether no row so far is damaged.
  bool add_rows(std::int64_t end, std::uint32_t expected) {
    if (!damage_.empty()) return false;
    if (end < first_) {
      damage_ = table_.path().string() +
                ": its checksums count fewer rows up to a state than up to the state before, " +
                std::to_string(first_);
      return false;
    }
    numbers_.resize(static_cast<std::size_t>(end - first_) * width_);
    table_.read(first_, numbers_.data(), end - first_);
    crc_ = crc32_of_numbers(crc_, numbers_.data(), numbers_.size());
    if (crc_ != expected)
      damage_ = table_.path().string() + " is damaged at row " + std::to_string(first_) +
                (end - first_ > 1 ? ", or between this row and row " + std::to_string(end) : "") +
                ": its checksum does not match";
    first_ = end;
    return damage_.empty();
  }
  /// Returns the first damage; empty if there is none.
  const std::string& damage() const { return damage_; }

 private:
  NpyReader table_;
  std::size_t width_;
  std::vector<double> numbers_;
  std::uint32_t crc_ = 0;
  std::int64_t first_ = 0;
  std::string damage_;
};

}  // namespace

Inspection ChecksumReader::inspect() const {
  std::vector<RowCheck> checks;
  checks.reserve(tables_.size());
  for (const CheckedTable& table : tables_) checks.emplace_back(open_checked(folder_ / table.file));
  Inspection result;
  try {
    for (std::int64_t state = 0; state < reader_.rows(); ++state) {
      const Entry expected = entry(state);
      bool contained = true, good = true;
      for (std::size_t k = 0; k < checks.size(); ++k)
        contained = contained && checks[k].has_rows(expected.rows[k]);
      if (!contained) break;
      for (std::size_t k = 0; k < checks.size(); ++k)
        good = checks[k].add_rows(expected.rows[k], expected.crc[k]) && good;
      if (good) result.undamaged = state + 1;
    }
  } catch (const RecordingMismatch& fault) {
    result.damage.emplace_back(fault.what());
  }
  for (const RowCheck& check : checks)
    if (!check.damage().empty()) result.damage.push_back(check.damage());
  return result;
}

}  // namespace pliant
