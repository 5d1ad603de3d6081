// Common flaws of mesh files are removed, and each kind of flaw is reported with the number of flaws. Solids
// that touch stay closed solids.
#include "catch.h"

#include <algorithm>
#include <string>
#include <vector>

#include <pliant/collision/mesh/obstacle_mesh.h>
#include <pliant/collision/mesh/triangle_neighbours.h>
#include <pliant/scene/mesh_file.h>

#include "mesh_samples.h"

namespace mesh_cleaning_test {

using namespace pliant;
using namespace mesh_samples;

namespace {

/// A mesh that is read from a file, and the obstacle that it gives.
struct Cleaned {
  MeshFile mesh;
  ObstacleMesh obstacle;
  explicit Cleaned(const std::string& name, const std::string& bytes)
      : mesh(read_mesh(name, bytes)), obstacle(mesh.vertices, mesh.triangles) {}
};

}  // namespace

TEST_CASE("vertices in no triangle, loose edges and second copies of faces are removed with a note") {
  const Cleaned cube("a.obj",
                     "v 9 9 9\n" + obj_cube(0, 1) + "v 8 8 8\nl 1 2\np 3\nl 4 5 6\nf 4 3 5\nf 6 7 8 9\n");
  CHECK(cube.mesh.notes == std::vector<std::string>{
                               "3 lines and points are ignored", "2 vertices are in no triangle and ignored",
                               "3 triangles are given more than once; one of each is kept"});
  CHECK(cube.mesh.vertices.cols() == 8);
  CHECK(cube.mesh.triangles.cols() == 12);
  CHECK(cube.obstacle.closed());
  const Cleaned flat("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 1 2\nf 3 2 3\n");
  CHECK(flat.mesh.notes == std::vector<std::string>{"2 triangles with two equal corners are removed"});
}

TEST_CASE("coincident corners become one vertex, and nearly coincident corners do not") {
  const Cleaned sheet("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 0 1 1e-7\nf 1 2 3\nf 6 4 5\n");
  CHECK(sheet.mesh.vertices.cols() == 5);
  CHECK(sheet.mesh.notes.empty());
  // The corners of a tiny triangle stay different vertices.
  const Cleaned tiny("tiny.obj", "v 0 0 0\nv 1e-6 0 0\nv 0 1e-6 0\nf 1 2 3\n");
  CHECK(tiny.mesh.notes.empty());
}

TEST_CASE("slivers are removed, and the mesh stays closed") {
  // The upper face of a cube has a vertex 9 on its edge from 6 to 5 that the front face does not have. A
  // sliver with a height of 1e-9 fills the slit.
  std::string text = obj_cube();
  text.replace(text.find("f 5 6 7 8\n"), 10, "");
  text += "v 0.5 1e-9 1\nf 9 6 7 8 5\nf 5 6 9\n";
  const Cleaned divided("a.obj", text);
  CHECK(divided.mesh.notes ==
        std::vector<std::string>{"1 sliver is removed (height below 2e-7 of the longest edge)"});
  CHECK(divided.obstacle.closed());
  CHECK(divided.mesh.vertices.cols() == 9);
  // A needle: two vertices at a distance of 1e-9. They become one vertex.
  std::string split = obj_cube();
  split.replace(split.find("f 5 6 7 8\n"), 10, "");
  split.replace(split.find("f 1 2 6 5\n"), 10, "");
  split += "v 1 1e-9 1\nf 5 9 7 8\nf 6 7 9\nf 1 2 6 9\nf 1 9 5\n";
  const Cleaned merged("a.obj", split);
  CHECK(merged.obstacle.closed());
  CHECK(merged.mesh.vertices.cols() == 8);
  CHECK_THAT(merged.mesh.notes.at(0), test::has_text("removed (height below 2e-7 of the longest edge)"));
}

TEST_CASE("solids that touch in a face become one solid, if the triangles of the face are the same") {
  // The face between the cubes has another diagonal in the second cube.
  const Cleaned two("a.obj", obj_cube() + obj_cube(1, 8));
  CHECK(two.mesh.notes ==
        std::vector<std::string>{
            "4 edges have more than two triangles, where solids touch; each solid keeps its own edge"});
  CHECK(two.mesh.vertices.cols() == 12);
  CHECK(two.obstacle.vertices().cols() == 16);
  CHECK(two.obstacle.closed());
  // Now the diagonals in both cubes are equal.
  std::string second = obj_cube(1, 8);
  const std::string face = "f 12 9 13 16\n";
  second.replace(second.find(face), face.size(), "f 9 13 16 12\n");
  const Cleaned one("a.obj", obj_cube() + second);
  CHECK(one.mesh.notes ==
        std::vector<std::string>{"2 pairs of triangles between two touching solids are removed"});
  CHECK(one.obstacle.vertices().cols() == 12);
  CHECK(one.obstacle.triangles().cols() == 20);
  CHECK(one.obstacle.faces().size() == 6);
  CHECK(one.obstacle.closed());
}

TEST_CASE("solids that touch along an edge or in a vertex keep their own edges") {
  // The second cube is at (1, 1, 0): it touches the first cube along the edge x = y = 1.
  std::string second = obj_cube(1, 8);
  std::string moved = "";
  for (const Vertex& v : cube_vertices())
    moved +=
        "v " + std::to_string(v[0] + 1) + " " + std::to_string(v[1] + 1) + " " + std::to_string(v[2]) + "\n";
  const std::string faces = second.substr(second.find("f "));
  const Cleaned pair("a.obj", obj_cube() + moved + faces);
  CHECK(pair.mesh.notes ==
        std::vector<std::string>{
            "1 edge has more than two triangles, where solids touch; each solid keeps its own edge"});
  CHECK(pair.mesh.vertices.cols() == 14);
  CHECK(pair.obstacle.vertices().cols() == 16);
  CHECK(pair.obstacle.edges().size() == 36);
  CHECK(pair.obstacle.closed());
  for (const ObstacleMesh::Edge& edge : pair.obstacle.edges())
    for (const int t : edge.triangle) CHECK((t < 12) == (edge.triangle[0] < 12));
  // Two cubes with one common vertex.
  std::string corner = "";
  for (const Vertex& v : cube_vertices())
    corner += "v " + std::to_string(v[0] + 1) + " " + std::to_string(v[1] + 1) + " " +
              std::to_string(v[2] + 1) + "\n";
  const Cleaned touching("a.obj", obj_cube() + corner + faces);
  CHECK(touching.mesh.vertices.cols() == 15);
  CHECK(touching.obstacle.vertices().cols() == 16);
  CHECK(touching.obstacle.closed());
}

TEST_CASE("a sheet with two sides stays a sheet with two sides") {
  const Cleaned sheet("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\nf 1 3 2\nf 1 4 3\n");
  CHECK(sheet.mesh.triangles.cols() == 4);
  CHECK(sheet.obstacle.closed());
  CHECK(sheet.obstacle.is_plate());
}

TEST_CASE("bytes between header and data, and after the data, are ignored with a note") {
  const auto notes = [](const std::string& name, const std::string& bytes) {
    const Cleaned cube(name, bytes);
    CHECK(cube.mesh.vertices.cols() == 8);
    CHECK(cube.obstacle.closed());
    return cube.mesh.notes;
  };
  using Notes = std::vector<std::string>;
  for (const char* format : {"binary_little_endian", "binary_big_endian"}) {
    CHECK(notes("a.ply", ply_cube(format, "7 bytes")) ==
          Notes{"7 bytes between header and data are ignored"});
    CHECK(notes("a.ply", ply_cube(format) + "7 bytes") ==
          Notes{"7 bytes after the last element are ignored"});
  }
  CHECK(notes("a.stl", "7 bytes" + stl_binary_cube()) == Notes{"the header has 87 bytes in place of 80"});
  CHECK(notes("a.stl", stl_binary_cube() + "7 bytes") ==
        Notes{"7 bytes after the last triangle are ignored"});
}

}  // namespace mesh_cleaning_test
