// OBJ and PLY: every number comes back, groups and indices are right.
#include <charconv>
#include <cstring>
#include <sstream>

#include "catch.h"
#include "new_folder.h"
#include "test_scenes.h"

#include <pliant/integrate/simulation.h>
#include <pliant/io/frame_meshes.h>
#include <pliant/io/mesh_frames.h>
#include <pliant/io/obj.h>
#include <pliant/io/ply.h>
#include <pliant/io/run.h>

using namespace pliant;
namespace fs = std::filesystem;

namespace {

struct ReadObj {
  std::vector<Vec3<double>> x, n;
  std::vector<std::array<int, 3>> triangles, corners;
  std::vector<std::string> groups, materials;
};

ReadObj read_obj(const std::string& text) {
  ReadObj obj;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string key;
    words >> key;
    if (key == "v" || key == "vn") {
      std::string a, b, c;
      words >> a >> b >> c;
      (key == "v" ? obj.x : obj.n).push_back({std::stod(a), std::stod(b), std::stod(c)});
    } else if (key == "f") {
      std::array<int, 3> t{}, c{};
      for (std::size_t k = 0; k < 3; ++k) {
        std::string corner;
        words >> corner;
        REQUIRE(std::sscanf(corner.c_str(), "%d//%d", &t[k], &c[k]) == 2);
      }
      obj.triangles.push_back(t);
      obj.corners.push_back(c);
    } else if (key == "g") {
      obj.groups.push_back(line.substr(2));
    } else if (key == "usemtl") {
      obj.materials.push_back(line.substr(7));
    }
  }
  return obj;
}

}  // namespace

TEST_CASE("an OBJ file reads back exactly") {
  const auto scene = pulled_scene();
  Simulation simulation(scene->body);
  for (int i = 0; i < 20; ++i) simulation.step(1e-3);
  FrameMeshes frame(*scene, simulation.model());
  const std::vector<NamedMesh>& meshes = frame.at(simulation.state());
  const ReadObj obj = read_obj(obj_text(meshes, "parts.mtl"));
  CHECK(obj.groups == std::vector<std::string>{"blob", "rider,_\"heavy\"", "wall", "bob"});
  CHECK(obj.materials == obj.groups);
  std::size_t vertex = 0, normal = 0, triangle = 0;
  for (const NamedMesh& named : meshes) {
    const TriangleMesh& mesh = named.mesh;
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t, ++triangle)
      for (int k = 0; k < 3; ++k) {
        CHECK(obj.triangles[triangle][static_cast<std::size_t>(k)] ==
              static_cast<int>(vertex) + mesh.triangles(k, t) + 1);
        CHECK(obj.corners[triangle][static_cast<std::size_t>(k)] ==
              static_cast<int>(normal) + mesh.corners(k, t) + 1);
      }
    for (Eigen::Index i = 0; i < mesh.x.cols(); ++i) CHECK(obj.x[vertex++] == mesh.x.col(i));
    for (Eigen::Index i = 0; i < mesh.normals.cols(); ++i)
      CHECK((obj.n[normal++] - mesh.normals.col(i)).cwiseAbs().maxCoeff() <= 0.5000001e-6);
  }
  CHECK(obj.x.size() == vertex);
  CHECK(obj.n.size() == normal);
  CHECK(obj.triangles.size() == triangle);
  CHECK(mtl_text(meshes).find("newmtl wall\nKd 0.8 0.5 0.2\n") != std::string::npos);
}

