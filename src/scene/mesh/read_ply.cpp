#include "read_ply.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "binary_number.h"
#include "ply_header.h"
#include "polygons.h"
#include "words.h"

namespace pliant {

namespace ply {

namespace {

/// The largest number of additional bytes between the header and the data of a binary file that the reader
/// can skip. Some programs pad the header, for example to a multiple of 64 bytes. The lengths of lists are in
/// the data, so that the reader must try each place. Reading from a wrong place usually fails soon: at a
/// number that is not finite, an impossible length of a list, or an impossible vertex number. Otherwise the
/// reading ends before the end of the file.
constexpr std::size_t kMaxDataShift = 64;

/// The values of a text file, one after the other.
class TextValues {
 public:
  TextValues(const MeshBytes& file, const Header& header, std::size_t) : words_(file, header.size) {}
  double number(NumberType type, const char* meaning) {
    return is_integer(type) ? static_cast<double>(integer(type, meaning))
                            : words_.number(words_.next(), meaning);
  }
  long long integer(NumberType, const char* meaning) {
    return words_.integer(words_.next(), std::numeric_limits<std::int32_t>::min(),
                          std::numeric_limits<std::uint32_t>::max(), meaning);
  }
  void skip(NumberType) {
    if (words_.next().empty()) words_.fail("a value of a property");
  }
  /// Smallest number of bytes of a value with the blank after it.
  static std::size_t least_size(NumberType) { return 2; }
  /// Number of bytes that are left, plus 1, because no blank follows the last value.
  std::size_t remaining() const { return words_.remaining() + 1; }
  [[noreturn]] void fail(const std::string&, const std::string& expected) { words_.fail(expected); }
  /// Returns the number of bytes from the next word to the end of the file; 0 if only blanks and line ends
  /// follow the last value.
  std::size_t left_over() {
    const std::size_t word = words_.next().size();
    return word == 0 ? 0 : word + words_.remaining();
  }

 private:
  Words words_;
};

/// The values of a binary file, one after the other.
class BinaryValues {
 public:
  BinaryValues(const MeshBytes& file, const Header& header, std::size_t shift)
      : file_(file), at_(header.size + shift), little_(header.format == Header::Format::little_endian) {}
  double number(NumberType type, const char* meaning) {
    const double value = next(type, meaning);
    if (!std::isfinite(value)) fail(std::to_string(value), std::string(meaning) + ", a finite number");
    return value;
  }
  long long integer(NumberType type, const char* meaning) {
    return static_cast<long long>(number(type, meaning));
  }
  void skip(NumberType type) { next(type, "a value of a property"); }
  static std::size_t least_size(NumberType type) { return size_of(type); }
  std::size_t remaining() const { return at_ < file_.bytes.size() ? file_.bytes.size() - at_ : 0; }
  [[noreturn]] void fail(const std::string& found, const std::string& expected) {
    fail_at_byte(file_, last_, found, expected);
  }
  std::size_t left_over() const { return remaining(); }

 private:
  double next(NumberType type, const char* meaning) {
    last_ = at_;
    if (remaining() < size_of(type)) fail("the end of the file", meaning);
    const char* from = file_.bytes.data() + at_;
    at_ += size_of(type);
    return binary_number(type, from, little_);
  }

  const MeshBytes& file_;
  std::size_t at_, last_ = 0;
  bool little_;
};

template <class Values>
class PlyReader {
 public:
  PlyReader(const MeshBytes& file, const Header& header, std::size_t shift)
      : file_(file), header_(header), values_(file, header, shift) {}

  RawMesh read() {
    for (const Element& element : header_.elements)
      if (element.name == "vertex") n_vertices_ = element.count;
    for (const Element& element : header_.elements) {
      check_size(element);
      if (element.name == "vertex")
        read_vertices(element);
      else if (element.name == "face")
        read_faces(element);
      else
        skip(element);
    }
    if (faces_.sizes.empty())
      fail_at_byte(file_, header_.size, "no face", "one or more faces with three corners");
    add_polygons(faces_, file_.name, mesh_);
    if (loose_ > 0)
      mesh_.notes.push_back(counted(loose_, "line or point is", "lines and points are") + " ignored");
    left_over_ = values_.left_over();
    if (left_over_ > 0)
      mesh_.notes.push_back(
          counted(left_over_, "byte after the last element is", "bytes after the last element are") +
          " ignored");
    return std::move(mesh_);
  }
  std::size_t left_over() const { return left_over_; }

 private:
  /// Refuses an element that needs more bytes than the rest of the file has, before any of its values is
  /// stored.
  void check_size(const Element& element) const {
    std::size_t least = 0;
    for (const Property& p : element.properties) least += Values::least_size(p.list ? p.count_type : p.type);
    if (least > 0 && element.count > values_.remaining() / least)
      fail_at_byte(file_, element.byte, std::to_string(element.count) + " elements \"" + element.name + "\"",
                   "at most " + std::to_string(values_.remaining() / least) +
                       ", as many as fit in the rest of the file");
  }

