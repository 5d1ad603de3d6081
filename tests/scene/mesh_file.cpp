// Meshes are read from files of all formats, and their numbers are kept bit for bit. Files that are not
// meshes are refused with the place of the fault.
#include "catch.h"

#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <stdexcept>
#include <string>

#include <pliant/collision/mesh/obstacle_mesh.h>
#include <pliant/scene/json/text_file.h>
#include <pliant/scene/mesh_file.h>

#include "io/new_folder.h"
#include "mesh_samples.h"

namespace mesh_file_test {

using namespace pliant;
using namespace mesh_samples;

namespace {

/// Returns the error message about a mesh; empty if the mesh is valid.
std::string error_of(const std::string& name, const std::string& bytes) {
  try {
    const MeshFile mesh = read_mesh(name, bytes);
    const ObstacleMesh sound(mesh.vertices, mesh.triangles);
  } catch (const std::invalid_argument& fault) {
    return fault.what();
  }
  return "";
}

/// Returns the volume that a closed mesh encloses; negative if its triangles are inside out.
double volume(const MeshFile& mesh) {
  double six = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    six += mesh.vertices.col(mesh.triangles(0, t))
               .dot(Vec3<double>(mesh.vertices.col(mesh.triangles(1, t)))
                        .cross(Vec3<double>(mesh.vertices.col(mesh.triangles(2, t)))));
  return six / 6;
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

TEST_CASE("a cube is read from every format, closed and with outward normals") {
  for (const Sample& sample : cubes()) {
    CAPTURE(sample.name);
    const MeshFile mesh = read_mesh(sample.name, sample.bytes);
    CHECK(mesh.notes.empty());
    CHECK(mesh.vertices.cols() == 8);
    CHECK(mesh.triangles.cols() == 12);
    CHECK(volume(mesh) == Approx(1).epsilon(1e-15));
    CHECK(ObstacleMesh(mesh.vertices, mesh.triangles).closed());
  }
  CHECK(error_of("a.OBJ", obj("f 1 2 3\nf 3 2 4\n")).empty());
  // Statements without influence, corners with texture and normal, numbers that count backwards, a long line.
  const MeshFile mesh = read_mesh(
      "a.obj",
      "# a comment\r\nmtllib none.mtl\r\no thing\nv +0 0. .0 1\nv 1 0 0 0.1 0.2 0.3\nvn 0 0 1\nvt 0 0\n"
      "usemtl red\ns off\nv 0 1 0\nf 1/1/1 2//1 \\\n -1/1 # the last vertex");
  CHECK(mesh.triangles.col(0) == Eigen::Vector3i(0, 1, 2));
  CHECK(mesh.notes.empty());
}

TEST_CASE("coordinates keep double precision") {
  const std::string x = "499999.123456789012", y = "4000000.1", z = "-1.0000000000000002e-7";
  const Vec3<double> exact(499999.123456789012, 4000000.1, -1.0000000000000002e-7);
  CHECK(read_mesh("a.obj", "v " + x + " " + y + " " + z + "\nv 0 0 0\nv 1 1 1\nf 1 2 3\n").vertices.col(0) ==
        exact);
  CHECK(read_mesh("a.ply",
                  "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty double y\nproperty "
                  "double z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" +
                      x + " " + y + " " + z + "\n0 0 0\n1 1 1\n3 0 1 2\n")
            .vertices.col(0) == exact);
  CHECK(read_mesh("a.stl", "solid\nfacet normal 0 0 0\nouter loop\nvertex " + x + " " + y + " " + z +
                               "\nvertex 0 0 0\nvertex 1 1 1\nendloop\nendfacet\nendsolid\n")
            .vertices.col(0) == exact);
  // The data of a glTF file are in single precision, but its transformations are not.
  const MeshFile far =
      read_mesh("a.gltf", gltf_cube(R"([{"mesh": 0, "translation": [4000000.1, 0, -1e-9]}])"));
  CHECK(far.vertices.col(0) == Vec3<double>(4000000.1, 0, -1e-9));
}

TEST_CASE("nodes of a glTF file place their meshes; a mirrored mesh is not inside out") {
  const auto cube = [](const std::string& nodes) { return read_mesh("a.gltf", gltf_cube(nodes)); };
  for (const char* scale : {"[-1, 1, 1]", "[-1, -2, -3]", "[1, 1, -0.5]", "[-1, -1, 1]"}) {
    CAPTURE(scale);
    const MeshFile mesh = cube(R"([{"mesh": 0, "scale": )" + std::string(scale) + "}]");
    CHECK(volume(mesh) > 0);
    CHECK(ObstacleMesh(mesh.vertices, mesh.triangles).closed());
  }
  CHECK(volume(cube(R"([{"mesh": 0, "matrix": [0,1,0,0, 1,0,0,0, 0,0,1,0, 5,6,7,1]}])")) == Approx(1));
  // Two reflections cancel each other; the child is placed relative to its parent.
  const MeshFile twice = cube(R"([{"children": [1], "scale": [-1, 1, 1], "translation": [10, 0, 0]},
                                  {"mesh": 0, "scale": [-1, 1, 1], "translation": [1, 2, 3]}])");
  CHECK(volume(twice) == Approx(1));
  CHECK(twice.vertices.rowwise().minCoeff() == Vec3<double>(9, 2, 3));
  // A chain of 20 000 nodes is read; cycles and nodes with two parents are refused.
  std::string chain = "[{\"translation\": [0, 0, 1], \"children\": [1]}";
  for (int k = 1; k < 20000; ++k)
    chain += ", {\"translation\": [0, 0, 1], \"children\": [" + std::to_string(k + 1) + "]}";
  CHECK(cube(chain + ", {\"mesh\": 0}]").vertices.row(2).minCoeff() == 20000);
  CHECK_THAT(error_of("a.gltf", gltf_cube(R"([{"children": [1]}, {"mesh": 0, "children": [0]}])")),
             test::has_text("a.gltf: /nodes/0: found a node that is a child twice, or of itself"));
}

TEST_CASE("polygons become triangles that cover them, concave ones too") {
  // The polygons are an L of area 3 and an arrow.
  const MeshFile ell = read_mesh("a.obj",
                                 "v 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nv 0 2 0\nf 6 5 4 3 2 1\n"
                                 "v 5 0 0\nv 6 1 0\nv 5 3 0\nv 5.5 1 0\nf 7 8 9 10\n");
  CHECK(ell.triangles.cols() == 4 + 2);
  double area = 0;
  for (Eigen::Index t = 0; t < ell.triangles.cols(); ++t) {
    const Vec3<double> a = ell.vertices.col(ell.triangles(0, t)), b = ell.vertices.col(ell.triangles(1, t)),
                       c = ell.vertices.col(ell.triangles(2, t));
    area += 0.5 * (b - a).cross(c - a).norm();
    CHECK((b - a).cross(c - a)[2] * (t < 4 ? -1 : 1) > 0);
  }
  CHECK(area == Approx(3 + 0.75).epsilon(1e-14));
}

TEST_CASE("files that are not meshes are refused with the place of the fault") {
  const auto refused = [](const std::string& name, const std::string& bytes, const std::string& text) {
    CHECK_THAT(error_of(name, bytes), test::has_text(text));
  };
  refused("a.obj", obj("f 1 2 3\n", "0 1,5 0"),
          "a.obj:3:5: found \"1,5\"; expected coordinate y of a vertex");
  refused("a.obj", obj("f 1 2 3\n", "0 x 0"), "a.obj:3:5: found \"x\"");
  refused("a.obj", obj("f 1 2 3\n", "0 nan 0"), "a.obj:3:5: found \"nan\"");
  refused("a.obj", obj("f 1 2 3\n", "0 1e400 0"), "a.obj:3:5: found \"1e400\"");
  // The sum of this exponent and the place of the first digit exceeds the range of long long.
  refused("a.obj", obj("f 1 2 3\n", "0 1e9223372036854775807 0"),
          "a.obj:3:5: found \"1e9223372036854775807\"");
  refused("a.obj", obj("f 1 2 3\n", "0 " + std::string(400, '9') + " 0"), "a.obj:3:5: found");
  CHECK(error_of("a.obj", obj("f 1 2 3\n", "0 1 0." + std::string(400, '0') + "1")).empty());
  CHECK(error_of("a.obj", obj("f 1 2 3\n", "0 1 -1e-400")).empty());
  refused("a.obj", obj("f 1 2 3\n", "0 1"), "a.obj:3:6: found the end of the line; expected coordinate z");
  refused("a.obj", obj("f 1 2 3\nf 3 2 9\n"), "found a face with vertex 9; expected vertices from 1 to 4");
  refused("a.obj", obj("f 0 1 2\n"), "a.obj:5:3: found \"0\"");
  refused("a.obj", obj("f 1 2 -5\n"), "a.obj:5:7: found \"-5\"");
  refused("a.obj", obj("f 1 2 3.5\n"), "a.obj:5:7: found \"3.5\"");
  refused("a.obj", obj("f 1 2\n"), "expected a face with three or more corners");
  refused("a.obj", "", "found no face");
  refused("a.obj", obj(""), "found no face");
  refused("a.obj", "this is text, and nothing else\n", "a.obj:1:1: found \"this\"; expected a statement");
  refused("a.ply", "", "a.ply:1:1: found the end of the file; expected the word ply");
  refused("a.ply", "ply\nformat ascii 1.0\n", "found the end of the file; expected the line end_header");
  refused("a.ply", ply(4, "3 0 1 2\n3 2 1 7\n"),
          "a.ply:15:7: found \"7\"; expected the number of a vertex, below 4");
  refused("a.ply", ply(4, "3 0 1 2\n3 2 1 -1\n"), "a.ply:15:7: found \"-1\"");
  refused("a.ply", ply(6, "3 0 1 2\n3 2 1 3\n"), "");  // more vertices in the header than in the file
  CHECK_FALSE(error_of("a.ply", ply(6, "3 0 1 2\n3 2 1 3\n")).empty());
  refused("a.ply", ply(2000000000, "3 0 1 2\n3 2 1 3\n"),
          "found 2000000000 elements \"vertex\"; expected at most");
  refused("a.stl", "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 O 0\n",
          "a.stl:5:10: found \"O\"");
  std::string stl = stl_binary_cube();
  stl[80] = 14;
  refused("a.stl", stl,
          "a.stl: byte 80: found 14 as the number of triangles of a binary STL file; expected 12");
  refused("a.stl", "short", "expected the word solid");
  refused("a.gltf", "{", "a.gltf:1:2");
  refused("a.gltf", "{}", "a.gltf: /asset/version: found a value that is not a text");
  refused("a.gltf", gltf_cube("[{}]"), "found no triangle in its scene");
  refused("a.gltf", gltf_json("[{\"mesh\": 0}]", "data:;base64,AAAA"),
          "/buffers/0: found data of 3 bytes; expected 168");
  refused("a.gltf", gltf_json("[{\"mesh\": 0}]", "../b.bin"), "expected the name of a file in the folder");
  refused("a.blend", "anything",
          "expected a file name that ends in .obj, .ply, .stl, .gltf, .glb, .dae, .fbx, .3ds or .off");
  // The topology is checked after the cleaning.
  refused("a.obj", obj("f 1 2 3\nf 2 3 4\n"), "have opposite orientations");
  refused("a.obj", obj("v 0 0 9\nf 1 2 3\nf 3 2 4\nf 2 3 5\n"), "has three triangles: 0, 1 and 2");
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
  // No process writes to the pipes, so that a read would never end.
  REQUIRE(::mkfifo((folder / "pipe.obj").c_str(), 0600) == 0);
  CHECK_THAT(fault("pipe.obj"), test::has_text("it is a pipe or a device; expected a regular file"));
  set_bytes(folder / "names_pipe.obj", "mtllib pipe.obj\n" + obj("f 1 2 3\n"));
  CHECK(fault("names_pipe.obj").empty());
  set_bytes(folder / "pipe_buffer.gltf", gltf_json("[{\"mesh\": 0}]", "pipe.obj"));
  CHECK_THAT(fault("pipe_buffer.gltf"), test::has_text("it is a pipe or a device"));
  set_bytes(folder / "data.bin", gltf_data());
  set_bytes(folder / "file_buffer.gltf", gltf_json("[{\"mesh\": 0}]", "data%2Ebin"));
  CHECK(fault("file_buffer.gltf").empty());
}

TEST_CASE("other formats are imported in a process that may crash") {
  const NewFolder folder;
  set_bytes(folder / "cube.off",
            "OFF\n8 6 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n0 0 1\n1 0 1\n1 1 1\n0 1 1\n"
            "4 3 2 1 0\n4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
  const MeshFile cube = read_mesh_file(folder / "cube.off");
  CHECK(cube.vertices.cols() == 8);
  CHECK(volume(cube) == Approx(1));
  const std::string source =
      R"(<source id="p"><float_array id="pa" count="12">0 0 0 1 0 0 0 1 0 0 0 1</float_array>
    <technique_common><accessor source="#pa" count="4" stride="3"><param name="X" type="float"/>
    <param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
    <vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
    <triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/>
    <p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles>)";
  const std::string scene =
      R"(<?xml version="1.0"?><COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema"
    version="1.4.1"><asset><up_axis>Y_UP</up_axis></asset><library_geometries><geometry id="g"><mesh>)" +
      source + R"(</mesh></geometry></library_geometries><library_visual_scenes>
    <visual_scene id="s"><node><scale>-1 1 1</scale><instance_geometry url="#g"/></node></visual_scene>
    </library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>)";
  set_bytes(folder / "mirrored.dae", scene);
  CHECK(volume(read_mesh_file(folder / "mirrored.dae")) == Approx(1.0 / 6));  // not inside out
  for (const char* name : {"a.off", "a.dae", "a.fbx", "a.3ds"}) {
    set_bytes(folder / name, std::string("OFF\n999999999 1 0\n\0\x01garbage", 27));
    CHECK_THROWS_AS(read_mesh_file(folder / name), std::invalid_argument);
  }
  CHECK_THROWS_AS(read_mesh_file(folder / "none.off"), FileError);
  CHECK_THROWS_AS(read_mesh("cube.off", "OFF"), std::invalid_argument);  // from memory
}

}  // namespace mesh_file_test
