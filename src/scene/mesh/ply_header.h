// The header of a PLY file: the elements of the file and their properties.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "binary_number.h"
#include "raw_mesh.h"

namespace pliant::ply {

struct Property {
  std::string name;
  NumberType type;
  bool list = false;
  NumberType count_type = NumberType::uint8;  ///< type of the number of entries of a list
};
struct Element {
  std::string name;
  std::size_t count = 0, byte = 0;  ///< byte: place of the element in the header
  std::vector<Property> properties;
};
struct Header {
  enum class Format { text, little_endian, big_endian };
  Format format = Format::text;
  std::vector<Element> elements;
  std::size_t size = 0;  ///< bytes of the header, with the line end after end_header
};

/// Returns the header of a file. Throws std::invalid_argument, with line and column, for a header that is not
/// valid.
Header read_header(const MeshBytes& file);

}  // namespace pliant::ply
