// OBJ and PLY files contain exact positions. PLY files also contain exact surface values. OBJ files contain
// normals rounded to six decimals, one group for each part, and correct indices.
#include <algorithm>
#include <charconv>
#include <cstring>
#include <sstream>

#include "catch.h"
#include "new_folder.h"
#include "test_scenes.h"

#include <pliant/io/format/obj.h>
#include <pliant/io/format/ply.h>
#include <pliant/io/frame_meshes.h>
#include <pliant/io/mesh_frames.h>
#include <pliant/io/run/run.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/simulate/simulation.h>

namespace mesh_files_test {

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

TEST_CASE("an OBJ file contains the exact coordinates") {
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

TEST_CASE("the transformed mesh of a rigid part equals a new evaluation of its surface") {
  const auto scene = free_top();
  Simulation simulation(scene->body, "rk4");
  FrameMeshes frame(*scene, simulation.model());
  for (int i = 0; i < 3; ++i) {
    simulation.step(0.1);
    const TriangleMesh& transformed = frame.at(simulation.state())[0].mesh;
    const Part& part = *scene->body.parts()[0];
    const TriangleMesh evaluated =
        Surface(part, 8).world_mesh(part, simulation.model().values(simulation.state(), 0),
                                    simulation.model().position(simulation.state(), 0),
                                    simulation.model().orientation(simulation.state(), 0));
    CHECK((transformed.x - evaluated.x).cwiseAbs().maxCoeff() < 1e-15);
    CHECK(transformed.triangles == evaluated.triangles);
    const Eigen::AlignedBox3d box = frame.bounds(simulation.state());
    CHECK((box.min() - evaluated.x.rowwise().minCoeff()).cwiseAbs().maxCoeff() < 1e-15);
    CHECK((box.max() - evaluated.x.rowwise().maxCoeff()).cwiseAbs().maxCoeff() < 1e-15);
  }
}

TEST_CASE("a PLY file has the size and the numbers of elements that its header states") {
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
  // The last index of the file is the index of the last corner of the last triangle of the last part.
  std::int32_t corner = 0;
  std::memcpy(&corner, bytes.data() + bytes.size() - 4, 4);
  CHECK(corner == vertices - meshes.back().mesh.x.cols() +
                      meshes.back().mesh.triangles(2, meshes.back().mesh.triangles.cols() - 1));
}

TEST_CASE("each frame becomes a file whose name has the number of the frame") {
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
  // The part moves at 0.5 m/s: after 1 s it is displaced by half a metre.
  const ReadObj first = read_obj(bytes_of(folder / "m" / "frame_000000.obj")),
                last = read_obj(bytes_of(folder / "m" / "frame_000010.obj"));
  Vec3<double> shift = Vec3<double>::Zero();
  for (std::size_t i = 0; i < first.x.size(); ++i)
    shift += (last.x[i] - first.x[i]) / static_cast<double>(first.x.size());
  CHECK(shift[0] == Approx(0.5).epsilon(1e-12));
}

namespace {

/// Returns a scene with three parts: a rotated solid with curved finite elements, a sphere with a dynamic
/// radius, and a rigid ellipsoid. Both soft parts are stretched by 10 %. by: quantity that colours the parts.
std::unique_ptr<Scene> soft_scene(SurfaceQuantity by) {
  auto scene = std::make_unique<Scene>();
  scene->body.gravity.setZero();
  Part& soft = scene->body.add(make_part("soft", "ellipsoid", {}, 1000));
  soft.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.25}}).place({1, 2, 3}, Eigen::Quaterniond(0.8, 0, 0.6, 0));
  LocalSettings settings;
  settings.resolution = 2;
  settings.order = 2;
  settings.energies = {local_law("elastic", {1e5, 0.3})};
  // A stretch by 10 % in all directions, which contains no rigid motion.
  settings.displacement = [](const Vec3<double>& X) { return Vec3<double>(0.1 * X); };
  soft.deform_locally(std::move(settings));
  Part& ball = scene->body.add(make_part("ball", "sphere", {}, 1000));
  ball.rest({{"r", 0.5}}).initial({{"r", 0.55}}).place({-1, 0, 0}).velocity({1, 2, 3}, {3, 2, 1});
  Part& top = scene->body.add(make_part("top", "ellipsoid", {}, 1000));
  top.velocity({1, 2, 3}, {3, 2, 1});
  scene->appearance.resize(3);
  scene->coloring = Coloring{by, {}, {}};
  return scene;
}

}  // namespace

