// Numbers in binary files: copies of bytes in a given order.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
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

}  // namespace pliant
