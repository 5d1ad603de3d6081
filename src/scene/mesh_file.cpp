#include <pliant/scene/mesh_file.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <utility>

#include "scene/mesh/clean_mesh.h"
#include "scene/mesh/mesh_bytes.h"
#include "scene/mesh/read_gltf.h"
#include "scene/mesh/read_obj.h"
#include "scene/mesh/read_ply.h"
#include "scene/mesh/read_stl.h"

namespace pliant {

namespace {

constexpr std::array<const char*, 5> kEndings{".obj", ".ply", ".stl", ".gltf", ".glb"};
constexpr const char* kPrefix = "obstacle_";
constexpr const char* kSuffix = ".ply";

/// Returns the ending of a file name in lower case. Throws std::invalid_argument for an unknown ending.
std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end())
    throw std::invalid_argument("expected a file .obj, .ply, .stl, .gltf or .glb");
  return ending;
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& name, std::string bytes) {
  const std::string ending = ending_of(name);
  const MeshBytes file{name.string(), std::move(bytes)};
  MeshFile mesh = clean_mesh(ending == ".obj"   ? read_obj(file)
                             : ending == ".ply" ? read_ply(file)
                             : ending == ".stl" ? read_stl(file)
                                                : read_gltf(file, name.parent_path()));
  if (mesh.triangles.cols() == 0) throw std::invalid_argument(file.name + ": all triangles have no area");
  return mesh;
}

MeshFile read_mesh_file(const std::filesystem::path& file) {
  ending_of(file);
  return read_mesh(file, read_mesh_bytes(file));
}

std::string recorded_mesh_name(const std::string& obstacle) {
  return kPrefix + obstacle + kSuffix;
}

bool is_recorded_mesh(const std::string& file_name) {
  const std::string head = kPrefix, tail = kSuffix;
  return file_name.size() > head.size() + tail.size() && file_name.compare(0, head.size(), head) == 0 &&
         file_name.compare(file_name.size() - tail.size(), tail.size(), tail) == 0;
}

}  // namespace pliant
