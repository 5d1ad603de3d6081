#include "ply_header.h"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

#include "words.h"

namespace pliant::ply {

namespace {

struct TypeName {
  std::string_view name;
  NumberType type;
};
constexpr TypeName kTypes[] = {
    {"char", NumberType::int8},      {"int8", NumberType::int8},       {"uchar", NumberType::uint8},
    {"uint8", NumberType::uint8},    {"short", NumberType::int16},     {"int16", NumberType::int16},
    {"ushort", NumberType::uint16},  {"uint16", NumberType::uint16},   {"int", NumberType::int32},
    {"int32", NumberType::int32},    {"uint", NumberType::uint32},     {"uint32", NumberType::uint32},
    {"float", NumberType::float32},  {"float32", NumberType::float32}, {"double", NumberType::float64},
    {"float64", NumberType::float64}};

NumberType type_of(Words& words, std::string_view word) {
  const auto* const known =
      std::find_if(std::begin(kTypes), std::end(kTypes), [&](const TypeName& t) { return t.name == word; });
  if (known == std::end(kTypes)) words.fail("a type: char, uchar, short, ushort, int, uint, float or double");
  return known->type;
}

Header::Format read_format(Words& words) {
  constexpr std::pair<std::string_view, Header::Format> formats[] = {
      {"ascii", Header::Format::text},
      {"binary_little_endian", Header::Format::little_endian},
      {"binary_big_endian", Header::Format::big_endian}};
  const std::string_view word = words.on_line();
  for (const auto& [name, format] : formats)
    if (word == name) {
      if (words.on_line() != "1.0") words.fail("version 1.0");
      return format;
    }
  words.fail("ascii, binary_little_endian or binary_big_endian");
}

Property read_property(Words& words) {
  Property property;
  std::string_view word = words.on_line();
  property.list = word == "list";
  if (property.list) {
    property.count_type = type_of(words, words.on_line());
    if (!is_integer(property.count_type)) words.fail("an integer type for the length of a list");
    word = words.on_line();
  }
  property.type = type_of(words, word);
  property.name = words.on_line();
  if (property.name.empty()) words.fail("the name of a property");
  return property;
}

}  // namespace

Header read_header(const MeshBytes& file) {
  Words words(file);
  Header header;
  bool has_format = false;
  if (words.on_line() != "ply") words.fail("the word ply at the beginning of a PLY file");
  for (;;) {
    if (!words.next_line())
      fail_at_byte(file, file.bytes.size(), "the end of the file", "the line end_header");
    const std::string_view key = words.on_line();
    if (key == "format") {
      header.format = read_format(words);
      has_format = true;
    } else if (key == "element") {
      Element element;
      element.name = words.on_line();
      element.byte = words.position() - element.name.size();
      element.count = static_cast<std::size_t>(words.integer(
          words.on_line(), 0, std::numeric_limits<long long>::max(), "the number of elements of this kind"));
      for (const Element& other : header.elements)
        if (other.name == element.name)
          words.fail("each element only once, not a second element " + element.name);
      header.elements.push_back(element);
    } else if (key == "property") {
      if (header.elements.empty()) words.fail("a line that starts with element before the first property");
      header.elements.back().properties.push_back(read_property(words));
    } else if (key == "end_header") {
      break;
    } else if (key != "comment" && key != "obj_info" && !key.empty()) {
      words.fail("format, element, property, comment, obj_info or end_header");
    }
  }
  if (!has_format) words.fail("a line that starts with format in the header");
  header.size = std::min(file.bytes.size(), file.bytes.find('\n', words.position()));
  if (header.size < file.bytes.size()) ++header.size;
  return header;
}

}  // namespace pliant::ply
