// Tables of doubles in NumPy's format, appended row by row. The header tells how many whole rows there are;
// it is rewritten in place after the rows have been, so that a process killed at any moment leaves a readable
// file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

namespace pliant {

/// Columns of a table that is a vector: one number a row, shape (n,).
inline constexpr int kNpyVector = -1;

/// Writes a table. Every member throws std::system_error with path and reason.
class NpyWriter {
 public:
  /// A new file; refuses one that exists. columns >= 0 (shape (n, columns)) or kNpyVector.
  static NpyWriter create(const std::filesystem::path& path, int columns);
  /// Goes on with a file after its first `rows` rows; what comes behind them is cut off. Throws
  /// std::runtime_error when the file is not such a table or has fewer rows.
  static NpyWriter resume(const std::filesystem::path& path, int columns, std::int64_t rows);
  ~NpyWriter();
  NpyWriter(NpyWriter&& other) noexcept;
  NpyWriter& operator=(NpyWriter&&) = delete;

  /// One row of as many numbers as there are columns; kept in memory until flush().
  void append(const double* row);
  /// Writes the rows, then the header that counts them.
  void flush();
  /// The same, and waits until they are on the disk.
  void flush_to_disk();

  std::int64_t rows() const { return rows_; }
  /// Bytes that flush() would write.
  std::size_t pending_bytes() const { return pending_.size() * sizeof(double); }

 private:
  NpyWriter(std::filesystem::path path, int descriptor, int columns, std::int64_t rows);
  void write_header();

  std::filesystem::path path_;
  int descriptor_;
  int columns_;
  std::int64_t rows_, rows_in_file_;
  std::vector<double> pending_;
};

/// Reads a table; the number of rows is fixed when it is opened.
class NpyReader {
 public:
  /// Throws std::system_error when the file cannot be read, std::runtime_error when it is not a table of
  /// doubles in rows.
  explicit NpyReader(std::filesystem::path path);
  ~NpyReader();
  NpyReader(NpyReader&& other) noexcept;
  NpyReader& operator=(NpyReader&&) = delete;

  /// Whole rows: as the header counts them, but no more than the file holds.
  std::int64_t rows() const { return rows_; }
  /// As given to NpyWriter.
  int columns() const { return columns_; }
  /// Copies rows (0 <= row <= row + count <= rows()).
  void read(std::int64_t row, double* numbers, std::int64_t count = 1) const;

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
  int columns_ = 0;
  std::int64_t rows_ = 0;
  std::int64_t data_ = 0;  // offset of the first row
};

}  // namespace pliant
