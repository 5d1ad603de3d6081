// NumPy's format 1.0: a magic number, the version, the length of the header, and a Python dictionary, padded
// with blanks to a multiple of 64 bytes. The header always has kHeader bytes, so that the number of rows can
// be rewritten in place.
#include <pliant/io/format/npy.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <pliant/io/file_fault.h>

#include <pliant/io/retry.h>

namespace pliant {
namespace {

constexpr std::size_t kHeader = 128;
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
constexpr const char* kType = "<f8";
#else
constexpr const char* kType = ">f8";
#endif

std::size_t row_bytes(int columns) {
  return sizeof(double) * static_cast<std::size_t>(columns == kNpyVector ? 1 : columns);
}

void write_at(int descriptor, const void* bytes, std::size_t size, std::int64_t offset,
              const std::filesystem::path& path) {
  const char* next = static_cast<const char*>(bytes);
  while (size > 0) {
    const ssize_t written = retry([&] { return ::pwrite(descriptor, next, size, offset); });
    if (written < 0) throw_file_fault(errno, "write", path, size);
    next += written;
    offset += written;
    size -= static_cast<std::size_t>(written);
  }
}

// Returns the number of bytes read; it is less than size only at the end of the file.
std::size_t read_at(int descriptor, void* bytes, std::size_t size, std::int64_t offset,
                    const std::filesystem::path& path) {
  std::size_t done = 0;
  while (done < size) {
    const ssize_t count = retry([&] {
      return ::pread(descriptor, static_cast<char*>(bytes) + done, size - done,
                     offset + static_cast<std::int64_t>(done));
    });
    if (count < 0) throw_file_fault(errno, "read", path);
    if (count == 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& why) {
  throw std::runtime_error(path.string() + " is not a table of a recording: " + why);
}

// Returns the integers of 'shape': (...) in a header.
std::vector<std::int64_t> parse_shape(const std::string& header, const std::filesystem::path& path) {
  const std::size_t key = header.find("'shape'");
  const std::size_t open = key == std::string::npos ? key : header.find('(', key);
  const std::size_t close = open == std::string::npos ? open : header.find(')', open);
  if (close == std::string::npos) refuse(path, "its header has no shape");
  std::vector<std::int64_t> shape;
  std::int64_t number = -1;
  for (std::size_t i = open + 1; i <= close; ++i) {
    const char c = header[i];
    if (std::isdigit(static_cast<unsigned char>(c)) != 0) {
      if (number > std::int64_t{1} << 50) refuse(path, "its header has an impossible shape");
      number = std::max<std::int64_t>(number, 0) * 10 + (c - '0');
    } else {
      if (number >= 0) shape.push_back(number);
      number = -1;
    }
  }
  return shape;
}

}  // namespace

NpyWriter::NpyWriter(std::filesystem::path path, int descriptor, int columns, std::int64_t rows)
    : path_(std::move(path)), descriptor_(descriptor), columns_(columns), rows_(rows), rows_in_file_(rows) {}

NpyWriter::NpyWriter(NpyWriter&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      columns_(other.columns_),
      rows_(other.rows_),
      rows_in_file_(other.rows_in_file_),
      on_disk_(other.on_disk_),
      pending_(std::move(other.pending_)) {}

NpyWriter::~NpyWriter() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

NpyWriter NpyWriter::create(const std::filesystem::path& path, int columns) {
  const int descriptor =
      retry([&] { return ::open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0666); });
  if (descriptor < 0) throw_file_fault(errno, "create", path);
  NpyWriter writer(path, descriptor, columns, 0);
  writer.write_header();
  return writer;
}

NpyWriter NpyWriter::resume(const std::filesystem::path& path, int columns, std::int64_t rows) {
  {
    const NpyReader reader(path);
    if (reader.columns() != columns)
      refuse(path, std::to_string(reader.columns()) + " columns, expected " + std::to_string(columns));
    if (reader.rows() < rows)
      refuse(path, std::to_string(reader.rows()) + " rows, expected " + std::to_string(rows));
  }
  const int descriptor = retry([&] { return ::open(path.c_str(), O_RDWR | O_NOFOLLOW | O_CLOEXEC); });
  if (descriptor < 0) throw_file_fault(errno, "write", path);
  NpyWriter writer(path, descriptor, columns, rows);
  writer.write_header();
  const auto size = static_cast<off_t>(kHeader + row_bytes(columns) * static_cast<std::size_t>(rows));
  if (retry([&] { return ::ftruncate(descriptor, size); }) != 0) throw_file_fault(errno, "truncate", path);
  return writer;
}

std::string npy_header(int columns, std::int64_t rows) {
  std::string header = "\x93NUMPY";
  header += {'\x01', '\x00', static_cast<char>(kHeader - 10), '\x00'};
  header += std::string("{'descr': '") + kType + "', 'fortran_order': False, 'shape': (" +
            std::to_string(rows) + ",";
  if (columns != kNpyVector) header += " " + std::to_string(columns);
  header += "), }";
  header.resize(kHeader - 1, ' ');
  header += '\n';
  return header;
}

void NpyWriter::write_header() {
  const std::string header = npy_header(columns_, rows_);
  write_at(descriptor_, header.data(), header.size(), 0, path_);
  rows_in_file_ = rows_;
  on_disk_ = false;
}

void NpyWriter::append(const double* row) {
  pending_.insert(pending_.end(), row, row + row_bytes(columns_) / sizeof(double));
  ++rows_;
}

void NpyWriter::flush() {
  if (rows_ == rows_in_file_) return;
  const auto offset =
      static_cast<std::int64_t>(kHeader + row_bytes(columns_) * static_cast<std::size_t>(rows_in_file_));
  write_at(descriptor_, pending_.data(), pending_bytes(), offset, path_);
  write_header();
  pending_ = {};  // also frees the memory, which is large for many parts
}

void NpyWriter::flush_to_disk() {
  flush();
  if (on_disk_) return;
  if (retry([&] { return ::fsync(descriptor_); }) != 0) throw_file_fault(errno, "write", path_);
  on_disk_ = true;
}

NpyReader::NpyReader(std::filesystem::path path) : path_(std::move(path)) {
  descriptor_ = retry([&] { return ::open(path_.c_str(), O_RDONLY | O_CLOEXEC); });
  if (descriptor_ < 0) throw_file_fault(errno, "read", path_);
  try {
    struct stat status {};
    if (::fstat(descriptor_, &status) != 0) throw_file_fault(errno, "read", path_);
    char start[10];
    if (read_at(descriptor_, start, sizeof start, 0, path_) != sizeof start ||
        std::memcmp(start, "\x93NUMPY", 6) != 0)
      refuse(path_, "it does not begin as a NumPy file");
    if (start[6] != 1) refuse(path_, "it has another version of NumPy's format");
    const std::size_t length =
        static_cast<unsigned char>(start[8]) + std::size_t{256} * static_cast<unsigned char>(start[9]);
    std::string header(length, '\0');
    if (read_at(descriptor_, header.data(), length, sizeof start, path_) != length)
      refuse(path_, "its header is truncated");
    if (header.find(std::string("'descr': '") + kType + "'") == std::string::npos)
      refuse(path_, "it does not contain doubles in the byte order of this machine");
    if (header.find("'fortran_order': False") == std::string::npos)
      refuse(path_, "it is not in row-major order");
    const std::vector<std::int64_t> shape = parse_shape(header, path_);
    if (shape.empty() || shape.size() > 2)
      refuse(path_, "it has " + std::to_string(shape.size()) + " dimensions");
    if (shape.size() == 2 && shape[1] > 1 << 28) refuse(path_, "its header has an impossible shape");
    columns_ = shape.size() == 1 ? kNpyVector : static_cast<int>(shape[1]);
    data_ = static_cast<std::int64_t>(sizeof start + length);
    rows_ = shape[0];
    const auto bytes = static_cast<std::int64_t>(row_bytes(columns_));
    if (bytes > 0) rows_ = std::min(rows_, std::max<std::int64_t>(0, (status.st_size - data_) / bytes));
  } catch (...) {
    ::close(descriptor_);
    throw;
  }
}

NpyReader::NpyReader(NpyReader&& other) noexcept
    : path_(std::move(other.path_)),
      descriptor_(std::exchange(other.descriptor_, -1)),
      columns_(other.columns_),
      rows_(other.rows_),
      data_(other.data_) {}

NpyReader::~NpyReader() {
  if (descriptor_ >= 0) ::close(descriptor_);
}

void NpyReader::read(std::int64_t row, double* numbers, std::int64_t count) const {
  if (row < 0 || count < 0 || row > rows_ - count)
    throw std::out_of_range(path_.string() + " has no row " +
                            std::to_string(row < 0 ? row : row + count - 1));
  const auto row_size = static_cast<std::int64_t>(row_bytes(columns_));
  const auto bytes = static_cast<std::size_t>(count * row_size);
  if (read_at(descriptor_, numbers, bytes, data_ + row * row_size, path_) != bytes)
    refuse(path_, "row " + std::to_string(row + count - 1) + " is truncated");
}

}  // namespace pliant
