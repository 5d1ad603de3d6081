// Contact of parts with local deformation: contacts of their nodes with planes, and of their surface meshes
// with other parts and obstacles.
// N53 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <pliant/body/joints/all_joints.h>
#include <pliant/collision/mesh/mesh_touches.h>
#include <pliant/collision/mesh/obstacle_mesh.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>

#include "deepest.h"
#include "motion.h"
#include "widest_gap.h"

namespace soft_contact_test {

using namespace pliant;
using test::deepest;

namespace {

constexpr double kG = 9.81;  // m/s^2

/// Adds a rubber shell with 98 nodes and the radius 0.1 m. air: internal pressure, Pa; 0: none.
Part& balloon(MultiBody& body, const std::string& name, const Vec3<double>& at, double air = 20) {
  auto& part = body.add<Primitive<Ellipsoid>>(name, 1.0);
  part.make_shell().rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}}).place(at);
  LocalSettings settings;
  settings.resolution = 2;
  settings.alpha = 2;
  settings.energies.push_back(local_law("neo_hookean_membrane", {2e4, 0.4, 1e-3}));
  if (air > 0) settings.energies.push_back(local_law("pressure", {air}));
  part.deform_locally(settings);
  return part;
}

/// Returns the height of the lowest node of all parts above the plane z = 0, m, at most 1.
double lowest(const Simulation& simulation) {
  double min_height = 1;
  for (int i = 0; i < static_cast<int>(simulation.model().parts().size()); ++i) {
    const Eigen::Matrix3Xd p = simulation.model().node_positions(simulation.state(), i).transpose();
    const Eigen::Matrix3Xd x = simulation.model().orientation(simulation.state(), i).toRotationMatrix() * p;
    min_height =
        std::min(min_height, x.row(2).minCoeff() + simulation.model().position(simulation.state(), i)[2]);
  }
  return min_height;
}

/// Runs 0.3 s. Checks that parts touch, and at every tenth step that no overlap exceeds 1e-3 of the radius of
/// a balloon.
void run_contact(Simulation& simulation) {
  double deep = 0;
  bool met = false;
  for (int k = 0; k < 1500; ++k) {
    simulation.step(2e-4);
    met = met || !simulation.contact()->contacts().empty();
    if (k % 10 == 0) deep = std::max(deep, deepest(simulation));
  }
  REQUIRE(met);
  CHECK(deep < 1e-3 * 0.1);
}

}  // namespace

TEST_CASE("a balloon dropped on a plane comes to rest on it, and the plane carries its weight",
          "[contact][long]") {
  for (const char* method : {"semi_implicit_euler", "rk4"}) {
    MultiBody body;
    balloon(body, "ball", {0, 0, 0.15});
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    Simulation simulation(body, method);
    const double weight = kG * body.parts()[0]->total_mass();
    double impulse = 0, highest_energy = simulation.ledger().energy();
    for (int i = 0; i < 8000; ++i) {
      simulation.step(5e-4);
      REQUIRE(lowest(simulation) > -1e-4 * 0.1);
      if (i % 100 == 0) {
        const double energy = simulation.ledger().energy();
        CHECK(energy < highest_energy + 1e-4);
        highest_energy = energy;
      }
      if (i >= 7000)
        for (const Vec3<double>& p : simulation.contact()->impulses()) impulse += p[2];
    }
    CAPTURE(method);
    CHECK(impulse / 0.5 == Approx(weight).epsilon(1e-2));
    CHECK(simulation.ledger().kinetic < 1e-3 * weight * 0.05);
    CHECK(simulation.step_counters().contact_residual < 1e-7);
  }
}

TEST_CASE("energy lost by a spinning balloon that bounces converges with the step of linearly_implicit",
          "[contact][implicit][long]") {
  std::vector<double> lost;
  double kinetic = 0;
  for (const double h : {1e-3, 5e-4, 2.5e-4}) {
    MultiBody body;
    auto& part = body.add<Primitive<Sphere>>("balloon", 1.0);
    part.make_shell().rest({{"r", 0.1}}).place({0, 0, 0.15}).velocity({0.5, 0, -3}, {3, 20, 0});
    LocalSettings settings;
    settings.resolution = 2;
    settings.energies = {local_law("neo_hookean_membrane", {1e5, 0.5, 1e-3}), local_law("pressure", {200})};
    part.deform_locally(settings);
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    Simulation simulation(body, "linearly_implicit");
    kinetic = simulation.ledger().kinetic;
    test::run(simulation, 0.1, static_cast<int>(std::lround(0.1 / h)));
    lost.push_back(std::abs(simulation.ledger().balance));
  }
  CAPTURE(kinetic, lost);
  CHECK(test::observed_order(lost) >= 1.8);
  CHECK(lost.back() <= 0.01 * kinetic);
}

