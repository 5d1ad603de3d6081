#include "gltf_buffers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "binary_number.h"
#include "mesh_bytes.h"
#include "words.h"

namespace pliant::gltf {

namespace {

constexpr std::size_t kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123,
                      kUnsignedInt = 5125, kFloat = 5126;
constexpr std::size_t kMaxInteger = std::numeric_limits<std::int32_t>::max();

NumberType number_type(std::size_t type, const Value& at) {
  switch (type) {
    case kByte:
      return NumberType::int8;
    case kUnsignedByte:
      return NumberType::uint8;
    case kShort:
      return NumberType::int16;
    case kUnsignedShort:
      return NumberType::uint16;
    case kUnsignedInt:
      return NumberType::uint32;
    case kFloat:
      return NumberType::float32;
    default:
      break;
  }
  at.fail(std::to_string(type), "a component type of glTF: 5120, 5121, 5122, 5123, 5125 or 5126");
}

/// Returns a number of a component type. A normalized integer of one or two bytes is a fraction of
/// its largest value, at least -1.
double component(const char* from, NumberType type, bool normalized) {
  const double number = binary_number(type, from);
  if (!normalized || size_of(type) > 2) return number;
  const bool is_signed = type == NumberType::int8 || type == NumberType::int16;
  const double bits = 8 * static_cast<double>(size_of(type)) - (is_signed ? 1 : 0);
  return std::max(number / (std::exp2(bits) - 1), -1.0);
}

/// Returns the bytes of a base64 text (RFC 4648).
std::string decode_base64(std::string_view text, const Value& at) {
  static const std::array<int, 256> values = [] {
    constexpr std::string_view digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    std::array<int, 256> all;
    all.fill(-1);
    for (std::size_t k = 0; k < digits.size(); ++k)
      all[static_cast<unsigned char>(digits[k])] = static_cast<int>(k);
    return all;
  }();
  while (!text.empty() && text.back() == '=') text.remove_suffix(1);
  std::string bytes;
  bytes.reserve(text.size() / 4 * 3 + 3);
  unsigned bits = 0;
  int n_bits = 0;
  for (const char c : text) {
    const int digit = values[static_cast<unsigned char>(c)];
    if (digit < 0) at.fail("a character that is not base64", "base64 data");
    bits = (bits << 6) | static_cast<unsigned>(digit);
    n_bits += 6;
    if (n_bits < 8) continue;
    n_bits -= 8;
    bytes.push_back(static_cast<char>((bits >> n_bits) & 0xff));
  }
  return bytes;
}

/// Returns a relative URI as a path: %20 becomes a blank.
std::string decode_percent(const std::string& uri) {
  const auto hex = [](char c) {
    return c >= '0' && c <= '9'   ? c - '0'
           : c >= 'a' && c <= 'f' ? c - 'a' + 10
           : c >= 'A' && c <= 'F' ? c - 'A' + 10
                                  : -1;
  };
  std::string path;
  for (std::size_t k = 0; k < uri.size(); ++k) {
    const int high = uri[k] == '%' && k + 2 < uri.size() ? hex(uri[k + 1]) : -1;
    const int low = high >= 0 ? hex(uri[k + 2]) : -1;
    path.push_back(low >= 0 ? static_cast<char>(16 * high + low) : uri[k]);
    if (low >= 0) k += 2;
  }
  return path;
}

}  // namespace

std::string Buffers::load(const Value& buffer, std::size_t number) {
  const Value uri = buffer["uri"];
  if (!uri.exists()) {
    if (number != 0 || embedded_.empty())
      buffer.fail("a buffer without uri", "a uri, or the data of a GLB file");
    return embedded_;
  }
  const std::string& text = uri.text();
  if (text.compare(0, 5, "data:") == 0) {
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos || text.find(";base64") > comma)
      uri.fail("other data", "data:...;base64,...");
    return decode_base64(std::string_view(text).substr(comma + 1), uri);
  }
  const std::filesystem::path file = decode_percent(text);
  if (text.find(':') != std::string::npos || file.is_absolute() ||
      std::find(file.begin(), file.end(), "..") != file.end())
    uri.fail(quoted_word(text), "the name of a file in the folder of this file, or data:...;base64,...");
  return read_mesh_bytes(folder_ / file);
}

