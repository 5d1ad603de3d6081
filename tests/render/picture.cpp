// Contents of pictures: light, shadows, edges, background, tracks, colour scales. Invalid pictures are
// refused.
#include <limits>

#include "catch.h"
#include "scenes.h"

#include <pliant/render/color_map.h>
#include <pliant/render/renderer.h>

namespace picture_test {

using namespace pliant;
using test::brightness;
using test::pixel;
using test::pixel_of;

namespace {

// Returns a camera that looks along +y at the origin, with x to the right and z up.
Camera front_camera(double distance) {
  return {{0, -distance, 0}, {0, 0, 0}, {0, 0, 1}, 30};
}

Picture picture_of(const TriangleMesh& mesh) {
  Picture picture;
  picture.bodies.push_back({&mesh, {0.7f, 0.7f, 0.7f}});
  picture.ground.shown = false;
  picture.camera = front_camera(6);
  return picture;
}

double mean_difference(const Image& a, const Image& b) {
  REQUIRE(a.rgb.size() == b.rgb.size());
  double sum = 0;
  for (std::size_t i = 0; i < a.rgb.size(); ++i) sum += std::abs(a.rgb[i] - b.rgb[i]);
  return sum / static_cast<double>(a.rgb.size());
}

/// Returns the message with which an invalid picture is refused, or an empty text.
std::string reason(Renderer& renderer, const Picture& picture) {
  try {
    renderer.draw(picture);
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "";
}

bool contains(const std::string& text, const char* part) {
  return text.find(part) != std::string::npos;
}

}  // namespace

TEST_CASE("a lit sphere is brightest towards the light and darkest away from it") {
  const TriangleMesh ball = test::sphere({0, 0, 0}, 1);
  Picture picture = picture_of(ball);
  picture.lights.to_key = {1, -0.3f, 0};
  Renderer renderer(161, 121);
  const Image image = renderer.draw(picture);
  const auto at = [&](double x, double z) {
    const double y = -std::sqrt(1 - x * x - z * z);
    return brightness(pixel(image, pixel_of({x, y, z}, picture.camera, 161, 121)));
  };
  CHECK(at(0.8, 0) > at(0.4, 0) + 20);
  CHECK(at(0.4, 0) > at(0, 0) + 20);
  CHECK(at(0, 0) > at(-0.6, 0) + 20);
  CHECK(at(-0.6, 0) > 30);                // ambient light reaches the side away from the key light
  CHECK(at(-0.6, 0.6) > at(-0.6, -0.6));  // ambient light is stronger from above
}

TEST_CASE("a body darkens the ground along the key light, and nowhere else") {
  const TriangleMesh ball = test::sphere({0, 0, 2}, 0.5);
  Picture picture = picture_of(ball);
  picture.ground.shown = true;
  picture.ground.grid_color = picture.ground.color;
  picture.lights.to_key = {1, 0, 1};
  picture.camera = {{0, -8, 6}, {0, 0, 0}, {0, 0, 1}, 50};
  Renderer renderer(200, 150);
  const Image with = renderer.draw(picture);
  const auto at = [&](const Image& image, const Eigen::Vector3d& p) {
    return brightness(pixel(image, pixel_of(p, picture.camera, 200, 150)));
  };
  const Eigen::Vector3d shadow(-2, 0, 0), lit(2, 0, 0);
  CHECK(at(with, shadow) < at(with, lit) - 60);
  picture.lights.shadows = false;
  const Image without = renderer.draw(picture);
  CHECK(std::abs(at(without, shadow) - at(without, lit)) <= 6);
  CHECK(std::abs(at(with, lit) - at(without, lit)) <= 6);
}

TEST_CASE("a body casts a shadow on another body") {
  const TriangleMesh low = test::sphere({0, 0, -1}, 0.8), high = test::sphere({0, 0, 1}, 0.4);
  Picture picture = picture_of(low);
  picture.camera = {{0, -7, 2}, {0, 0, 0}, {0, 0, 1}, 40};
  picture.lights.to_key = {0, -0.15f, 1};
  Renderer renderer(120, 120);
  const Eigen::Vector3d top(0, -0.25, -1 + std::sqrt(0.64 - 0.0625));
  const auto visible = [&] {
    return brightness(pixel(renderer.draw(picture), pixel_of(top, picture.camera, 120, 120)));
  };
  const int without_shadow = visible();
  picture.bodies.push_back({&high, {0.7f, 0.7f, 0.7f}});
  CHECK(visible() < without_shadow - 60);
}

TEST_CASE("a body dims the ground near its contact point, also outside its shadow") {
  const TriangleMesh ball = test::sphere({0, 0, 0.52}, 0.5);
  Picture picture = picture_of(ball);
  picture.ground.shown = true;
  picture.ground.grid_color = picture.ground.color;
  picture.camera = {{0, 5, 3}, {0, 0, 0}, {0, 0, 1}, 40};
  picture.lights.to_key = {0, -1, 0.6f};
  Renderer renderer(200, 150);
  const Image image = renderer.draw(picture);
  const auto at = [&](const Eigen::Vector3d& p) {
    return brightness(pixel(image, pixel_of(p, picture.camera, 200, 150)));
  };
  CHECK(at({0.42, 0.0, 0}) < at({1.6, 0, 0}) - 8);
}

TEST_CASE("the background is unchanged where there are no bodies") {
  Renderer renderer(90, 60);
  Picture empty;
  empty.ground.shown = false;
  empty.background = {{0.2f, 0.4f, 0.6f}, {0.9f, 0.8f, 0.7f}};
  const Image blank = renderer.draw(empty);
  for (int y = 0; y < 60; ++y)
    for (int x = 1; x < 90; ++x) REQUIRE(pixel(blank, x, y) == pixel(blank, 0, y));
  for (int c = 0; c < 3; ++c) {
    CHECK(std::abs(pixel(blank, 0, 0)[c] - 255 * static_cast<double>(empty.background.top[c])) <= 1);
    CHECK(std::abs(pixel(blank, 0, 59)[c] - 255 * static_cast<double>(empty.background.bottom[c])) <= 1);
  }

  const TriangleMesh ball = test::sphere({0, 0, 0}, 0.5);
  Picture picture = picture_of(ball);
  picture.background = empty.background;
  const Image image = renderer.draw(picture);
  int touched = 0;
  for (int y = 0; y < 60; ++y)
    for (int x = 0; x < 90; ++x) {
      const double r = std::hypot(x + 0.5 - 45, y + 0.5 - 30);
      const bool same = pixel(image, x, y) == pixel(blank, x, y);
      if (r > 11) REQUIRE(same);
      if (r < 8) REQUIRE(!same);
      touched += !same;
    }
  CHECK(touched > 150);
}

TEST_CASE("any size works, also odd sizes and single pixels") {
  const test::Scene scene;
  for (const auto& [width, height] :
       {std::pair(1, 1), std::pair(3, 1), std::pair(1, 7), std::pair(101, 77)}) {
    Renderer renderer(width, height);
    const Image image = renderer.draw(scene.picture);
    CHECK(image.width == width);
    CHECK(image.height == height);
    CHECK(image.rgb.size() == static_cast<std::size_t>(width * height * 3));
  }
}

TEST_CASE("a size out of range is refused with a message") {
  for (const auto& [width, height] :
       {std::pair(0, 480), std::pair(640, 0), std::pair(-5, 480), std::pair(640, -1),
        std::pair(Renderer::kMaxSide + 1, 10), std::pair(10, 2000000000)}) {
    CAPTURE(width, height);
    CHECK_THROWS_AS(Renderer(width, height), std::invalid_argument);
  }
  try {
    Renderer renderer(640, 0);
  } catch (const std::invalid_argument& error) {
    CHECK(std::string(error.what()) == "picture: the height of 0 pixels is not in [1, 8192]");
  }
}

TEST_CASE("corners with their own normals keep an edge sharp") {
  const TriangleMesh sharp = test::cube({0, 0, 0}, 0.7, 0.78539816339744831);
  TriangleMesh smooth = sharp;
  smooth.normals = sharp.x.colwise().normalized();
  smooth.corners = sharp.triangles;
  Renderer renderer(640, 480);
  const auto step = [&](const TriangleMesh& mesh) {
    Picture picture = picture_of(mesh);
    picture.lights.to_key = {-0.6f, -1, 0.3f};  // the light reaches both faces
    const Image image = renderer.draw(picture);
    const int far_left = brightness(pixel(image, 320 - 80, 240)),
              left = brightness(pixel(image, 320 - 3, 240));
    const int right = brightness(pixel(image, 320 + 2, 240)),
              far_right = brightness(pixel(image, 320 + 79, 240));
    CHECK(far_left > far_right + 60);
    return left - right;
  };
  CHECK(step(sharp) > 150);
  CHECK(step(smooth) < 40);
}

TEST_CASE("a plane under grazing light does not shade itself") {
  const TriangleMesh box = test::cube({0, 0, 0}, 0.7, 0.78539816339744831);
  Renderer renderer(320, 240);
  for (const float slant : {0.95f, 0.8f, 0.4f, 0.0f}) {
    Picture picture = picture_of(box);
    picture.lights.to_key = {-slant, -1, 0.2f};
    const Image image = renderer.draw(picture);
    for (int x = 165; x < 225; ++x) {
      CAPTURE(slant, x);
      REQUIRE(std::abs(brightness(pixel(image, x, 120)) - brightness(pixel(image, x - 1, 120))) <= 3);
    }
  }
}

TEST_CASE("a track is visible above the ground and hidden behind a body") {
  const TriangleMesh ball = test::sphere({0, 0, 0}, 0.8);
  Picture picture = picture_of(ball);
  picture.tracks.push_back({{{-2, 1, 0}, {2, 1, 0}}, {0.9f, 0.1f, 0.1f}, 4});
  picture.tracks.push_back({{{0, -2, 0.3}}, {0.1f, 0.9f, 0.1f}, 6});
  Renderer renderer(160, 120);
  const Image image = renderer.draw(picture);
  const auto at = [&](const Eigen::Vector3d& p) {
    return pixel(image, pixel_of(p, picture.camera, 160, 120));
  };
  const auto red = at({-1.5, 1, 0.0}), hidden = at({0, 1, 0}), dot = at({0, -2, 0.3});
  CHECK((red[0] > 220 && red[1] < 40));
  CHECK(std::abs(hidden[0] - hidden[1]) < 25);
  CHECK((dot[1] > 220 && dot[0] < 40));
}

TEST_CASE("a track that passes behind the eye is clipped, not mirrored") {
  Picture picture;
  picture.ground.shown = false;
  picture.camera = front_camera(6);
  Renderer renderer(80, 60);
  const Image blank = renderer.draw(picture);
  picture.tracks.push_back({{{0, -20, -1}, {0, -15, -1}, {0, -12, -1}}, {0, 0, 0}, 3});
  CHECK(renderer.draw(picture).rgb == blank.rgb);
  picture.tracks[0].points.push_back({0, 5, -1});
  const Image image = renderer.draw(picture);
  CHECK(brightness(pixel(image, pixel_of({0, 2, -1}, picture.camera, 80, 60))) < 60);
  for (int x = 0; x < 80; ++x) REQUIRE(pixel(image, x, 10) == pixel(blank, x, 10));
}

TEST_CASE("a frame depends only on its picture, not on previous frames") {
  const test::Scene scene;
  const TriangleMesh ball = test::sphere({0, 0, 1}, 1, 9, 14);
  Renderer renderer(120, 90), fresh(120, 90);
  const Image first = renderer.draw(scene.picture);
  renderer.draw(picture_of(ball));
  Picture fewer = scene.picture;
  fewer.bodies.pop_back();
  const Image second = renderer.draw(fewer);
  CHECK(second.rgb == fresh.draw(fewer).rgb);
  CHECK(renderer.draw(scene.picture).rgb == first.rgb);
  CHECK(second.rgb != first.rgb);

  test::Scene moved;
  moved.meshes[0].x.row(2).array() += 0.5;
  CHECK(renderer.draw(moved.picture).rgb == fresh.draw(moved.picture).rgb);
}

TEST_CASE("a picture far from the origin of the world looks equal") {
  const test::Scene near, far({4e6, -2e6, 1e5});
  Renderer renderer(160, 120);
  CHECK(mean_difference(renderer.draw(near.picture), renderer.draw(far.picture)) < 0.05);
}

TEST_CASE("scenes of any scale look equal") {
  Renderer renderer(160, 120);
  const TriangleMesh unit = test::sphere({0, 0, 1}, 1);
  Picture picture = picture_of(unit);
  picture.ground.shown = true;
  picture.camera = automatic_camera(bounds(picture), 4.0 / 3);
  const Image image = renderer.draw(picture);
  for (const double scale : {1e-5, 1e7}) {
    TriangleMesh mesh = unit;
    mesh.x *= scale;
    Picture scaled = picture;
    scaled.bodies[0].mesh = &mesh;
    scaled.camera = automatic_camera(bounds(scaled), 4.0 / 3);
    CHECK(mean_difference(image, renderer.draw(scaled)) < 0.5);  // sizes of shadow texels are discrete
  }
}

TEST_CASE("invalid pictures are refused with the place of the error, and the renderer stays usable") {
  const double nan = std::numeric_limits<double>::quiet_NaN(), huge = std::numeric_limits<double>::infinity();
  test::Scene scene;
  const Picture good = scene.picture;
  Renderer renderer(64, 48);
  const Image before = renderer.draw(good);
  const auto refused = [&](auto change, const char* part) {
    Picture bad = good;
    change(bad);
    const std::string text = reason(renderer, bad);
    CAPTURE(part, text);
    CHECK(contains(text, part));
    CHECK(renderer.draw(good).rgb == before.rgb);
  };
  const auto bad_mesh = [&](auto change, const char* part) {
    TriangleMesh mesh = scene.meshes[1];
    change(mesh);
    refused([&](Picture& p) { p.bodies[1].mesh = &mesh; }, part);
  };
  refused([](Picture& p) { p.bodies[2].mesh = nullptr; }, "body 2 has no mesh");
  refused([](Picture& p) { p.bodies[1].color[0] = 1.5f; }, "the color of body 1");
  refused([](Picture& p) { p.tracks[0].color[2] = std::nanf(""); }, "the color of track 0");
  refused([](Picture& p) { p.tracks[0].width = 0; }, "track 0 must have a width");
  refused([&](Picture& p) { p.tracks[0].points[3][1] = nan; }, "track 0 is not finite");
  refused([](Picture& p) { p.camera.eye = p.camera.target; }, "are at one point");
  refused([&](Picture& p) { p.camera.eye[0] = huge; }, "camera");
  refused([](Picture& p) { p.camera.up = p.camera.eye - p.camera.target; }, "up direction");
  refused([](Picture& p) { p.camera.field_of_view = 180; }, "field_of_view");
  refused([](Picture& p) { p.lights.to_key.setZero(); }, "to_key");
  refused([](Picture& p) { p.lights.sky[1] = -1; }, "lights.sky");
  refused([](Picture& p) { p.background.top[1] = 2; }, "background.top");
  refused([](Picture& p) { p.ground.spacing = -1; }, "spacing");
  refused([&](Picture& p) { p.ground.height = nan; }, "height");
  VecX<double> values = VecX<double>::Zero(scene.meshes[1].x.cols());
  const auto bad_values = [&](auto change, const char* part) {
    refused(
        [&](Picture& p) {
          p.bodies[1].values = &values;
          p.scale = {"", 0, 1};
          change(p);
        },
        part);
  };
  bad_values([](Picture& p) { p.scale->high = 0; }, "the scale");
  bad_values([&](Picture& p) { p.scale->low = -huge; }, "the scale");
  bad_values([&](Picture& p) { p.scale->high = nan; }, "the scale");
  bad_values([&](Picture&) { values[3] = nan; }, "body 1 must have one finite value");
  bad_values([&](Picture&) { values.resize(5); }, "body 1 must have one finite value");
  bad_mesh([](TriangleMesh& m) { m.triangles(0, 5) = static_cast<int>(m.x.cols()); },
           "body 1 has triangles with vertices");
  bad_mesh([](TriangleMesh& m) { m.corners(2, 5) = -1; }, "body 1 has triangles with normals");
  bad_mesh([](TriangleMesh& m) { m.x.conservativeResize(3, 4); }, "body 1 has triangles with vertices");
  bad_mesh([](TriangleMesh& m) { m.corners.conservativeResize(3, 4); }, "body 1 must have one triple");
  bad_mesh([&](TriangleMesh& m) { m.x(1, 7) = nan; }, "body 1 is not finite");
  bad_mesh([&](TriangleMesh& m) { m.x(1, 7) = 1e300; }, "body 1 is not finite");
  bad_mesh([&](TriangleMesh& m) { m.normals(0, 7) = nan; }, "body 1 is not finite");
}

TEST_CASE("a body with values has the colours of the scale") {
  const TriangleMesh ball = test::sphere({0, 0, 0}, 1);
  const VecX<double> height = ball.x.row(2).transpose();
  Picture picture = picture_of(ball);
  // Without a key light, all sides of the ball have about equal brightness.
  picture.lights.key_strength = 0;
  picture.lights.sky = picture.lights.bounce = {1, 1, 1};
  picture.lights.ambient_strength = 0.8f;
  Renderer renderer(400, 300);
  const Image plain = renderer.draw(picture);
  picture.bodies[0].values = &height;
  CHECK(renderer.draw(picture).rgb == plain.rgb);  // without a scale the values are not used
  picture.scale = {"height (m)", -0.5, 0.5};
  const Image image = renderer.draw(picture);
  for (const double z : {-0.8, -0.45, -0.2, 0.0, 0.25, 0.45, 0.8}) {
    const Eigen::Vector3d at(0, -std::sqrt(1 - z * z), z);
    const std::array<int, 3> seen = pixel(image, pixel_of(at, picture.camera, 400, 300));
    const Eigen::Vector3f asked = mapped_color(z + 0.5);
    CAPTURE(z, seen[0], seen[1], seen[2]);
    // This light changes the values of the channels (red, green, blue), but not the order of these values.
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (asked[i] > asked[j] + 0.1f) CHECK(seen[i] > seen[j]);
  }
  // Outside the scale the colour is constant.
  const auto same = [&](double z1, double z2) {
    const auto a = pixel(image, pixel_of({0, -std::sqrt(1 - z1 * z1), z1}, picture.camera, 400, 300)),
               b = pixel(image, pixel_of({0, -std::sqrt(1 - z2 * z2), z2}, picture.camera, 400, 300));
    return std::abs(a[0] - b[0]) + std::abs(a[1] - b[1]) + std::abs(a[2] - b[2]);
  };
  CHECK(same(0.56, 0.62) < 12);
  CHECK(same(0.1, 0.3) > 40);
}

TEST_CASE("the colour bar is at the right, with its colours, ticks and title") {
  const TriangleMesh ball = test::sphere({0, 0, 0}, 0.5);
  const VecX<double> values = VecX<double>::Zero(ball.x.cols());
  Picture picture = picture_of(ball);
  picture.background.top = picture.background.bottom = {0.4f, 0.5f, 0.6f};
  Renderer renderer(640, 480);
  const Image without = renderer.draw(picture);
  picture.bodies[0].values = &values;
  picture.scale = {"strain", 0, 0.2};
  const Image with = renderer.draw(picture);
  // The columns of the bar are those that contain a pixel of the middle colour.
  const auto near = [](const std::array<int, 3>& p, const Eigen::Vector3f& color) {
    for (int c = 0; c < 3; ++c)
      if (std::abs(p[static_cast<std::size_t>(c)] - 255 * static_cast<double>(color[c])) > 3) return false;
    return true;
  };
  int left = 640, right = 0, top = 480, bottom = 0;
  for (int y = 0; y < 480; ++y)
    for (int x = 500; x < 640; ++x)
      if (near(pixel(with, x, y), mapped_color(0.5))) left = std::min(left, x), right = std::max(right, x);
  REQUIRE(right - left >= 8);
  REQUIRE(right - left <= 24);
  const int middle = (left + right) / 2;
  for (int y = 0; y < 480; ++y) {
    if (near(pixel(with, middle, y), mapped_color(1)) && top == 480) top = y;
    if (near(pixel(with, middle, y), mapped_color(0))) bottom = y;
  }
  REQUIRE(bottom - top > 200);
  for (int y = top + 2; y < bottom - 2; ++y)
    CHECK(near(pixel(with, middle, y), mapped_color((bottom + 0.5 - y) / (bottom + 1 - top))));
  // Beside the bar there are the dark marks of five ticks, and above the bar there are letters. Left of the
  // bar the picture with a scale and the picture without a scale are equal.
  const auto dark = [&](int x, int y) { return brightness(pixel(with, x, y)) < 200; };
  int marks = 0;
  for (int y = top - 4; y < bottom + 4; ++y) marks += dark(right + 4, y) && !dark(right + 4, y - 1);
  CHECK(marks == 5);
  int ink = 0, label_ink = 0;
  for (int y = top - 30; y < top - 4; ++y)
    for (int x = 560; x < 640; ++x) ink += dark(x, y);
  for (int y = top - 6; y < bottom + 6; ++y)
    for (int x = right + 8; x < 640; ++x) label_ink += dark(x, y);
  CHECK(ink > 60);
  CHECK(label_ink > 100);
  for (int y = 0; y < 480; ++y)
    for (int x = 420; x < 540; ++x) REQUIRE(pixel(with, x, y) == pixel(without, x, y));
  // A picture that is too small has no colour bar.
  Renderer small(120, 90);
  picture.bodies[0].values = nullptr;
  const Image tiny = small.draw(picture);
  picture.scale.reset();
  CHECK(tiny.rgb == small.draw(picture).rgb);
}

TEST_CASE("bodies without triangles draw nothing") {
  const TriangleMesh none;
  test::Scene scene;
  Renderer renderer(64, 48);
  const Image before = renderer.draw(scene.picture);
  scene.picture.bodies.insert(scene.picture.bodies.begin() + 1, {&none, {0, 0, 0}});
  CHECK(renderer.draw(scene.picture).rgb == before.rgb);
}

}  // namespace picture_test
