// Contact of parts with fixed meshes: a flat mesh acts as a plane, parts roll over ridges, thin meshes stop
// fast parts, and invalid meshes are refused.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include <pliant/collision/mesh/obstacle_mesh.h>
#include <pliant/part/mesh/surface.h>

#include "draws.h"
#include "motion.h"

namespace obstacle_test {

using namespace pliant;
using test::Draws;

namespace {

struct Mesh {
  Eigen::Matrix3Xd x;
  Eigen::Matrix3Xi triangles;
};

/// Returns a grid of n x n squares over [-1, 1]^2, two triangles each, mapped into space by `map`. Before
/// the map is applied, the inner vertices are displaced at random along x and y, by up to `random` times
/// their spacing.
Mesh sheet(int n, double random, const std::function<Vec3<double>(double, double)>& map) {
  Draws draws(7);
  Mesh mesh;
  mesh.x.resize(3, (n + 1) * (n + 1));
  mesh.triangles.resize(3, 2 * n * n);
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j) {
      const bool inner = i > 0 && j > 0 && i < n && j < n;
      const double dx = inner ? random * draws.uniform(-1, 1) : 0,
                   dy = inner ? random * draws.uniform(-1, 1) : 0;
      mesh.x.col(i * (n + 1) + j) = map(2 * (i + dx) / n - 1, 2 * (j + dy) / n - 1);
    }
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j) {
      const int a = i * (n + 1) + j, b = a + n + 1, t = 2 * (i * n + j);
      mesh.triangles.col(t) << a, b, b + 1;
      mesh.triangles.col(t + 1) << a, b + 1, a + 1;
    }
  return mesh;
}

Part& ball(MultiBody& body, double r, const Vec3<double>& at) {
  return body.add(make_part("ball", "sphere", {}, 1000)).rest({{"r", r}}).place(at);
}
Part& box(MultiBody& body, const Vec3<double>& half, const Vec3<double>& at,
          const Eigen::Quaterniond& R = Eigen::Quaterniond::Identity()) {
  Part& part = body.add(make_part("box", "box", {}, 1000));
  return part.rest({{"a1", half[0]}, {"a2", half[1]}, {"a3", half[2]}}).place(at, R);
}

/// Adds a floor of many triangles, or a plane, inclined by `angle` (rad).
void floor(MultiBody& body, bool tessellated, double angle) {
  const Eigen::Quaterniond R(Eigen::AngleAxisd(angle, Vec3<double>::UnitY()));
  if (!tessellated) {
    body.plane("floor", Vec3<double>(0, 0, 0), R * Vec3<double>::UnitZ());
    return;
  }
  const Mesh mesh =
      sheet(37, 0.3, [&](double x, double y) -> Vec3<double> { return R * Vec3<double>(3 * x, 3 * y, 0); });
  body.obstacle("floor", mesh.x, mesh.triangles);
}

}  // namespace

TEST_CASE("a flat floor of triangles acts as a plane for rolling, sliding and bouncing", "[contact]") {
  const double angle = 0.3;
  const Eigen::Quaterniond R(Eigen::AngleAxisd(angle, Vec3<double>::UnitY()));
  for (const std::string what : {"rolling", "sliding", "bouncing", "tumbling"}) {
    INFO(what);
    std::vector<State> end;
    for (const bool tessellated : {false, true}) {
      MultiBody body;
      body.contact.friction = what == "sliding" ? 0.1 : 0.6;
      if (what == "bouncing") body.contact.restitution = 0.7;
      if (what == "rolling" || what == "bouncing")
        ball(body, 0.11, R * Vec3<double>(0.013, 0.1, what == "rolling" ? 0.11 : 0.3))
            .velocity(R * Vec3<double>(0.3, 0.5, 0), {0.1, 0, 0});
      else
        box(body, {0.2, 0.15, 0.1}, R * Vec3<double>(0.013, 0.1, what == "sliding" ? 0.1 : 0.35), R)
            .velocity(R * Vec3<double>(0.3, 0.5, 0),
                      what == "sliding" ? Vec3<double>(0, 0, 0) : Vec3<double>(1, 2, 0));
      floor(body, tessellated, angle);
      Simulation simulation(body, "rk4");
      // A tumbling box is chaotic: rounding errors grow.
      test::run(simulation, what == "tumbling" ? 0.3 : 0.8, what == "tumbling" ? 150 : 400);
      end.push_back(simulation.state());
      CHECK(simulation.ledger().kinetic > 0.1);
    }
    CHECK((end[1].q - end[0].q).cwiseAbs().maxCoeff() < 1e-8);
    CHECK((end[1].v - end[0].v).cwiseAbs().maxCoeff() < 1e-6);
  }
}

