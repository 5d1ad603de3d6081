// Pictures of a recorded motion. All frames have one camera and one ground, the tracks grow, and the settings
// of the scene are used.
#include <pliant/render/film.h>

#include "catch.h"
#include "io/new_folder.h"
#include "io/test_scenes.h"
#include "scenes.h"

#include <pliant/io/run/run.h>

namespace film_test {

using namespace pliant;

namespace {

// A run of pulled_scene(), and its film.
struct FilmedRun {
  NewFolder folder;
  std::unique_ptr<Scene> scene = pulled_scene();
  Progress silent;
  std::unique_ptr<Run> run;
  std::unique_ptr<Recording> recording;

  FilmedRun() {
    RunOptions options;
    options.folder = folder / "r";
    run = std::make_unique<Run>(*scene, options, silent);
    REQUIRE(run->simulate());
    recording = std::make_unique<Recording>(run->recording());
  }
  Film film() const { return {*scene, run->simulation().model(), *recording}; }
};

bool equal(const Camera& a, const Camera& b) {
  return a.eye == b.eye && a.target == b.target && a.field_of_view == b.field_of_view;
}

}  // namespace

TEST_CASE("camera and ground do not move, and show the whole motion") {
  const FilmedRun filmed;
  Film film = filmed.film();
  const Camera camera = film.camera();
  const double ground = film.at(0).ground.height;
  for (int k = 0; k <= 10; ++k) {
    const Picture& picture = film.at(0.02 * k);
    CHECK(equal(picture.camera, camera));
    CHECK(picture.ground.height == ground);
    CHECK(bounds(picture).min().z() > ground);
    CHECK(picture.bodies.size() == 4);
    // One tracked point, the lines of three springs, the dot at the world end of one spring, and the line and
    // the dot (world end) of a string.
    REQUIRE(picture.tracks.size() == 1 + 3 + 1 + 2);
    CHECK((k > 0) == (picture.tracks[0].points.size() > 1));
    // Every vertex is inside the picture.
    const Eigen::Vector3d back = (camera.eye - camera.target).normalized();
    const Eigen::Vector3d right = camera.up.cross(back).normalized(), up = back.cross(right);
    const double half = std::tan(camera.field_of_view * kPi / 360);
    for (const Picture::Body& body : picture.bodies)
      for (Eigen::Index i = 0; i < body.mesh->x.cols(); ++i) {
        const Eigen::Vector3d p = body.mesh->x.col(i) - camera.eye;
        const double depth = -back.dot(p);
        CHECK(depth > 0);
        CHECK(std::abs(up.dot(p)) < half * depth);
        CHECK(std::abs(right.dot(p)) < half * depth * 640 / 480);
      }
  }
}

TEST_CASE("the camera does not depend on the pictures that were made before") {
  const FilmedRun filmed;
  Film first = filmed.film(), second = filmed.film();
  first.at(0.2);
  CHECK(equal(first.camera(), second.camera()));
}

TEST_CASE("the scene's settings of camera, light and ground are used") {
  FilmedRun filmed;
  Scene& scene = *filmed.scene;
  scene.camera.eye = Vec3<double>(1, 2, 3);
  scene.camera.field_of_view = 50;
  scene.ground.height = -2.5;
  scene.light.direction = Vec3<double>(0, 0, 1);
  scene.light.shadows = false;
  scene.appearance[1].visible = false;
  scene.appearance[0].color = {0.25, 0.5, 1};
  Film film = filmed.film();
  const Picture& picture = film.at(0.1);
  CHECK(picture.camera.eye == Eigen::Vector3d(1, 2, 3));
  CHECK(picture.camera.field_of_view == 50);
  CHECK(picture.ground.height == -2.5);
  CHECK(picture.lights.to_key == Eigen::Vector3f(0, 0, 1));
  CHECK_FALSE(picture.lights.shadows);
  REQUIRE(picture.bodies.size() == 3);
  CHECK(picture.bodies[0].color == Eigen::Vector3f(0.25f, 0.5f, 1));
  scene.camera.target = Vec3<double>(0, 0, 1);
  CHECK(filmed.film().camera().target == Eigen::Vector3d(0, 0, 1));
}

TEST_CASE("a spring is drawn as a line between its points, with a dot at a point of the world") {
  const FilmedRun filmed;
  Film film = filmed.film();
  const Picture& picture = film.at(0.1);
  const Picture::Track &line = picture.tracks[1], &dot = picture.tracks[2];
  REQUIRE(line.points.size() == 2);
  REQUIRE(dot.points.size() == 1);
  CHECK(line.points[1] == dot.points[0]);
  CHECK(dot.points[0] == Eigen::Vector3d(0.4 + 0.2 * std::sin(9 * 0.1), 0, 1));
  CHECK(line.points[0] == picture.tracks[0].points.back());  // both are at u = v = 0 on the blob
  filmed.scene->show_springs = false;
  CHECK(filmed.film().at(0.1).tracks.size() == 1);
}

TEST_CASE("the camera includes the world points of springs, unless they are far away") {
  FilmedRun filmed;
  Scene& scene = *filmed.scene;
  scene.ground.visible = false;
  const Camera near = filmed.film().camera();
  scene.body.springs()[0]->b = world(0.4, 0, 3);
  const Camera higher = filmed.film().camera();
  CHECK(higher.target.z() > near.target.z());
  scene.body.springs()[0]->b = world(0.4, 0, 2000);
  const Camera without_springs = filmed.film().camera();
  scene.show_springs = false;
  CHECK(equal(filmed.film().camera(), without_springs));
}

TEST_CASE("deforming parts have one colour scale in all frames") {
  const FilmedRun filmed;
  filmed.scene->coloring = Coloring{SurfaceQuantity::displacement, {}, {}};
  Film film = filmed.film(), later = filmed.film();
  const Picture::Scale scale = *later.at(0.2).scale;
  CHECK(scale.title == "displacement (m)");
  CHECK(scale.low == 0);
  double largest = 0;
  for (int k = 0; k <= 10; ++k) {
    const Picture& picture = film.at(0.02 * k);
    REQUIRE(picture.scale);
    CHECK(picture.scale->high == scale.high);
    REQUIRE(picture.bodies[0].values != nullptr);  // the blob
    CHECK(picture.bodies[0].values->size() == picture.bodies[0].mesh->x.cols());
    for (std::size_t i = 1; i < 4; ++i) CHECK(picture.bodies[i].values == nullptr);  // rigid parts
    largest = std::max(largest, picture.bodies[0].values->maxCoeff());
  }
  CHECK(largest > 0.6 * scale.high);
  CHECK(largest < 1.1 * scale.high);

  filmed.scene->coloring->range = {-1, 3};
  filmed.scene->coloring->parts = {filmed.scene->body.parts()[1].get()};
  filmed.scene->coloring->by = SurfaceQuantity::strain;
  Film chosen = filmed.film();
  const Picture& picture = chosen.at(0.1);
  CHECK(picture.scale->title == "strain");
  CHECK(picture.scale->low == -1);
  CHECK(picture.scale->high == 3);
  CHECK(picture.bodies[0].values == nullptr);
  REQUIRE(picture.bodies[1].values != nullptr);
  CHECK(picture.bodies[1].values->isZero(0));
  filmed.scene->appearance[1].visible = false;
  CHECK_FALSE(filmed.film().at(0.1).scale);  // no part is coloured
}

TEST_CASE("the picture of a plane is at the position of the plane while the plane is active") {
  FilmedRun filmed;
  Scene& scene = *filmed.scene;
  scene.width = 160;
  scene.height = 120;
  scene.camera.eye = Vec3<double>(0, -6, 2);
  scene.camera.target = Vec3<double>(0, 0, 1);
  scene.ground.visible = scene.light.shadows = false;
  scene.ground.height = 0;
  ContactPlane& plane =
      scene.body.plane("sheet", TimeVector(TimeFunction::formula("1 - 10 * t"), -1, 1.5), {0, -1, 0});
  plane.off = 0.15;
  Renderer renderer(scene.width, scene.height);
  auto seen = [&](double time) {
    Film film = filmed.film();
    return renderer.draw(film.at(time));
  };
  for (const double time : {0.0, 0.1, 0.15}) {
    CAPTURE(time);
    const bool there = time < 0.15;
    scene.planes.clear();
    const Image without = seen(time);
    scene.planes.push_back({0, 0.8, 0.6, {1, 0, 0}});
    const Image with = seen(time);
    const Camera camera = filmed.film().camera();
    Eigen::AlignedBox2d around;  // the picture of the rectangle, with a margin of one pixel
    for (const double x : {-0.4, 0.4})
      for (const double z : {-0.3, 0.3})
        around.extend(test::pixel_of({1 - 10 * time + x, -1, 1.5 + z}, camera, scene.width, scene.height));
    around.min().array() -= 1;
    around.max().array() += 1;
    auto change = [&](int x, int y) {
      const std::array<int, 3> a = test::pixel(with, x, y), b = test::pixel(without, x, y);
      return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
    };
    int changed = 0, beside = 0;
    for (int y = 0; y < scene.height; ++y)
      for (int x = 0; x < scene.width; ++x)
        if (around.contains(Eigen::Vector2d(x + 0.5, y + 0.5)))
          changed += change(x, y) > 60;
        else
          beside = std::max(beside, change(x, y));
    CHECK(beside <= (there ? 4 : 0));  // light from the ground depends slightly on everything that is shown
    CHECK((changed > 0.8 * (around.sizes().array() - 2).prod()) == there);
    if (!there) CHECK(with.rgb == without.rgb);
  }
}

TEST_CASE("a camera that looks straight down has y at the top") {
  const FilmedRun filmed;
  filmed.scene->camera.eye = Vec3<double>(0, 0, 5);
  filmed.scene->camera.target = Vec3<double>(0, 0, 1);
  CHECK(filmed.film().camera().up == Eigen::Vector3d::UnitY());
  filmed.scene->camera.eye = Vec3<double>(0, 1, 5);
  CHECK(filmed.film().camera().up == Eigen::Vector3d::UnitZ());
}

}  // namespace film_test