TEST_CASE("a rigid part moved is the surface evaluated anew") {
  const auto scene = free_top();
  Simulation simulation(scene->body, "rk4");
  FrameMeshes frame(*scene, simulation.model());
  for (int i = 0; i < 3; ++i) {
    simulation.step(0.1);
    const TriangleMesh& moved = frame.at(simulation.state())[0].mesh;
    const Part& part = *scene->body.parts()[0];
    const TriangleMesh anew =
        Surface(part, 8).world_mesh(part, simulation.model().values(simulation.state(), 0),
                                    simulation.model().position(simulation.state(), 0),
                                    simulation.model().orientation(simulation.state(), 0));
    CHECK((moved.x - anew.x).cwiseAbs().maxCoeff() < 1e-15);
    CHECK(moved.triangles == anew.triangles);
    const Eigen::AlignedBox3d box = frame.bounds(simulation.state());
    CHECK((box.min() - anew.x.rowwise().minCoeff()).cwiseAbs().maxCoeff() < 1e-15);
    CHECK((box.max() - anew.x.rowwise().maxCoeff()).cwiseAbs().maxCoeff() < 1e-15);
  }
}

TEST_CASE("a PLY file has the size and the numbers its header tells") {
  const auto scene = pulled_scene();
  const Simulation simulation(scene->body);
  FrameMeshes frame(*scene, simulation.model());
  const std::vector<NamedMesh>& meshes = frame.at(simulation.state());
  const std::string bytes = ply_bytes(meshes);
  const std::string mark = "end_header\n";
  const std::size_t data = bytes.find(mark) + mark.size();
  Eigen::Index vertices = 0, triangles = 0;
  for (const NamedMesh& named : meshes) {
    vertices += named.mesh.x.cols();
    triangles += named.mesh.triangles.cols();
  }
  CHECK(bytes.find("element vertex " + std::to_string(vertices) + "\n") != std::string::npos);
  CHECK(bytes.find("element face " + std::to_string(triangles) + "\n") != std::string::npos);
  REQUIRE(bytes.size() ==
          data + static_cast<std::size_t>(vertices) * 43 + static_cast<std::size_t>(triangles) * 13);
  double x[3];
  float n[3];
  std::memcpy(x, bytes.data() + data, sizeof x);
  std::memcpy(n, bytes.data() + data + sizeof x, sizeof n);
  CHECK(Vec3<double>(x[0], x[1], x[2]) == meshes[0].mesh.x.col(0));
  CHECK(std::abs(std::hypot(n[0], n[1], n[2]) - 1) < 1e-6);
  // The last face is of the last part.
  std::int32_t corner = 0;
  std::memcpy(&corner, bytes.data() + bytes.size() - 4, 4);
  CHECK(corner == vertices - meshes.back().mesh.x.cols() +
                      meshes.back().mesh.triangles(2, meshes.back().mesh.triangles.cols() - 1));
}

TEST_CASE("frames become files of their number") {
  const NewFolder folder;
  const auto scene = free_top();
  scene->appearance[0].resolution = 1;
  Progress silent;
  RunOptions options;
  options.folder = folder / "r";
  Run run(*scene, options, silent);
  REQUIRE(run.simulate());
  fs::create_directory(folder / "m");
  const Model& model = run.simulation().model();
  write_mesh_frames(folder / "m", MeshFormat::obj, *scene, model, run.recording(), scene->frame_rate, {0, 10},
                    silent);
  write_mesh_frames(folder / "m", MeshFormat::ply, *scene, model, run.recording(), scene->frame_rate, {3},
                    silent);
  CHECK(fs::exists(folder / "m" / "frame_000000.obj"));
  CHECK(fs::exists(folder / "m" / "frame_000010.obj"));
  CHECK(fs::exists(folder / "m" / "frame_000003.ply"));
  CHECK(fs::exists(folder / "m" / "parts.mtl"));
  // The part moves at 0.5 m/s: after 1 s it is half a metre on.
  const ReadObj first = read_obj(bytes_of(folder / "m" / "frame_000000.obj")),
                last = read_obj(bytes_of(folder / "m" / "frame_000010.obj"));
  Vec3<double> shift = Vec3<double>::Zero();
  for (std::size_t i = 0; i < first.x.size(); ++i)
    shift += (last.x[i] - first.x[i]) / static_cast<double>(first.x.size());
  CHECK(shift[0] == Approx(0.5).epsilon(1e-12));
}