TEST_CASE(
    "a ball rolls over a ridge, and through a groove without leaving the surface, and penetrates neither",
    "[contact]") {
  for (const double slope : {0.2, -0.2}) {  // the first mesh is a ridge, the second a groove
    const Mesh roof = sheet(12, 0.2, [&](double x, double y) -> Vec3<double> {
      return {3 * x, y, -slope * std::abs(3 * x)};
    });
    // The middle row of vertices is moved exactly onto the ridge.
    Mesh mesh = roof;
    for (Eigen::Index i = 0; i < mesh.x.cols(); ++i)
      if (std::abs(mesh.x(0, i)) < 0.16) mesh.x.col(i) = Vec3<double>(0, mesh.x(1, i), 0);
    std::vector<double> balance;
    for (const int steps : {600, 1200, 2400}) {
      MultiBody body;
      const double r = 0.1;
      const Vec3<double> n = Vec3<double>(-slope, 0, 1).normalized();  // normal of the side x < 0
      ball(body, r, Vec3<double>(-0.5, 0.05, -0.5 * slope) + r * n)
          .velocity({1.8, 0, 1.8 * slope}, {0, 1.8 / r * std::hypot(1, slope), 0});
      body.obstacle("roof", mesh.x, mesh.triangles);
      Simulation simulation(body, "rk4");
      double highest = 0, lowest = 0;
      for (int i = 0; i < steps; ++i) {
        simulation.step(0.6 / steps);
        const Vec3<double> c = simulation.state().q.head<3>();
        const Vec3<double> side(c[0] < 0 ? -slope : slope, 0, 1);
        double distance = side.normalized().dot(c);
        if (slope > 0 && std::abs(c[0]) < slope * c[2]) distance = std::hypot(c[0], c[2]);
        highest = std::max(highest, distance - r);
        lowest = std::min(lowest, distance - r);
      }
      CHECK(simulation.state().q[0] > 0.3);
      CHECK(lowest > -1e-6);
      CHECK(std::abs(simulation.state().q[1] - 0.05) < 1e-9);
      if (slope < 0) CHECK(highest < 1e-4);
      balance.push_back(std::abs(simulation.ledger().balance));
    }
    CAPTURE(slope, balance[0], balance[1], balance[2]);
    // The impact on the other side of the groove dissipates 1 J, which the ledger records to first order in
    // the step.
    for (const double error : balance) CHECK(error < (slope > 0 ? 1e-9 : 1e-2));
    CHECK(balance[2] < 0.6 * balance[1] + 1e-9);
  }
}