TEST_CASE("balloons that collide conserve their momenta, lose energy, and do not overlap", "[contact]") {
  MultiBody body;
  body.gravity.setZero();
  body.contact.active = true;
  balloon(body, "left", {-0.15, 0.01, 0}).velocity({0.5, 0, 0}, {0, 3, 0});
  balloon(body, "right", {0.15, -0.02, 0.02}).velocity({-0.5, 0, 0}, {0, 0, -5});
  Simulation simulation(body, "semi_implicit_euler");
  const Ledger before = simulation.ledger();
  const double scale = body.parts()[0]->total_mass() * 0.5;
  run_contact(simulation);
  const Ledger after = simulation.ledger();
  CHECK((after.momentum - before.momentum).norm() < 1e-12 * scale);
  CHECK((after.angular_momentum - before.angular_momentum).norm() < 5e-3 * scale * 0.1);
  CHECK(after.energy() < before.energy());
  // The balloons have rebounded.
  CHECK(simulation.state().v[simulation.model().parts()[0].v0] < 0);
  CHECK(simulation.state().v[simulation.model().parts()[1].v0] > 0);
}

TEST_CASE("a balloon and a rigid box collide: momenta are conserved, without penetration", "[contact]") {
  MultiBody body;
  body.gravity.setZero();
  body.contact.active = true;
  balloon(body, "balloon", {0, 0, 0});
  Part& box = body.add(make_part("box", "box", {}, 50));
  box.rest({{"a1", 0.05}, {"a2", 0.04}, {"a3", 0.06}}).place({0.25, 0.02, 0.01});
  box.velocity({-1, 0, 0}, {1, 2, -1});
  Simulation simulation(body, "semi_implicit_euler");
  const Ledger before = simulation.ledger();
  run_contact(simulation);
  const Ledger after = simulation.ledger();
  CHECK((after.momentum - before.momentum).norm() < 1e-12 * before.momentum.norm());
  CHECK(after.energy() < before.energy());
}

TEST_CASE("balloons on strings collide, and the strings do not stretch", "[contact][joints][long]") {
  MultiBody body;
  body.contact.active = true;
  Part& left = balloon(body, "left", {-0.3, 0, -0.4});
  Part& right = balloon(body, "right", {0.12, 0, -0.5});
  body.join("l", String{std::hypot(0.2, 0.3)}, {world(-0.1, 0, 0), point(left, kPi / 2, 0)});
  body.join("r", String{0.4}, {world(0.12, 0, 0), point(right, kPi / 2, 0)});
  Simulation simulation(body, "semi_implicit_euler");
  bool met = false;
  for (int i = 0; i < 4000; ++i) {
    simulation.step(2.5e-4);
    met = met || !simulation.contact()->contacts().empty();
    for (int j = 0; j < 2; ++j) REQUIRE(simulation.model().gap(simulation.state(), j) < 1e-9);
  }
  CHECK(met);
}

TEST_CASE("N53: a fast balloon does not pass through a thin plate", "[contact]") {
  for (const double speed : {10.0, 100.0}) {  // m/s; up to half the radius of the balloon in a step
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    balloon(body, "ball", {-0.16, 0.01, 0.02}).velocity({speed, 0, 0}, {0, 0, 0});
    Part& plate = body.add(make_part("plate", "box", {}, 1000));
    plate.rest({{"a1", 0.01}, {"a2", 0.3}, {"a3", 0.3}}).fix();
    Simulation simulation(body, "semi_implicit_euler");
    bool through = false;
    try {
      for (int i = 0; i < 4; ++i) {
        simulation.step(speed > 50 ? 5e-4 : 2e-3);
        through = through || simulation.state().q[0] > 0.02;
      }
    } catch (const NumericalFailure&) {  // the balloon burst
    }
    CAPTURE(speed);
    CHECK_FALSE(through);
  }
}