  std::size_t place(const Element& element, std::initializer_list<const char*> names, bool list) const {
    for (std::size_t k = 0; k < element.properties.size(); ++k)
      for (const char* name : names)
        if (element.properties[k].name == name && element.properties[k].list == list) return k;
    fail_at_byte(file_, element.byte, "an element \"" + element.name + "\" without a required property",
                 std::string(list ? "a property list " : "a property ") + *names.begin());
  }

  long long length(const Property& list) {
    const long long n = values_.integer(list.count_type, "the length of a list");
    if (n < 0 || static_cast<unsigned long long>(n) > values_.remaining() / Values::least_size(list.type))
      values_.fail("a list of " + std::to_string(n) + " entries",
                   "the length of a list that fits in the file");
    return n;
  }

  void skip(const Property& property) {
    // Colours and other values that are not used may also be infinite or not a number.
    if (!property.list) return values_.skip(property.type);
    for (long long left = length(property); left > 0; --left) values_.skip(property.type);
  }
  void skip(const Element& element) {
    if (element.properties.empty()) return;
    if (element.name == "edge") loose_ += element.count;
    if (element.name == "tristrips")
      fail_at_byte(file_, element.byte, "triangle strips", "faces (element face)");
    for (std::size_t i = 0; i < element.count; ++i)
      for (const Property& p : element.properties) skip(p);
  }

  void read_vertices(const Element& element) {
    const std::size_t axes[] = {place(element, {"x"}, false), place(element, {"y"}, false),
                                place(element, {"z"}, false)};
    if (element.count > static_cast<std::size_t>(std::numeric_limits<int>::max()))
      fail_at_byte(file_, element.byte, std::to_string(element.count) + " vertices",
                   "at most 2147483647 vertices");
    for (std::size_t i = 0; i < element.count; ++i) {
      Vec3<double> x;
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        const auto* const axis = std::find(std::begin(axes), std::end(axes), k);
        if (axis == std::end(axes))
          skip(element.properties[k]);
        else
          x[axis - axes] = values_.number(element.properties[k].type, "coordinate of a vertex");
      }
      mesh_.vertices.push_back(x);
    }
  }

  void read_faces(const Element& element) {
    const std::size_t corners = place(element, {"vertex_indices", "vertex_index"}, true);
    if (!is_integer(element.properties[corners].type))
      fail_at_byte(file_, element.byte, "vertex_indices that are not integers", "an integer type");
    for (std::size_t i = 0; i < element.count; ++i)
      for (std::size_t k = 0; k < element.properties.size(); ++k) {
        if (k == corners)
          read_corners(element.properties[k]);
        else
          skip(element.properties[k]);
      }
  }

  void read_corners(const Property& list) {
    const long long n = length(list);
    for (long long k = 0; k < n; ++k) {
      const long long vertex = values_.integer(list.type, "number of a vertex");
      if (vertex < 0 || static_cast<unsigned long long>(vertex) >= n_vertices_)
        values_.fail(std::to_string(vertex), "the number of a vertex, below " + std::to_string(n_vertices_));
      faces_.corners.push_back(static_cast<int>(vertex));
    }
    if (n >= 3) {
      faces_.sizes.push_back(static_cast<int>(n));
      return;
    }
    ++loose_;
    faces_.corners.resize(faces_.corners.size() - static_cast<std::size_t>(n));
  }

  const MeshBytes& file_;
  const Header& header_;
  Values values_;
  RawMesh mesh_;
  Polygons faces_;
  std::size_t n_vertices_ = 0, loose_ = 0, left_over_ = 0;
};

/// Reads a binary file. If its data cannot begin directly after the header, looks for a place at most
/// kMaxDataShift bytes later from which the data fill the file.
RawMesh read_binary(const MeshBytes& file, const Header& header) {
  try {
    return PlyReader<BinaryValues>(file, header, 0).read();
  } catch (const std::invalid_argument&) {
    for (std::size_t shift = 1; shift <= kMaxDataShift && header.size + shift < file.bytes.size(); ++shift) {
      try {
        PlyReader<BinaryValues> shifted(file, header, shift);
        RawMesh mesh = shifted.read();
        if (shifted.left_over() > 0) continue;
        mesh.notes.push_back(
            counted(shift, "byte between header and data is", "bytes between header and data are") +
            " ignored");
        return mesh;
      } catch (const std::invalid_argument&) {
        continue;  // the data do not begin here
      }
    }
    throw;
  }
}

RawMesh read_any(const MeshBytes& file) {
  const Header header = read_header(file);
  return header.format == Header::Format::text ? PlyReader<TextValues>(file, header, 0).read()
                                               : read_binary(file, header);
}

}  // namespace

}  // namespace ply

RawMesh read_ply(const MeshBytes& file) {
  return ply::read_any(file);
}

}  // namespace pliant