TEST_CASE("parts that tumble over rough ground neither penetrate it nor are penetrated, and gain no energy",
          "[contact][long]") {
  constexpr int n = 12;
  for (const std::string shape : {"sphere", "ellipsoid", "box", "capsule", "cylinder", "superellipsoid"}) {
    INFO(shape);
    Draws draws(100 + shape.size());
    const Mesh ground = sheet(n, 0, [&](double x, double y) -> Vec3<double> {
      return {x, y, std::max(std::abs(x), std::abs(y)) == 1 ? 0.4 : draws.uniform(0, 0.12)};
    });
    const auto height = [&](const Vec3<double>& at) {
      const double u = (at[0] + 1) * n / 2, v = (at[1] + 1) * n / 2;
      const int i = std::clamp(static_cast<int>(u), 0, n - 1), j = std::clamp(static_cast<int>(v), 0, n - 1);
      const auto z = [&](int a, int b) { return ground.x(2, (i + a) * (n + 1) + j + b); };
      const double du = u - i, dv = v - j;
      return du > dv ? z(0, 0) + du * (z(1, 0) - z(0, 0)) + dv * (z(1, 1) - z(1, 0))
                     : z(0, 0) + dv * (z(0, 1) - z(0, 0)) + du * (z(1, 1) - z(0, 1));
    };
    MultiBody body;
    Part& part = body.add(make_part(shape, shape, {}, 1000));
    if (shape == "sphere") part.rest({{"r", 0.15}});
    if (shape == "ellipsoid" || shape == "box" || shape == "cylinder" || shape == "superellipsoid")
      part.rest({{"a1", 0.2}, {"a2", 0.12}, {"a3", 0.07}});
    if (shape == "superellipsoid") part.rest({{"eps1", 0.5}, {"eps2", 1.3}});
    if (shape == "capsule") part.rest({{"r", 0.1}, {"l", 0.15}});
    part.place({0.03, -0.1, 0.5}, Eigen::Quaterniond(0.4, 0.3, -0.6, 0.5).normalized())
        .velocity({0.7, 0.4, 0}, {2, -1, 0});
    body.obstacle("ground", ground.x, ground.triangles);
    Simulation simulation(body, "rk4");
    const Surface surface(part, 8);
    const double energy = simulation.ledger().energy();
    double below = 0, peak = 0, gain = 0;
    for (int k = 0; k < 100; ++k) {
      test::run(simulation, 0.01, 5);
      const Model& model = simulation.model();
      const ParameterValues<double> values = model.values(simulation.state(), 0);
      const Vec3<double> c = model.position(simulation.state(), 0);
      const Mat3<double> R = model.orientation(simulation.state(), 0).toRotationMatrix();
      const Eigen::Matrix3Xd p = part.s(surface.material(), values);
      for (Eigen::Index i = 0; i < p.cols(); ++i) {
        const Vec3<double> x = c + R * p.col(i);
        below = std::max(below, height(x) - x[2]);
      }
      for (Eigen::Index i = 0; i < ground.x.cols(); ++i)
        peak = std::max(peak, -part.inside_outside(R.transpose() * (ground.x.col(i) - c), values));
      gain = std::max(gain, simulation.ledger().energy() - energy);
    }
    CHECK(simulation.step_counters().impacts > 3);
    CHECK(below < 1e-9);
    CHECK(peak < 1e-9);
    CHECK(gain < 1e-9);
    CHECK(std::abs(simulation.ledger().balance) < 2e-3 * energy);
  }
}

TEST_CASE("a box that overhangs a plate stays while its centre is above the plate, and tips over otherwise",
          "[contact]") {
  for (const double over : {-0.02, 0.02}) {
    MultiBody body;
    box(body, {0.2, 0.1, 0.1}, {0.5 + over, 0.013, 0.1});
    body.plate("table", {0, 0, 0}, Eigen::Quaterniond::Identity(), 0.5, 0.5);
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.6, 300);
    if (over < 0) {
      CHECK((simulation.state().q.head<3>() - Vec3<double>(0.5 + over, 0.013, 0.1)).norm() < 1e-9);
      CHECK(simulation.state().v.norm() < 1e-9);
    } else {
      CHECK(simulation.state().v.norm() > 0.1);
    }
  }
}