TEST_CASE("contacts of crossing meshes: corners behind faces, edges across edges", "[contact]") {
  MultiBody body;
  for (const char* name : {"a", "b"}) {
    Part& part = body.add(make_part(name, "box", {}, 1000));
    part.rest({{"a1", 1.0}, {"a2", 1.0}, {"a3", 1.0}});
  }
  const Model model(body);
  const ContactMesh mesh(model.parts()[0], 0);
  const State state = model.initial_state();
  const Eigen::Matrix3Xd p = mesh.positions(model, state, 0);
  auto touches = [&](const Eigen::Quaterniond& R, const Vec3<double>& c) {
    const PlacedMesh a(mesh, p), b(mesh, (R.toRotationMatrix() * p).colwise() + c);
    std::vector<MeshTouch> found;
    find_touches(a, b, found);
    return found;
  };
  // The cube b is rotated by 45 degrees about x: its lowest and highest edges, at the distance `reach` from
  // its centre, are parallel to x.
  const Eigen::Quaterniond rotated(Eigen::AngleAxisd(kPi / 4, Vec3<double>::UnitX()));
  const double reach = std::sqrt(2.0);
  {  // an edge of b along x, on the upper face of a
    const auto found = touches(rotated, {0.1, 0.05, 1 + reach - 1e-3});
    REQUIRE_FALSE(found.empty());
    for (const MeshTouch& touch : found) {
      CHECK(touch.gap == Approx(-1e-3).margin(1e-12));
      CHECK((touch.normal - Vec3<double>(0, 0, -1)).norm() < 1e-12);
    }
  }
  {  // an edge across an edge: a is rotated by 45 degrees about y, b about x
    const Eigen::Quaterniond other(Eigen::AngleAxisd(kPi / 4, Vec3<double>::UnitY()));
    const PlacedMesh a(mesh, other.toRotationMatrix() * p),
        b(mesh, (rotated.toRotationMatrix() * p).colwise() + Vec3<double>(0.13, 0.07, 2 * reach - 1e-3));
    std::vector<MeshTouch> found;
    find_touches(a, b, found);
    REQUIRE(found.size() == 1);
    CHECK(found[0].gap == Approx(-1e-3).margin(1e-12));
    CHECK((found[0].normal - Vec3<double>(0, 0, -1)).norm() < 1e-12);
    CHECK((found[0].x - Vec3<double>(0, 0.07, reach)).head<2>().norm() < 0.2);
  }
  {  // a corner of b in a face of a
    const Eigen::Quaterniond corner =
        Eigen::Quaterniond::FromTwoVectors(Vec3<double>(1, 1, 1).normalized(), Vec3<double>(0, 0, -1));
    const auto found = touches(corner, {0.11, 0.23, 1 + std::sqrt(3.0) - 1e-3});
    REQUIRE(found.size() == 1);
    CHECK(found[0].gap == Approx(-1e-3).margin(1e-12));
    CHECK(found[0].b.vertex[1] == -1);
  }
  CHECK(touches(rotated, {0.1, 0.05, 1 + reach + 1e-3}).empty());
  CHECK(touches(Eigen::Quaterniond::Identity(), {0, 0, 2.001}).empty());
}

namespace {

/// Returns the positions of the nodes of a part in the world.
Eigen::Matrix3Xd world_nodes(const Simulation& simulation, int part) {
  const Mat3<double> R = simulation.model().orientation(simulation.state(), part).toRotationMatrix();
  return (R * simulation.model().node_positions(simulation.state(), part).transpose()).colwise() +
         simulation.model().position(simulation.state(), part);
}

/// The mesh of an uneven ground.
struct Ground {
  Eigen::Matrix3Xd x;
  Eigen::Matrix3Xi triangles;
  int n;

  /// Makes a mesh of n x n squares over [-0.5, 0.5]^2, n = squares. height(u, v) returns the height of the
  /// mesh, m.
  template <class F>
  Ground(int squares, F&& height) : n(squares) {
    x.resize(3, (n + 1) * (n + 1));
    triangles.resize(3, 2 * n * n);
    for (int i = 0, t = 0; i <= n; ++i)
      for (int j = 0; j <= n; ++j) {
        const double u = (2.0 * i / n - 1) / 2, v = (2.0 * j / n - 1) / 2;
        const int k = i * (n + 1) + j, next = k + n + 1;
        x.col(k) = Vec3<double>(u, v, height(u, v));
        if (i == n || j == n) continue;
        triangles.col(t++) = Eigen::Vector3i(k, next, next + 1);
        triangles.col(t++) = Eigen::Vector3i(k, next + 1, k + 1);
      }
  }
  /// Returns the distance of a point from the plane of the triangle above or below the point, m. The distance
  /// is negative below the triangle. Returns 1 if no triangle is above or below the point.
  double above(const Vec3<double>& p) const {
    for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
      const Vec3<double> a = x.col(triangles(0, t)), b = x.col(triangles(1, t)), c = x.col(triangles(2, t));
      Eigen::Matrix2d edges;
      edges << b[0] - a[0], c[0] - a[0], b[1] - a[1], c[1] - a[1];
      const Eigen::Vector2d w = edges.inverse() * (p - a).head<2>();
      if (w[0] < 0 || w[1] < 0 || w.sum() > 1) continue;
      const Vec3<double> normal = (b - a).cross(c - a).normalized();
      return normal.dot(p - a);
    }
    return 1;
  }
};

