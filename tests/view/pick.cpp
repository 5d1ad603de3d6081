// The camera of the mouse, and the point of a part under the mouse.
#include <pliant/view/pick.h>

#include <algorithm>

#include <pliant/body/placed_point.h>
#include <pliant/render/camera.h>
#include <pliant/scene/read_scene.h>

#include "catch.h"

namespace pick_test {

using namespace pliant;

TEST_CASE("a ray through the place of a point in the window passes through the point") {
  Camera camera{{3, -4, 2}, {0.2, 0.1, 0.4}, {0, 0, 1}, 40};
  for (const Vec3<double>& x :
       {Vec3<double>(0, 0, 0), Vec3<double>(0.5, -0.3, 1), Vec3<double>(-1, 1, 0.2)}) {
    const Vec3<double> place = place_in_window(camera, x, 800, 500);
    const Ray ray = ray_at(camera, place[0], place[1], 800, 500);
    CHECK(ray.direction.cross(x - ray.origin).norm() <= 1e-12);
    CHECK((in_view_plane(camera, ray, x) - x).norm() <= 1e-12);
  }
}

TEST_CASE("the mouse turns, moves and zooms the camera about its target") {
  Camera camera{{3, -4, 2}, {0, 0, 0}, {0, 0, 1}, 40};
  const Camera before = camera;
  const double distance = before.eye.norm();
  orbit(camera, 0.5, 0);
  CHECK(camera.eye.norm() == Approx(distance));
  CHECK(camera.eye.z() == Approx(2));
  CHECK(camera.eye.head<2>().dot(before.eye.head<2>()) == Approx(0).margin(1e-12));  // a quarter turn
  orbit(camera, 0, -10);
  CHECK(camera.eye.z() > 0.999 * distance);  // from above, but not exactly
  CHECK(camera.eye.head<2>().norm() > 0.01 * distance);
  camera = before;
  // A point at the distance of the target follows the mouse.
  const Vec3<double> place = place_in_window(camera, camera.target, 800, 500);
  pan(camera, 100. / 500, 50. / 500);
  const Vec3<double> moved = place_in_window(camera, before.target, 800, 500);
  CHECK(moved[0] - place[0] == Approx(100));
  CHECK(moved[1] - place[1] == Approx(-50));
  zoom(camera, 2);
  CHECK((camera.eye - camera.target).norm() == Approx(distance / 2));
}

TEST_CASE("the material point under the mouse is where the mesh was hit") {
  Diagnostics diagnostics;
  const auto scene = parse_scene("scene", R"({"parts": [
    {"name": "ball", "shape": "superellipsoid", "parameters": {"a1": 0.4, "a2": 0.3, "a3": 0.5, "eps1": 0.7}, "resolution": 24},
    {"name": "ring", "shape": "supertoroid", "position": [3, 0, 0], "resolution": 24},
    {"name": "bent", "shape": "box", "deformations": ["bend"], "parameters": {"bend.angle": 0.5}, "position": [-3, 0, 0], "resolution": 24},
    {"name": "jelly", "shape": "sphere", "position": [0, 3, 0], "local": {"resolution": 3, "laws": [{"type": "neo_hookean", "E": 20000, "nu": 0.3}]}}]})",
                                 {}, diagnostics);
  const Model model(scene->body);
  FrameMeshes meshes(*scene, model);
  const State state = model.initial_state();
  const std::vector<NamedMesh>& shown = meshes.at(state);
  const SurfacePoints points(*scene, model);
  int hits = 0;
  for (std::size_t i = 0; i < shown.size(); ++i) {
    const TriangleMesh& mesh = shown[i].mesh;
    const double size = scene->body.parts()[i]->size();
    for (Eigen::Index k = 0; k < mesh.triangles.cols();
         k += std::max<Eigen::Index>(1, mesh.triangles.cols() / 50)) {
      // A ray from outside, along the normal of a triangle, to a point in it.
      const Vec3<double> a = mesh.x.col(mesh.triangles(0, k)), b = mesh.x.col(mesh.triangles(1, k)),
                         c = mesh.x.col(mesh.triangles(2, k));
      const Vec3<double> inside = 0.5 * a + 0.3 * b + 0.2 * c, out = (b - a).cross(c - a).normalized();
      const std::optional<Hit> hit = first_hit({shown[i]}, {inside + 1e-3 * size * out, -out});
      REQUIRE(hit);
      CHECK(hit->triangle == k);
      CHECK((hit->position - inside).norm() <= 1e-9);
      const std::optional<Point> point = points.at({i, hit->triangle, hit->weights, hit->position});
      REQUIRE(point);
      CHECK(point->part->name() == shown[i].name);
      // The mesh differs from the surface by the height of its triangles, and a point of the jelly is
      // the mean over a patch.
      Point exact = *point;
      exact.patch = 0;
      CHECK((PlacedPoint(model, exact).at(state) - inside).norm() <= 0.06 * size);
      ++hits;
    }
  }
  CHECK(hits >= 200);
  CHECK_FALSE(first_hit(shown, {{0, 0, 10}, {0, 0, 1}}));
}

}  // namespace pick_test
