// NumPy tables are read back unchanged, resumed after a truncation, and refused if they are damaged.
// I50, I51, I53 and I55 in names of tests are rows of the table in tests/README.md.
#include <pliant/io/format/npy.h>

#include <cmath>
#include <limits>
#include <system_error>

#include "catch.h"
#include "new_folder.h"

#include <pliant/io/format/whole_file.h>

namespace npy_test {

using namespace pliant;
namespace fs = std::filesystem;

namespace {

/// Appends the rows with the numbers from `from` to `to` - 1. Their values depend on the row and the column.
void append_rows(NpyWriter& writer, int columns, int from, int to) {
  std::vector<double> row(static_cast<std::size_t>(columns == kNpyVector ? 1 : columns));
  for (int i = from; i < to; ++i) {
    for (std::size_t k = 0; k < row.size(); ++k) row[k] = std::sqrt(i + 0.1 * static_cast<double>(k));
    writer.append(row.data());
  }
}

}  // namespace

TEST_CASE("a table is read back bit for bit as it was written") {
  const NewFolder folder;
  for (const int columns : {kNpyVector, 0, 1, 7}) {
    const fs::path file = folder / ("t" + std::to_string(columns) + ".npy");
    {
      NpyWriter writer = NpyWriter::create(file, columns);
      append_rows(writer, columns, 0, 10);
      writer.flush();
      append_rows(writer, columns, 10, 25);
      writer.flush_to_disk();
      writer.flush();
      CHECK(writer.rows() == 25);
    }
    const NpyReader reader(file);
    REQUIRE(reader.rows() == 25);
    REQUIRE(reader.columns() == columns);
    if (columns == 0) continue;
    std::vector<double> row(static_cast<std::size_t>(columns == kNpyVector ? 1 : columns));
    for (int i = 0; i < 25; ++i) {
      reader.read(i, row.data());
      for (std::size_t k = 0; k < row.size(); ++k)
        CHECK(row[k] == std::sqrt(i + 0.1 * static_cast<double>(k)));
    }
    CHECK_THROWS_AS(reader.read(25, row.data()), std::out_of_range);
    CHECK_THROWS_AS(reader.read(-1, row.data()), std::out_of_range);
  }
}

TEST_CASE("the header has the format of NumPy") {
  const NewFolder folder;
  {
    NpyWriter writer = NpyWriter::create(folder / "q.npy", 3);
    append_rows(writer, 3, 0, 4);
    writer.flush();
  }
  const std::string bytes = bytes_of(folder / "q.npy");
  REQUIRE(bytes.size() == 128 + 4 * 3 * 8);
  CHECK(bytes.substr(0, 6) == "\x93NUMPY");
  CHECK(bytes.substr(10, 60) == "{'descr': '<f8', 'fortran_order': False, 'shape': (4, 3), } ");
  CHECK(bytes[127] == '\n');
}

TEST_CASE("I53: rows that were not flushed, and partial rows, are ignored") {
  const NewFolder folder;
  const fs::path file = folder / "v.npy";
  NpyWriter writer = NpyWriter::create(file, 2);
  append_rows(writer, 2, 0, 5);
  writer.flush();
  append_rows(writer, 2, 5, 9);
  CHECK(NpyReader(file).rows() == 5);
  const std::string whole = bytes_of(file);
  // A writer that is killed leaves this file: it has written rows, but not their number in the header.
  set_bytes(file, whole + std::string(100, 'x'));
  CHECK(NpyReader(file).rows() == 5);
  for (std::size_t cut = 128; cut <= whole.size(); ++cut) {
    set_bytes(file, whole.substr(0, cut));
    CHECK(NpyReader(file).rows() == static_cast<std::int64_t>((cut - 128) / 16));
  }
  for (const std::size_t cut : {0, 5, 9, 50, 127}) {
    set_bytes(file, whole.substr(0, cut));
    CHECK_THROWS_AS(NpyReader(file), std::runtime_error);
  }
}

TEST_CASE("a resumed table drops the rows after the resume position") {
  const NewFolder folder;
  const fs::path file = folder / "v.npy", unbroken = folder / "u.npy";
  {
    NpyWriter writer = NpyWriter::create(file, 2);
    append_rows(writer, 2, 0, 8);
    writer.flush();
  }
  {
    NpyWriter writer = NpyWriter::resume(file, 2, 5);
    append_rows(writer, 2, 5, 12);
    writer.flush();
    NpyWriter other = NpyWriter::create(unbroken, 2);
    append_rows(other, 2, 0, 12);
    other.flush();
  }
  CHECK(bytes_of(file) == bytes_of(unbroken));
  CHECK_THROWS_AS(NpyWriter::resume(file, 2, 13), std::runtime_error);
  CHECK_THROWS_AS(NpyWriter::resume(file, 3, 5), std::runtime_error);
}

TEST_CASE("I55: damaged headers are refused") {
  const NewFolder folder;
  const fs::path file = folder / "v.npy";
  {
    NpyWriter writer = NpyWriter::create(file, 2);
    append_rows(writer, 2, 0, 8);
    writer.flush();
  }
  const std::string whole = bytes_of(file);
  const auto with = [&](const std::string& what, const std::string& other) {
    std::string bytes = whole;
    bytes.replace(bytes.find(what), what.size(), other);
    set_bytes(file, bytes);
    CHECK_THROWS_AS(NpyReader(file), std::runtime_error);
  };
  with("NUMPY", "NUMPX");
  with("<f8", "<f4");
  with("False", "True ");
  with("'shape'", "'shapx'");
  with("(8, 2), }", "(8,2,2),}");
  with("(8, 2), }", "(), }    ");
  with(", 2), }", std::string(", 99999999999999999999999), }").substr(0, 7));
  CHECK_THROWS_AS(NpyReader(folder / "absent.npy"), std::system_error);
}

TEST_CASE("I50: a new table does not overwrite an existing file or the target of a link") {
  const NewFolder folder;
  set_bytes(folder / "precious", "data");
  fs::create_symlink(folder / "precious", folder / "t.npy");
  CHECK_THROWS_AS(NpyWriter::create(folder / "t.npy", 1), std::system_error);
  CHECK_THROWS_AS(NpyWriter::create(folder / "precious", 1), std::system_error);
  CHECK(bytes_of(folder / "precious") == "data");
}

TEST_CASE("I51: a file that cannot be created is reported") {
  if (!fs::exists("/dev/full")) return;
  const NewFolder folder;
  fs::create_symlink("/dev/full", folder / "full");
  CHECK_THROWS_AS(NpyWriter::create(folder / "full", 1), std::system_error);
  CHECK_THROWS_AS(WholeFile("/dev/full/file"), std::system_error);
}

TEST_CASE("a new file replaces a link, and an abandoned file is removed") {
  const NewFolder folder;
  set_bytes(folder / "precious", "data");
  fs::create_symlink(folder / "precious", folder / "out.txt");
  write_whole_file(folder / "out.txt", "new", 3, Durable::yes);
  CHECK(bytes_of(folder / "precious") == "data");
  CHECK(bytes_of(folder / "out.txt") == "new");
  CHECK_FALSE(fs::is_symlink(folder / "out.txt"));
  {
    WholeFile given_up(folder / "never.txt");
    given_up.write("half");
  }
  CHECK(std::distance(fs::directory_iterator(folder.path), fs::directory_iterator()) == 2);
}

}  // namespace npy_test
