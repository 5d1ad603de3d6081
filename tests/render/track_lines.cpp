// Tracks are curves at any frame rate: their points are on the path of the tracked point, and the lines
// between these points are close to this path.
#include <pliant/render/track_lines.h>

#include <algorithm>
#include <cmath>

#include "catch.h"
#include "io/new_folder.h"

#include <pliant/io/run/run.h>
#include <pliant/part/registry.h>

namespace track_lines_test {

using namespace pliant;

namespace {

constexpr double kRadius = 1.5, kTurnRate = 20;  // orbit: radius, m, and angular velocity, rad/s

/// Returns a scene with a ball that orbits the origin on a spring of rest length 0, and a ball at rest. Their
/// centres are tracked. Between two pictures the ball makes more than one turn.
std::unique_ptr<Scene> orbit() {
  auto scene = std::make_unique<Scene>();
  scene->end = 1;
  scene->frame_rate = 2;
  scene->body.gravity.setZero();
  Part& ball = scene->body.add(make_part("ball", "sphere", {}, 1000));
  ball.rest({{"r", 0.1}}).place({kRadius, 0, 0}).velocity({0, kTurnRate * kRadius, 0}, {0, 0, 0});
  Part& still = scene->body.add(make_part("still", "sphere", {}, 1000));
  still.rest({{"r", 0.1}}).place({0, 0, 1});
  const double mass = 1000 * 4 * kPi / 3 * std::pow(0.1, 3);
  scene->body.spring("radius", point(ball, 0, 0, 0), world(0, 0, 0), mass * kTurnRate * kTurnRate, 0);
  scene->appearance.resize(2);
  scene->tracks.push_back({"orbit", point(ball, 0, 0, 0), {}});
  scene->tracks.push_back({"still", point(still, 0, 0, 0), {}});
  return scene;
}

/// Runs the scene, and checks its lines. error: largest distance of a point from the path of the ball, m.
void check_lines(Scene& scene, double error) {
  const NewFolder folder;
  Progress silent;
  RunOptions options;
  options.folder = folder / "r";
  Run run(scene, options, silent);
  REQUIRE(run.simulate());
  const Recording recording = run.recording();
  const std::vector<TrackLine> lines = track_lines(scene.tracks, run.simulation().model(), recording);
  REQUIRE(lines.size() == 2);

  const std::vector<Vec3<double>>& points = lines[0].points();
  double turned = 0, farthest = 0, widest = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    farthest = std::max(farthest, std::abs(points[i].norm() - kRadius));
    if (i == 0) continue;
    const double turn =
        std::acos(std::clamp(points[i].normalized().dot(points[i - 1].normalized()), -1., 1.));
    turned += turn;
    widest = std::max(widest, turn);
  }
  CHECK(farthest < error);
  CHECK(turned == Approx(kTurnRate * scene.end).epsilon(0.01));  // more than three turns
  // The line between two points is nearer to the circle than a thousandth of the box around the circle.
  CHECK(kRadius * (1 - std::cos(widest / 2)) < 1e-3 * std::sqrt(8.0) * kRadius);
  // Points that are nearer to each other than this distance are left out.
  CHECK(static_cast<double>(points.size()) < kTurnRate * scene.end / (1e-3 * std::sqrt(8.0)));

  CHECK(lines[1].points().size() == 1);
  State middle = recording.at(0.5 * scene.end);
  const Picture::Track half = lines[0].until(middle);
  CHECK(half.points.size() > points.size() / 2 - 5);
  CHECK(half.points.size() < points.size() / 2 + 5);
  CHECK(half.points.back() == lines[0].at(middle));
}

}  // namespace

TEST_CASE("the track of a fast circular motion is a circle at a low frame rate, with fixed steps") {
  const std::unique_ptr<Scene> scene = orbit();
  scene->integrator = "rk4";
  scene->step = 0.01;                   // 0.2 rad
  check_lines(*scene, 1e-4 * kRadius);  // the cubic interpolation has an error of 0.2^4 / 384
}

TEST_CASE("the track of a fast circular motion is a circle at a low frame rate, with error control") {
  const std::unique_ptr<Scene> scene = orbit();
  scene->integrator = "dop853";
  scene->tolerance = 1e-8;
  check_lines(*scene, 1e-4 * kRadius);
}

TEST_CASE("points at rest need no states between those of the frames") {
  const std::unique_ptr<Scene> scene = orbit();
  scene->integrator = "rk4";
  scene->step = 0.01;
  scene->tracks.erase(scene->tracks.begin());
  const NewFolder folder;
  Progress silent;
  RunOptions options;
  options.folder = folder / "r";
  Run run(*scene, options, silent);
  REQUIRE(run.simulate());
  CHECK(run.recording().rows() == 3);  // at 0, 0.5 and 1 s
}

}  // namespace track_lines_test
