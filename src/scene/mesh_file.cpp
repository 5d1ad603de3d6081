#include <pliant/scene/mesh_file.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <stdexcept>
#include <utility>

#include "scene/mesh/clean_mesh.h"
#include "scene/mesh/import_mesh.h"
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

bool is_imported(const std::string& ending) {
  return std::find(kImportedEndings.begin(), kImportedEndings.end(), ending) != kImportedEndings.end();
}

/// Returns the ending of a file name in lower case. Throws std::invalid_argument for an unknown ending.
std::string ending_of(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end() && !is_imported(ending))
    throw std::invalid_argument(
        "expected a file name that ends in .obj, .ply, .stl, .gltf, .glb, .dae, .fbx, .3ds or .off");
  return ending;
}

MeshFile cleaned(RawMesh raw, const std::string& name) {
  MeshFile mesh = clean_mesh(std::move(raw));
  if (mesh.triangles.cols() == 0) throw std::invalid_argument(name + ": all triangles have no area");
  return mesh;
}

}  // namespace

MeshFile read_mesh(const std::filesystem::path& name, std::string bytes) {
  const std::string ending = ending_of(name);
  const MeshBytes file{name.string(), std::move(bytes)};
  if (is_imported(ending))
    throw std::invalid_argument(file.name +
                                ": a mesh of this format cannot be read from memory; call read_mesh_file()");
  return cleaned(ending == ".obj"   ? read_obj(file)
                 : ending == ".ply" ? read_ply(file)
                 : ending == ".stl" ? read_stl(file)
                                    : read_gltf(file, name.parent_path()),
                 file.name);
}

MeshFile read_mesh_file(const std::filesystem::path& file) {
  if (is_imported(ending_of(file))) return cleaned(import_mesh(file), file.string());
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
