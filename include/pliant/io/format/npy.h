// Tables of doubles in NumPy's format, written row by row. The header contains the number of whole rows. It
// is rewritten in place after the rows have been written, so that a process killed at any moment leaves a
// readable file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace pliant {

/// Number of columns that denotes a vector: one number per row, shape (n,).
inline constexpr int kNpyVector = -1;

/// Returns the header of a file with this number of columns (or kNpyVector) and rows.
std::string npy_header(int columns, std::int64_t rows);

/// Writes a table. All members throw std::system_error with path and reason.
class NpyWriter {
 public:
  /// Creates a file; throws if the file exists. columns: >= 0 (shape (n, columns)) or kNpyVector.
  static NpyWriter create(const std::filesystem::path& path, int columns);
  /// Opens a file and removes all rows after the first `rows` rows. Throws std::runtime_error if the file is
  /// not a table with this number of columns or has fewer rows.
  static NpyWriter resume(const std::filesystem::path& path, int columns, std::int64_t rows);
  ~NpyWriter();
  NpyWriter(NpyWriter&& other) noexcept;
  NpyWriter& operator=(NpyWriter&&) = delete;

  /// Appends one row, with one number per column. The row stays in memory until flush().
  void append(const double* row);
  /// Writes the pending rows, then the header with the number of all rows.
  void flush();
  /// Flushes and waits until the data is on the disk. Does nothing if all data is there already.
  void flush_to_disk();

  std::int64_t rows() const { return rows_; }
  /// Returns the size of the pending rows in bytes.
  std::size_t pending_bytes() const { return pending_.size() * sizeof(double); }

 private:
  NpyWriter(std::filesystem::path path, int descriptor, int columns, std::int64_t rows);
  void write_header();

  std::filesystem::path path_;
  int descriptor_;
  int columns_;
  std::int64_t rows_, rows_in_file_;
  bool on_disk_ = false;  // whether nothing was written since the last flush_to_disk()
  std::vector<double> pending_;
};

/// Reads a table. The number of rows is fixed on opening.
class NpyReader {
 public:
  /// Opens a table. Throws std::system_error if the file cannot be read, std::runtime_error if it is not a
  /// table of doubles in row-major order.
  explicit NpyReader(std::filesystem::path path);
  ~NpyReader();
  NpyReader(NpyReader&& other) noexcept;
  NpyReader& operator=(NpyReader&&) = delete;

  /// Returns the number of whole rows: the number in the header, but at most the rows that the file contains.
  std::int64_t rows() const { return rows_; }
  /// Returns the number of columns, or kNpyVector.
  int columns() const { return columns_; }
  const std::filesystem::path& path() const { return path_; }
  /// Copies `count` rows from `row` on (0 <= row <= row + count <= rows()) to `numbers`, row after row.
  /// Throws std::out_of_range if one of these rows does not exist.
  void read(std::int64_t row, double* numbers, std::int64_t count = 1) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  int columns_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t data_ = 0;  // byte offset of the first row
};

}  // namespace pliant