TEST_CASE("surface values are those of a known stretch by nodes or parameters, and zero for rigid motion") {
  for (const SurfaceQuantity by : {SurfaceQuantity::strain, SurfaceQuantity::displacement}) {
    const auto scene = soft_scene(by);
    Simulation simulation(scene->body, "rk4");
    FrameMeshes frame(*scene, simulation.model());
    const std::vector<NamedMesh>& meshes = frame.at(simulation.state());
    REQUIRE(meshes.size() == 3);
    CHECK(meshes[0].by_values);
    CHECK(meshes[1].by_values);
    CHECK_FALSE(meshes[2].by_values);
    for (const NamedMesh& named : meshes) REQUIRE(named.values.size() == named.mesh.x.cols());
    const auto rest_distance = [&](int k) {
      return VecX<double>((meshes[static_cast<std::size_t>(k)].mesh.x.colwise() -
                           simulation.model().position(simulation.state(), k))
                              .colwise()
                              .norm() /
                          1.1);
    };
    for (int k : {0, 1}) {
      const VecX<double>& values = meshes[static_cast<std::size_t>(k)].values;
      if (by == SurfaceQuantity::strain)
        CHECK((values.array() - 0.105).abs().maxCoeff() < 1e-10);
      else
        CHECK((values - 0.1 * rest_distance(k)).cwiseAbs().maxCoeff() < 1e-10);
    }
    for (int i = 0; i < 10; ++i) simulation.step(1e-3);
    CHECK(frame.at(simulation.state())[2].values.isZero(0));
    CHECK(*frame.high_value(simulation.state()) > 0.02);
    scene->coloring->parts = {scene->body.parts()[2].get()};
    FrameMeshes rigid(*scene, simulation.model());
    CHECK(*rigid.high_value(simulation.state()) == 0);
  }
}

TEST_CASE("a soft part in pure translation has values of rounding size") {
  auto scene = std::make_unique<Scene>();
  scene->body.gravity.setZero();
  Part& soft = scene->body.add(make_part("soft", "ellipsoid", {}, 1000));
  LocalSettings settings;
  settings.resolution = 2;
  settings.energies = {local_law("neo_hookean", {1e5, 0.3})};
  soft.deform_locally(std::move(settings)).velocity({5, -3, 2}, {0, 0, 0});
  scene->appearance.resize(1);
  for (const SurfaceQuantity by : {SurfaceQuantity::strain, SurfaceQuantity::displacement}) {
    scene->coloring = Coloring{by, {}, {}};
    Simulation simulation(scene->body, "rk4");
    FrameMeshes frame(*scene, simulation.model());
    for (int i = 0; i < 50; ++i) simulation.step(1e-3);
    CHECK(frame.at(simulation.state())[0].values.cwiseAbs().maxCoeff() < 1e-12);
  }
}

TEST_CASE("only surface nodes of a soft solid are in its mesh, while the state has all nodes") {
  const auto scene = soft_scene(SurfaceQuantity::strain);
  const Simulation simulation(scene->body);
  FrameMeshes frame(*scene, simulation.model());
  const TriangleMesh& mesh = frame.at(simulation.state())[0].mesh;
  const LocalMesh& nodes = scene->body.parts()[0]->local()->mesh();
  CHECK(mesh.x.cols() < nodes.X.rows());
  CHECK(mesh.triangles.cols() == nodes.triangles.cols());
  std::vector<bool> used(static_cast<std::size_t>(mesh.x.cols()));
  for (const int vertex : mesh.triangles.reshaped()) used[static_cast<std::size_t>(vertex)] = true;
  CHECK(std::count(used.begin(), used.end(), true) == mesh.x.cols());
  const Nodes all = simulation.model().node_positions(simulation.state(), 0);
  const Mat3<double> R = simulation.model().orientation(simulation.state(), 0).toRotationMatrix();
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const Vec3<double> x =
          R * all.row(nodes.triangles(k, t)).transpose() + simulation.model().position(simulation.state(), 0);
      REQUIRE((mesh.x.col(mesh.triangles(k, t)) - x).norm() < 1e-15);
    }
  CHECK(simulation.state().q.size() >= 3 * nodes.X.rows());
  const ReadObj obj = read_obj(obj_text(frame.at(simulation.state())));
  Eigen::Index vertices = 0;
  for (const NamedMesh& named : frame.at(simulation.state())) vertices += named.mesh.x.cols();
  CHECK(static_cast<Eigen::Index>(obj.x.size()) == vertices);
}

TEST_CASE("PLY vertices have the surface values as a property with the name of the quantity") {
  const NewFolder folder;
  const auto scene = soft_scene(SurfaceQuantity::strain);
  const Simulation simulation(scene->body);
  FrameMeshes frame(*scene, simulation.model());
  const std::vector<NamedMesh>& meshes = frame.at(simulation.state());
  const std::string plain = ply_bytes(meshes), bytes = ply_bytes(meshes, "strain"), mark = "end_header\n";
  CHECK(plain.find("strain") == std::string::npos);
  CHECK(bytes.find("property int part\nproperty double strain\nelement face") != std::string::npos);
  const std::size_t data = bytes.find(mark) + mark.size();
  std::size_t vertex = 0;
  for (const NamedMesh& named : meshes)
    for (const double value : named.values) {
      double written = 0;
      std::memcpy(&written, bytes.data() + data + 51 * vertex++ + 43, sizeof written);
      REQUIRE(written == value);
    }
  CHECK(bytes.size() - data == plain.size() - plain.find(mark) - mark.size() + 8 * vertex);
}

}  // namespace mesh_files_test
