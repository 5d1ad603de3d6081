// A mesh as the reader of a file format returns it, and the bytes that a reader receives.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include <pliant/math/types.h>

namespace pliant {

/// Largest number of triangles of a mesh. The triangles of a glTF mesh are counted once for each of its
/// nodes.
inline constexpr std::size_t kMaxTriangles = 20'000'000;

/// A file in memory. name: its path, for messages.
struct MeshBytes {
  std::string name, bytes;
};

struct RawMesh {
  std::vector<Vec3<double>> vertices;         ///< with finite coordinates
  std::vector<std::array<int, 3>> triangles;  ///< numbers of existing vertices
  std::vector<std::string> notes;             ///< messages for the user about ignored parts of the file
};

/// Returns "1 line is" or "2 lines are": a number with a noun and the verb.
inline std::string counted(std::size_t n, const std::string& one, const std::string& many) {
  return std::to_string(n) + " " + (n == 1 ? one : many);
}

}  // namespace pliant
