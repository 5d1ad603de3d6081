// libFuzzer target: any bytes are a mesh or are refused with std::invalid_argument or FileError. The first
// byte chooses the format. A mesh that is accepted is finite, and its triangles refer to its vertices. If it
// is also valid as an obstacle, it is written as OBJ text, and reading this text gives an equal mesh.
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include <pliant/collision/mesh/obstacle_mesh.h>
#include <pliant/scene/json/text_file.h>
#include <pliant/scene/mesh_file.h>

namespace {

void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what);
  std::abort();
}

/// Returns the mesh as a text in the format OBJ, with all digits.
std::string obj_text(const pliant::MeshFile& mesh) {
  std::string text;
  char line[128];
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) {
    std::snprintf(line, sizeof line, "v %.17g %.17g %.17g\n", mesh.vertices(0, i), mesh.vertices(1, i),
                  mesh.vertices(2, i));
    text += line;
  }
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    std::snprintf(line, sizeof line, "f %d %d %d\n", mesh.triangles(0, t) + 1, mesh.triangles(1, t) + 1,
                  mesh.triangles(2, t) + 1);
    text += line;
  }
  return text;
}

void check(const pliant::MeshFile& mesh) {
  require(mesh.vertices.allFinite(), "a vertex is not finite");
  require(mesh.triangles.cols() > 0, "no triangle");
  require(mesh.triangles.minCoeff() >= 0 && mesh.triangles.maxCoeff() < mesh.vertices.cols(),
          "a triangle without its vertex");
  try {
    const pliant::ObstacleMesh obstacle(mesh.vertices, mesh.triangles);
  } catch (const std::invalid_argument&) {
    return;  // for example an edge with three triangles
  }
  const pliant::MeshFile again = pliant::read_mesh("again.obj", obj_text(mesh));
  require(again.vertices == mesh.vertices && again.triangles == mesh.triangles, "cleaning is not idempotent");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  constexpr const char* names[] = {"a.obj", "a.ply", "a.stl", "a.gltf", "a.glb"};
  const std::string bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  try {
    check(pliant::read_mesh(names[data[0] % 5], bytes));
  } catch (const std::invalid_argument&) {
    return 0;
  } catch (const pliant::FileError&) {
    return 0;
  }
  return 0;
}