TEST_CASE(
    "a plate blocks motion from both sides, an open mesh from one side, both only while they are active",
    "[contact]") {
  for (const bool two_sided : {true, false})
    for (const double from : {1.0, -1.0}) {
      MultiBody body;
      body.gravity.setZero();
      body.contact.restitution = 1;
      ball(body, 0.1, {0.1, 0.2, from}).velocity({0, 0, -2 * from}, {0, 0, 0});
      if (two_sided) {
        body.plate("gate", {0, 0, 0}, Eigen::Quaterniond::Identity(), 1, 1);
      } else {
        const Mesh mesh = sheet(3, 0.2, [](double x, double y) -> Vec3<double> { return {x, y, 0}; });
        body.obstacle("gate", mesh.x, mesh.triangles);
      }
      Simulation simulation(body, "rk4");
      test::run(simulation, 0.9, 90);
      // The ball reaches the plate or mesh after 0.45 s.
      if (two_sided || from > 0)
        CHECK(simulation.state().q[2] == Approx(from).margin(1e-9));
      else  // the ball passes, and is pushed out when it is more than half through
        CHECK(simulation.state().q[2] == Approx(-0.8 * from).margin(0.01));
    }
  MultiBody body;
  ball(body, 0.1, {0, 0, 0.1});
  body.plate("trap", {0, 0, 0}, Eigen::Quaterniond::Identity(), 1, 1).off = 0.5;
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.498, 249);
  CHECK(simulation.state().q[2] == Approx(0.1).margin(1e-12));
  test::run(simulation, 0.502, 251);
  CHECK(simulation.state().q[2] == Approx(0.1 - 0.5 * 9.81 * 0.5 * 0.5).epsilon(1e-9));
}

TEST_CASE("N53: fast parts do not pass through a mesh without thickness", "[contact]") {
  Draws draws(3);
  int through = 0;
  for (int i = 0; i < 200; ++i) {
    MultiBody body;
    body.gravity.setZero();
    body.contact.restitution = draws.uniform(0, 1);
    const bool is_box = i % 2 == 0;
    const Vec3<double> start(draws.uniform(-0.3, 0.3), draws.uniform(-0.3, 0.3), 0.5);
    const Vec3<double> omega(draws.uniform(-9, 9), draws.uniform(-9, 9), draws.uniform(-9, 9));
    Part& part = is_box ? box(body, {0.05, 0.02, 0.01}, start) : ball(body, 0.02, start);
    // The part moves 2 to 10 times its largest half extent in a step.
    const double speed = draws.uniform(2, 10) * part.rest({}).parameters()[0].rest_value() / 1e-2;
    part.velocity(speed * Vec3<double>(draws.uniform(-0.3, 0.3), draws.uniform(-0.3, 0.3), -1), omega);
    body.plate("plate", {0, 0, 0}, Eigen::Quaterniond::Identity(), 5, 5);
    Simulation simulation(body, "rk4");
    // The run stops at the first impact, because a box would leave with a spin that is too fast for these
    // steps.
    for (int k = 0; k < 30 && simulation.step_counters().impacts == 0; ++k) simulation.step(1e-2);
    if (!(simulation.step_counters().impacts > 0 && simulation.state().q[2] > 0)) ++through;
  }
  CHECK(through == 0);
}

