// The binary data of a glTF file: buffers, views of buffers, and accessors, which are arrays of vectors or
// integers in a view. Buffers are embedded (GLB), base64 texts, or files in the folder of the glTF file.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include <pliant/math/types.h>

#include "binary_number.h"
#include "gltf_json.h"

namespace pliant::gltf {

class Buffers {
 public:
  /// root: the JSON document. embedded: the binary chunk of a GLB file; may be empty. folder: the folder of
  /// the glTF file.
  Buffers(Value root, std::string embedded, std::filesystem::path folder)
      : root_(std::move(root)), embedded_(std::move(embedded)), folder_(std::move(folder)) {}

  /// Return the vectors (type VEC3, finite) or integers (type SCALAR, below `limit`) of an accessor. user:
  /// the JSON number that selects the accessor; messages name its place. vectors() and integers() throw
  /// std::invalid_argument with the place of a fault, and FileError for a buffer file that cannot be read.
  std::vector<Vec3<double>> vectors(const Value& user);
  std::vector<std::size_t> integers(const Value& user, std::size_t limit);

 private:
  /// The data of an accessor: `count` vectors or integers, one every `stride` bytes. Their components are
  /// numbers of type `component_type`.
  struct Array {
    const char* data;
    std::size_t count, stride;
    NumberType component_type;
    bool normalized;
  };
  Array array(const Value& user, const char* type, std::size_t components);
  const std::string& buffer(std::size_t number, const Value& user);
  std::string load(const Value& buffer, std::size_t number);

  Value root_;
  std::string embedded_;
  std::filesystem::path folder_;
  std::map<std::size_t, std::string> loaded_;
  std::size_t total_ = 0;
};

}  // namespace pliant::gltf
