#include "read_stl.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <string>
#include <string_view>

#include "binary_number.h"
#include "words.h"

namespace pliant {

namespace {

constexpr std::size_t kHeader = 80, kCount = 4, kTriangle = 50, kNormal = 12;
/// A header may be longer by up to this number of bytes. The size of the file then shows its length.
constexpr std::size_t kMaxHeaderShift = 256;

bool is_text(const std::string& bytes) {
  constexpr std::size_t examined = 512;
  return std::all_of(bytes.begin(),
                     bytes.begin() + static_cast<std::ptrdiff_t>(std::min(examined, bytes.size())),
                     [](char c) { return (c >= ' ' && c <= '~') || (c >= '\t' && c <= '\r'); });
}

bool same_word(std::string_view word, std::string_view lower) {
  return word.size() == lower.size() &&
         std::equal(word.begin(), word.end(), lower.begin(),
                    [](char a, char b) { return std::tolower(static_cast<unsigned char>(a)) == b; });
}

void expect(Words& words, std::string_view word) {
  if (!same_word(words.next(), word)) words.fail("the word " + std::string(word));
}

/// Reads the rest of a facet after the word facet.
void read_facet(Words& words, RawMesh& mesh) {
  expect(words, "normal");
  for (int k = 0; k < 3; ++k)
    if (words.next().empty()) words.fail("the normal of a facet");
  expect(words, "outer");
  expect(words, "loop");
  const int first = static_cast<int>(mesh.vertices.size());
  for (int corner = 0; corner < 3; ++corner) {
    expect(words, "vertex");
    Vec3<double> x;
    for (int k = 0; k < 3; ++k) x[k] = words.number(words.next(), "coordinate of a vertex");
    mesh.vertices.push_back(x);
  }
  expect(words, "endloop");
  expect(words, "endfacet");
  mesh.triangles.push_back({first, first + 1, first + 2});
}

RawMesh read_text(const MeshBytes& file) {
  RawMesh mesh;
  Words words(file);
  for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
    if (!same_word(word, "solid")) words.fail("the word solid");
    words.next_line();  // the rest of the line is a name
    for (word = words.next(); !same_word(word, "endsolid"); word = words.next()) {
      if (!same_word(word, "facet")) words.fail("the word facet or endsolid");
      if (mesh.triangles.size() >= kMaxTriangles)
        words.fail("at most " + std::to_string(kMaxTriangles) + " facets");
      read_facet(words, mesh);
    }
    if (!words.next_line()) break;
  }
  if (mesh.triangles.empty()) fail_at_byte(file, file.bytes.size(), "no facet", "one or more facets");
  return mesh;
}

std::uint64_t count_at(const MeshBytes& file, std::size_t byte) {
  return binary_number<std::uint32_t>(file.bytes.data() + byte);
}

/// Returns the number of additional bytes in the header. Adds a note for additional bytes in the header or at
/// the end of the file.
std::size_t find_shift(const MeshBytes& file, RawMesh& mesh) {
  const std::uint64_t size = file.bytes.size(),
                      needed = kHeader + kCount + kTriangle * count_at(file, kHeader);
  if (size == needed) return 0;
  for (std::size_t shift = 1; shift <= kMaxHeaderShift && kHeader + shift + kCount <= size; ++shift)
    if (size == kHeader + shift + kCount + kTriangle * count_at(file, kHeader + shift)) {
      mesh.notes.push_back("the header has " + std::to_string(kHeader + shift) + " bytes in place of 80");
      return shift;
    }
  if (size < needed || size - needed >= kTriangle)
    fail_at_byte(file, kHeader,
                 std::to_string(count_at(file, kHeader)) + " as the number of triangles of a binary STL file",
                 std::to_string((size - kHeader - kCount) / kTriangle) + ", from the " +
                     std::to_string(size) + " bytes of the file");
  mesh.notes.push_back(
      counted(size - needed, "byte after the last triangle is", "bytes after the last triangle are") +
      " ignored");
  return 0;
}

RawMesh read_binary(const MeshBytes& file) {
  if (file.bytes.size() < kHeader + kCount)
    fail_at_byte(file, file.bytes.size(), "the end of the file",
                 "a text that begins with solid, or a binary STL file of at least 84 bytes");
  RawMesh mesh;
  const std::size_t shift = find_shift(file, mesh);
  const std::size_t n = count_at(file, kHeader + shift);
  if (n == 0) fail_at_byte(file, kHeader + shift, "0 triangles", "one or more triangles");
  for (std::size_t t = 0; t < n; ++t) {
    const std::size_t corners = kHeader + shift + kCount + t * kTriangle + kNormal;
    const int first = static_cast<int>(mesh.vertices.size());
    for (std::size_t i = 0; i < 9; ++i) {
      const double x = binary_number<float>(file.bytes.data() + corners + 4 * i);
      if (!std::isfinite(x))
        fail_at_byte(file, corners + 4 * i,
                     "the coordinate " + std::to_string(x) + " in triangle " + std::to_string(t),
                     "a finite number");
      if (i % 3 == 0) mesh.vertices.emplace_back();
      mesh.vertices.back()[static_cast<Eigen::Index>(i % 3)] = x;
    }
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

}  // namespace

RawMesh read_stl(const MeshBytes& file) {
  const bool exact = file.bytes.size() >= kHeader + kCount &&
                     file.bytes.size() == kHeader + kCount + kTriangle * count_at(file, kHeader);
  return !exact && is_text(file.bytes) ? read_text(file) : read_binary(file);
}

}  // namespace pliant