TEST_CASE("an invalid mesh is refused, and the message names its fault", "[contact]") {
  const auto refusal = [](const Eigen::Matrix3Xd& x, const Eigen::Matrix3Xi& triangles) -> std::string {
    try {
      const ObstacleMesh mesh(x, triangles);
    } catch (const std::invalid_argument& fault) {
      return fault.what();
    }
    return "";
  };
  Eigen::Matrix3Xd x(3, 4);
  x << 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 0, 0.5;
  Eigen::Matrix3Xi two(3, 2);
  two << 0, 1, 1, 3, 2, 2;
  REQUIRE(refusal(x, two).empty());
  CHECK_FALSE(ObstacleMesh(x, two).closed());
  CHECK_THAT(refusal(x, Eigen::Matrix3Xi(3, 0)), test::has_text("it has no triangles"));
  Eigen::Matrix3Xd bad = x;
  bad(1, 3) = std::nan("");
  CHECK_THAT(refusal(bad, two), test::has_text("vertex 3 is not finite: (1, nan, 0.5)"));
  Eigen::Matrix3Xi triangles = two;
  triangles(2, 1) = 4;
  CHECK_THAT(refusal(x, triangles),
             test::has_text("triangle 1 names vertex 4, but the number of vertices is 4"));
  triangles(2, 1) = -1;
  CHECK_THAT(refusal(x, triangles),
             test::has_text("triangle 1 names vertex -1, but the number of vertices is 4"));
  bad = x;
  bad.col(3) = bad.col(2);
  CHECK_THAT(refusal(bad, two),
             test::has_text("triangle 1 has no area: its corners are (1, 0, 0), (0, 1, 0) and (0, 1, 0)"));
  bad.col(3) = 0.3 * x.col(1) + 0.7 * x.col(2);
  CHECK_THAT(refusal(bad, two), test::has_text("triangle 1 has no area"));
  triangles.col(1) << 3, 1, 2;
  CHECK_THAT(
      refusal(x, triangles),
      test::has_text("triangles 0 and 1 have opposite orientations at the edge from (1, 0, 0) to (0, 1, 0)"));
  CHECK_THAT(refusal(x, two.leftCols(1)), test::has_text("vertex 3 is in no triangle: (1, 1, 0.5)"));
  triangles.resize(3, 3);
  triangles << two, Eigen::Vector3i(0, 2, 1);
  CHECK_THAT(refusal(x, triangles), test::has_text("has three triangles: 0, 1 and 2"));
}

TEST_CASE("a mesh merges equal vertices, and finds nearest points and the triangles in a box", "[contact]") {
  Draws draws(5);
  const Mesh mesh = sheet(9, 0.3, [](double x, double y) -> Vec3<double> {
    return {x, y, std::max(0.0, x)};
  });
  Mesh soup;  // every triangle has its own vertices
  soup.x.resize(3, 3 * mesh.triangles.cols());
  soup.triangles.resize(3, mesh.triangles.cols());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      soup.x.col(3 * t + k) = mesh.x.col(mesh.triangles(k, t));
      soup.triangles(k, t) = static_cast<int>(3 * t + k);
    }
  const ObstacleMesh obstacle(soup.x, soup.triangles);
  CHECK(obstacle.vertices().cols() == mesh.x.cols());
  CHECK_FALSE(obstacle.closed());
  std::vector<int> found;
  for (int i = 0; i < 200; ++i) {
    const Vec3<double> at(draws.uniform(-1.2, 1.2), draws.uniform(-1.2, 1.2), draws.uniform(-0.5, 1.5));
    const double reach = draws.uniform(0.01, 0.5);
    double min_distance = 1e9;
    for (int t = 0; t < obstacle.triangles().cols(); ++t) {
      const Vec3<double> nearest = obstacle.nearest(t, at);
      min_distance = std::min(min_distance, (nearest - at).norm());
      for (int k = 0; k < 20; ++k) {  // no point of the triangle is nearer
        Vec3<double> b(draws.uniform(0, 1), draws.uniform(0, 1), draws.uniform(0, 1));
        b /= b.sum();
        Vec3<double> inner = Vec3<double>::Zero();
        for (int c = 0; c < 3; ++c) inner += b[c] * obstacle.vertices().col(obstacle.triangles()(c, t));
        CHECK((inner - at).norm() > (nearest - at).norm() - 1e-12);
      }
    }
    CHECK(obstacle.is_within(at, reach) == (min_distance <= reach));
    const Eigen::AlignedBox3d box((at.array() - reach).matrix(), (at.array() + reach).matrix());
    obstacle.query(box, found);
    std::vector<int> all;
    for (int t = 0; t < obstacle.triangles().cols(); ++t) {
      Eigen::AlignedBox3d own;
      for (int k = 0; k < 3; ++k) own.extend(obstacle.vertices().col(obstacle.triangles()(k, t)));
      if (own.intersects(box)) all.push_back(t);
    }
    CHECK(found == all);
  }
}

}  // namespace obstacle_test