/// Returns the distance of a point inside a closed mesh from the surface, m, at most 1. Returns 0 outside.
double depth_in(const ObstacleMesh& mesh, const Vec3<double>& p) {
  double solid_angle = 0, nearest = 1;
  for (int t = 0; t < mesh.triangles().cols(); ++t) {
    const Vec3<double> a = mesh.vertices().col(mesh.triangles()(0, t)) - p,
                       b = mesh.vertices().col(mesh.triangles()(1, t)) - p,
                       c = mesh.vertices().col(mesh.triangles()(2, t)) - p;
    solid_angle += std::atan2(a.dot(b.cross(c)), a.norm() * b.norm() * c.norm() + a.dot(b) * c.norm() +
                                                     b.dot(c) * a.norm() + c.dot(a) * b.norm());
    nearest = std::min(nearest, (mesh.nearest(t, p) - p).norm());
  }
  return solid_angle > kPi ? nearest : 0;  // half the solid angle of the mesh: 2 pi inside, 0 outside
}

}  // namespace

TEST_CASE("a balloon rests on a plate, on a flat mesh and in a bowl, and each carries its weight",
          "[contact][long]") {
  const std::vector<Ground> grounds{Ground(7, [](double, double) { return 0.0; }),
                                    Ground(12, [](double u, double v) { return 1.5 * (u * u + v * v); })};
  for (const std::string on : {"plate", "flat mesh", "bowl"}) {
    CAPTURE(on);
    const Ground& ground = grounds[on == "bowl" ? 1 : 0];
    MultiBody body;
    body.contact.friction = 0.3;
    balloon(body, "ball", on == "bowl" ? Vec3<double>(0.09, 0.02, 0.2) : Vec3<double>(0.02, 0.03, 0.15));
    if (on == "plate")
      body.plate("ground", {0, 0, 0}, Eigen::Quaterniond::Identity(), 0.5, 0.5);
    else
      body.obstacle("ground", ground.x, ground.triangles);
    Simulation simulation(body, "semi_implicit_euler");
    const double weight = kG * body.parts()[0]->total_mass();
    Vec3<double> impulse = Vec3<double>::Zero();
    double deep = 0;
    const int steps = on == "bowl" ? 12000 : 6000;
    for (int i = 0; i < steps; ++i) {
      simulation.step(5e-4);
      if (i % 20 == 0) {
        const Eigen::Matrix3Xd x = world_nodes(simulation, 0);
        for (Eigen::Index k = 0; k < x.cols(); ++k) deep = std::max(deep, -ground.above(x.col(k)));
      }
      if (i >= steps - 1000)
        for (const Vec3<double>& p : simulation.contact()->impulses()) impulse += p;
    }
    CHECK(deep < 1e-3 * 0.1);
    CHECK((impulse / 0.5 - Vec3<double>(0, 0, weight)).norm() < 0.02 * weight);
    CHECK(simulation.ledger().kinetic < 1e-3 * weight * 0.05);
    CHECK(simulation.step_counters().contact_residual < 1e-7);
  }
}

TEST_CASE("a ridge and a peak dent a balloon without penetrating it", "[contact]") {
  for (const std::string what : {"ridge", "peak"}) {
    CAPTURE(what);
    const double slope = 0.8;
    const Ground ground(2, [&](double u, double v) {
      if (what == "ridge") return -slope * std::abs(u);
      return -slope * std::max(std::abs(u), std::abs(v));
    });
    MultiBody body;
    body.contact.friction = 0;
    balloon(body, "ball", {0.003, 0.002, 0.12}).velocity({0, 0, -1}, {0, 0, 0});
    std::vector<Vec3<double>> sharp;
    body.obstacle("ground", ground.x, ground.triangles);
    for (int i = -50; i <= 50; ++i)
      if (what != "peak" || i == 0) sharp.push_back({0, 0.1 * i / 50, 0});
    Simulation simulation(body, "semi_implicit_euler");
    const LocalMesh& mesh = simulation.model().parts()[0].local->mesh();
    double deep = 0;
    bool met = false;
    for (int i = 0; i < 1000; ++i) {
      simulation.step(1e-4);
      met = met || !simulation.contact()->contacts().empty();
      if (i % 10 != 0) continue;
      const ObstacleMesh surface(world_nodes(simulation, 0), surface_nodes(mesh).triangles);
      for (const Vec3<double>& p : sharp) deep = std::max(deep, depth_in(surface, p));
    }
    REQUIRE(met);
    CHECK(deep < 1e-3 * 0.1);
  }
}

}  // namespace soft_contact_test
