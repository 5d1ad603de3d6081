// CRC-32 checksums of recorded tables. A table of checksums has one row per recorded state. For each checked
// table the row has the CRC-32 of all numbers of this table, from its first number to the last of this state.
// The first CRC-32 that does not match therefore belongs to the first damaged state. The last number of a row
// is the CRC-32 of the other numbers of the row, so that damage in the checksums is not mistaken for damage
// in a table.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <pliant/io/format/column.h>
#include <pliant/io/format/npy.h>

namespace pliant {

/// Names of files, each with its CRC-32.
using Checksums = std::vector<std::pair<std::string, std::uint32_t>>;

/// Returns the CRC-32 of bytes that follow bytes with the CRC-32 `before` (0 for none).
std::uint32_t crc32_after(std::uint32_t before, const void* bytes, std::size_t size);
/// Returns the CRC-32 of all bytes of a file. Throws std::system_error if the file cannot be read.
std::uint32_t crc32_of_file(const std::filesystem::path& path);
/// Returns a CRC-32 as eight hexadecimal digits.
std::string crc32_text(std::uint32_t checksum);

/// A table whose numbers are checked.
struct CheckedTable {
  const char* file;  ///< name of the file
  bool one_row;      ///< whether each state has exactly one row; otherwise the checksums count its rows
};

/// The result of a comparison of tables with their checksums.
struct Inspection {
  std::int64_t undamaged = 0;       ///< number of states before the first damaged or missing row
  std::vector<std::string> damage;  ///< one text per damaged file, with the rows of its first damaged state
};

/// Returns the columns of a table of checksums, in order.
std::vector<Column> checksum_columns(const std::vector<CheckedTable>& tables);

/// Writes a table of checksums. Members throw std::system_error if the file cannot be written.
class ChecksumWriter {
 public:
  /// Creates a new table. Throws std::system_error if the file exists.
  static ChecksumWriter create(const std::filesystem::path& path, std::vector<CheckedTable> tables);
  /// Opens a table, and removes all rows after the first `states` rows.
  static ChecksumWriter resume(const std::filesystem::path& path, std::vector<CheckedTable> tables,
                               std::int64_t states);

  /// Adds rows of a table to its checksum. table: index of the table. count: number of all numbers in the
  /// rows.
  void add(std::size_t table, const double* numbers, std::size_t count, std::int64_t rows = 1);
  /// Appends the row of a state. All rows that were added since the last call belong to this state.
  void end_state();
  void flush() { writer_.flush(); }
  void flush_to_disk() { writer_.flush_to_disk(); }
  std::size_t pending_bytes() const { return writer_.pending_bytes(); }
  /// Returns the checksums of the tables with all rows so far.
  Checksums checksums() const;

 private:
  struct Sum {
    std::uint32_t crc = 0;
    std::int64_t rows = 0;
  };
  ChecksumWriter(NpyWriter writer, std::vector<CheckedTable> tables);

  NpyWriter writer_;
  std::vector<CheckedTable> tables_;
  std::vector<Sum> sums_;
  std::vector<double> row_;
};

/// Reads a table of checksums and compares tables with it.
class ChecksumReader {
 public:
  /// Opens the table of checksums `file` in a folder. Throws std::system_error if it cannot be read,
  /// RecordingMismatch if it is not a table of checksums of these tables.
  ChecksumReader(std::filesystem::path folder, const char* file, std::vector<CheckedTable> tables);

  /// Returns the number of states with checksums.
  std::int64_t states() const { return reader_.rows(); }
  /// Returns the number of states, from the first on, whose rows are complete in all tables.
  std::int64_t whole_states() const;
  /// Returns the number of rows that the first `states` states have in a table, given by its index. Throws
  /// RecordingMismatch if the checksums are damaged there.
  std::int64_t rows(std::size_t table, std::int64_t states) const;
  /// Returns the checksums of the tables after the first `states` states.
  Checksums checksums(std::int64_t states) const;
  /// Compares the rows of all states that the tables contain with their checksums. Rows that are missing at
  /// the end of a table are not damage.
  Inspection inspect() const;

 private:
  struct Entry {
    std::vector<std::uint32_t> crc;
    std::vector<std::int64_t> rows;
  };
  Entry entry(std::int64_t state) const;

  std::filesystem::path folder_;
  std::vector<CheckedTable> tables_;
  NpyReader reader_;
};

}  // namespace pliant