const std::string& Buffers::buffer(std::size_t number, const Value& user) {
  const auto known = loaded_.find(number);
  if (known != loaded_.end()) return known->second;
  const Value buffers = root_["buffers"];
  if (number >= buffers.size())
    user.fail(std::to_string(number), "the number of a buffer, below " + std::to_string(buffers.size()));
  const Value described = buffers[number];
  std::string bytes = load(described, number);
  total_ += bytes.size();
  if (total_ > kMaxMeshBytes)
    described.fail("buffers of " + std::to_string(total_) + " bytes",
                   "at most " + std::to_string(kMaxMeshBytes));
  const std::size_t length = described["byteLength"].integer(kMaxMeshBytes);
  if (length > bytes.size())
    described.fail("data of " + std::to_string(bytes.size()) + " bytes",
                   std::to_string(length) + " bytes, the byteLength");
  bytes.resize(length);
  return loaded_.emplace(number, std::move(bytes)).first->second;
}

Buffers::Array Buffers::array(const Value& user, const char* type, std::size_t components) {
  const Value accessors = root_["accessors"], views = root_["bufferViews"];
  if (accessors.size() == 0) user.fail("the number of an accessor", "a file with accessors");
  const Value accessor = accessors[user.integer(accessors.size() - 1)];
  if (accessor["sparse"].exists()) accessor.fail("a sparse accessor", "an accessor that is not sparse");
  if (accessor["type"].text() != type) accessor["type"].fail(quoted_word(accessor["type"].text()), type);
  if (views.size() == 0 || !accessor["bufferView"].exists())
    accessor.fail("no bufferView", "an accessor with data");
  const Value view = views[accessor["bufferView"].integer(views.size() - 1)];
  const Value component_type = accessor["componentType"];
  Array found{nullptr, accessor["count"].integer(kMaxInteger), 0,
              number_type(component_type.integer(kMaxInteger), component_type),
              accessor["normalized"].exists() && accessor["normalized"].boolean()};
  const std::size_t size = components * size_of(found.component_type);
  found.stride = view["byteStride"].integer(kMaxInteger, size);
  const std::string& bytes = buffer(view["buffer"].integer(kMaxInteger), view["buffer"]);
  const std::size_t begin = view["byteOffset"].integer(kMaxInteger, 0),
                    length = view["byteLength"].integer(kMaxInteger);
  if (begin + length > bytes.size())
    view.fail("bytes " + std::to_string(begin) + " to " + std::to_string(begin + length),
              "a part of the " + std::to_string(bytes.size()) + " bytes of the buffer");
  const std::size_t offset = accessor["byteOffset"].integer(kMaxInteger, 0);
  if (found.count > 0 && (found.stride < size || offset + size > length ||
                          (found.count - 1) > (length - offset - size) / found.stride))
    accessor.fail(std::to_string(found.count) + " elements",
                  "as many as fit in the " + std::to_string(length) + " bytes of its bufferView");
  found.data = bytes.data() + begin + offset;
  return found;
}

std::vector<Vec3<double>> Buffers::vectors(const Value& user) {
  const Array array = this->array(user, "VEC3", 3);
  const std::size_t size = size_of(array.component_type);
  std::vector<Vec3<double>> all(array.count);
  for (std::size_t i = 0; i < array.count; ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x =
          component(array.data + i * array.stride + k * size, array.component_type, array.normalized);
      if (!std::isfinite(x))
        user.fail("the coordinate " + std::to_string(x) + " in vertex " + std::to_string(i),
                  "finite numbers");
      all[i][static_cast<Eigen::Index>(k)] = x;
    }
  return all;
}

std::vector<std::size_t> Buffers::integers(const Value& user, std::size_t limit) {
  const Array array = this->array(user, "SCALAR", 1);
  std::vector<std::size_t> all(array.count);
  for (std::size_t i = 0; i < array.count; ++i) {
    const double value = component(array.data + i * array.stride, array.component_type, false);
    if (!is_integer(array.component_type) || value < 0 || value >= static_cast<double>(limit))
      user.fail("the index " + std::to_string(value),
                "integers below " + std::to_string(limit) + ", the number of vertices");
    all[i] = static_cast<std::size_t>(value);
  }
  return all;
}

}  // namespace pliant::gltf
