// Reads numbers of binary files in a given byte order. The type of a number is a template argument, or a
// NumberType if the file declares the type.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace pliant {

#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
inline constexpr bool kMachineIsLittleEndian = true;
#else
inline constexpr bool kMachineIsLittleEndian = false;
#endif

/// Returns the number of type T that begins at a byte. The caller checks that sizeof(T) bytes are there.
template <class T>
T binary_number(const char* from, bool little_endian = true) {
  std::array<char, sizeof(T)> bytes;
  std::memcpy(bytes.data(), from, sizeof(T));
  if (little_endian != kMachineIsLittleEndian) std::reverse(bytes.begin(), bytes.end());
  T value;
  std::memcpy(&value, bytes.data(), sizeof(T));
  return value;
}

/// The types of numbers in binary files.
enum class NumberType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

/// Returns the number of a type that begins at a byte. A double represents the numbers of all types exactly.
/// The caller checks that size_of(type) bytes are there.
inline double binary_number(NumberType type, const char* from, bool little_endian = true) {
  switch (type) {
    case NumberType::int8:
      return binary_number<std::int8_t>(from, little_endian);
    case NumberType::uint8:
      return binary_number<std::uint8_t>(from, little_endian);
    case NumberType::int16:
      return binary_number<std::int16_t>(from, little_endian);
    case NumberType::uint16:
      return binary_number<std::uint16_t>(from, little_endian);
    case NumberType::int32:
      return binary_number<std::int32_t>(from, little_endian);
    case NumberType::uint32:
      return binary_number<std::uint32_t>(from, little_endian);
    case NumberType::float32:
      return binary_number<float>(from, little_endian);
    case NumberType::float64:
      return binary_number<double>(from, little_endian);
  }
  return 0;
}

/// Returns the number of bytes of a number.
inline std::size_t size_of(NumberType type) {
  constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}
inline bool is_integer(NumberType type) {
  return type != NumberType::float32 && type != NumberType::float64;
}

}  // namespace pliant
