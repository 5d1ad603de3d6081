// Meshes are read from files of the supported formats (binary glTF is not tested). Invalid meshes are
// refused.
#include "catch.h"

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <pliant/collision/mesh/obstacle_mesh.h>
#include <pliant/scene/json/text_file.h>
#include <pliant/scene/mesh_file.h>

#include "io/new_folder.h"

namespace mesh_file_test {

using namespace pliant;

namespace {

/// Writes a file with this text and returns the error message about its mesh; empty if the mesh is valid.
std::string error_of(const std::string& name, const std::string& text) {
  const NewFolder folder;
  set_bytes(folder / name, text);
  try {
    const MeshFile mesh = read_mesh_file(folder / name);
    const ObstacleMesh sound(mesh.vertices, mesh.triangles);
  } catch (const std::invalid_argument& fault) {
    return fault.what();
  }
  return "";
}

/// Return the text of an OBJ or ASCII PLY file with four vertices. faces: lines of the faces; third: third
/// vertex; vertices: number of vertices in the header.
std::string obj(const std::string& faces, const std::string& third = "0 1 0") {
  return "v 0 0 0\nv 1 0 0\nv " + third + "\nv 1 1 0\n" + faces;
}

std::string ply(int vertices, const std::string& faces) {
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(vertices) +
         "\nproperty float x\nproperty float y\nproperty float z\nelement face 2\n"
         "property list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n" +
         faces;
}

}  // namespace

TEST_CASE("meshes are read from OBJ, PLY, STL and glTF files") {
  CHECK(error_of("a.obj", obj("f 1 2 4 3\n")).empty());
  CHECK(error_of("a.OBJ", obj("f 1 2 3\nf 3 2 4\n")).empty());
  CHECK(error_of("a.ply", ply(4, "3 0 1 2\n3 2 1 3\n")).empty());
  CHECK(
      error_of("a.stl",
               "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
               "endfacet\nfacet normal 0 0 1\nouter loop\nvertex 0 1 0\nvertex 1 0 0\nvertex 1 1 0\nendloop\n"
               "endfacet\nendsolid a\n")
          .empty());
  // A glTF node with one triangle, scaled by 2 and then translated by 2 along z.
  const NewFolder folder;
  set_bytes(folder / "a.gltf",
            R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
    "nodes": [{"mesh": 0, "translation": [0, 0, 2], "scale": [2, 2, 2]}],
    "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0, 0, 0], "max": [1, 1, 0]},
                  {"bufferView": 1, "componentType": 5123, "count": 3, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 6}],
    "buffers": [{"byteLength": 42, "uri": "data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAABAAIA"}]})");
  const MeshFile mesh = read_mesh_file(folder / "a.gltf");
  REQUIRE(mesh.triangles.cols() == 1);
  CHECK(mesh.vertices.col(mesh.triangles(1, 0)) == Vec3<double>(2, 0, 2));
  CHECK(mesh.vertices.col(mesh.triangles(2, 0)) == Vec3<double>(0, 2, 2));
}

TEST_CASE("coincident corners become one vertex, and nearly coincident ones do not") {
  const NewFolder folder;
  set_bytes(folder / "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 1 1e-7\nf 1 2 3\nf 6 4 5\n");
  const MeshFile mesh = read_mesh_file(folder / "a.obj");
  const ObstacleMesh obstacle(mesh.vertices, mesh.triangles);
  CHECK(obstacle.vertices().cols() == 5);
  // The corners of a tiny triangle stay different vertices.
  CHECK(error_of("tiny.obj", "v 0 0 0\nv 1e-6 0 0\nv 0 1e-6 0\nf 1 2 3\n").empty());
}

TEST_CASE("invalid meshes are refused with the reason") {
  CHECK_THAT(error_of("a.obj", obj("f 1 2 3\nf 3 2 4\n", "0 nan 0")),
             test::has_text("is not finite: (0, nan, 0)"));
  CHECK_THAT(error_of("a.obj", obj("f 1 2 3\nf 3 2 4\n", "0 1e400 0")),
             test::has_text("is not finite: (0, inf, 0)"));
  CHECK_THAT(error_of("a.obj", obj("f 1 2 3\nf 3 2 9\n")), test::has_text("the file is not a mesh: "));
  CHECK_THAT(error_of("a.ply", ply(4, "3 0 1 2\n3 2 1 7\n")), test::has_text("the file is not a mesh: "));
  CHECK_THAT(error_of("a.ply", ply(4, "3 0 1 2\n3 2 1 -1\n")), test::has_text("the file is not a mesh: "));
  // The number of vertices in the header is larger by two than the number of vertices in the file.
  CHECK_FALSE(error_of("a.ply", ply(6, "3 0 1 2\n3 2 1 3\n")).empty());
  CHECK_THAT(error_of("a.obj", ""), test::has_text("the file is not a mesh: "));
  CHECK_THAT(error_of("a.obj", "this is text, and nothing else\n"),
             test::has_text("the file is not a mesh: "));
  CHECK_THAT(error_of("a.obj", obj("")), test::has_text("the file is not a mesh: "));
  CHECK_THAT(error_of("a.obj", obj("f 1 2 3\nf 3 2 4\nf 1 1 2\n")), test::has_text("triangle 2 has no area"));
  CHECK_THAT(error_of("a.obj", obj("f 1 2 3\nf 3 2 4\nl 1 2\n")), test::has_text("a point or a line"));
  CHECK_THAT(error_of("a.obj", obj("f 1 2 3\nf 2 3 4\n")), test::has_text("have opposite orientations"));
  CHECK_THAT(error_of("a.obj", obj("f 1 2 3\nf 3 2 4\nf 2 3 1\n")),
             test::has_text("has three triangles: 0, 1 and 2"));
  CHECK_THAT(error_of("a.fbx", "anything"),
             test::has_text("expected a file .obj, .ply, .stl, .gltf or .glb"));
}

TEST_CASE("unreadable files are reported with the error of the file system") {
  const NewFolder folder;
  set_bytes(folder / "bowl.obj", obj("f 1 2 3\n"));
  std::filesystem::create_directory(folder / "folder.obj");
  const auto fault = [&](const std::string& name) -> std::string {
    try {
      read_mesh_file(folder / name);
    } catch (const FileError& error) {
      return error.what();
    }
    return "";
  };
  CHECK_THAT(fault("bowls.obj"), test::has_text("No such file or directory; did you mean \"bowl.obj\"?"));
  CHECK_THAT(fault("folder.obj"), test::has_text("Is a directory"));
}

}  // namespace mesh_file_test
