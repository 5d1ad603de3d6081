// Contact of parts whose local deformation is a sum of modes. The contacts are on the surface mesh of the
// part, and an impulse changes the motion of the whole part.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <string>

#include <pliant/body/joints/all_joints.h>
#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/contact_problem.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>

#include "deepest.h"
#include "motion.h"
#include "widest_gap.h"

namespace modal_contact_test {

using namespace pliant;
using test::deepest;
using test::widest_gap;

namespace {

using Basis = LocalSettings::Basis;

constexpr double kRadius = 0.1;  // m

/// Adds an elastic ball whose local deformation is a sum of polynomials of degree 4. E: Young's modulus, Pa.
Part& jelly(MultiBody& body, const std::string& name, const Vec3<double>& at, double E = 2e5) {
  auto& part = body.add<Primitive<Sphere>>(name, 1000.0);
  part.rest({{"r", kRadius}}).place(at);
  LocalSettings settings;
  settings.basis = Basis::polynomial;
  settings.resolution = 4;
  settings.alpha = 60;
  settings.energies = {local_law("elastic", {E, 0.3})};
  part.deform_locally(settings);
  return part;
}

/// Adds a floor, and a shell that oscillates while it falls onto the floor. basis: Basis::nodes, or
/// Basis::modes for all modes of the mesh. parameters: whether two semi-axes are dynamic.
void falling(MultiBody& body, Basis basis, bool parameters) {
  body.contact.friction = 0.4;
  auto& part = body.add<Primitive<Ellipsoid>>("shell", 1.0);
  part.make_shell().rest({{"a1", 0.1}, {"a2", 0.08}, {"a3", 0.12}});
  part.place({0, 0, 0.0998}, Eigen::Quaterniond(0.9, 0.1, -0.2, 0.1).normalized());
  part.velocity({0.3, -0.2, -1}, {2, 1, -3});
  if (parameters) part.stiffness({{"a1", 100}, {"a2", 100}}).initial_rate({{"a1", 0.2}});
  LocalSettings settings;
  settings.basis = basis;
  settings.resolution = 2;
  settings.modes = 3 * 98 - 6 - (parameters ? 2 : 0);
  settings.energies = {local_law("membrane", {1e4, 0.3, 1e-3}), local_law("bending", {1e7, 0.3, 1e-3})};
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return {X[1] * X[2], 3 * X[0] * X[2], 0}; };
  part.deform_locally(settings);
  body.plane("floor", Vec3<double>(0, 0, 0.002), {0, 0, 1});
}

struct PlaneImpact {
  std::vector<Contact> contacts;
  ContactSolution solution;
};

/// Returns the contacts of all nodes that are below the floor at the start, and their impulses.
PlaneImpact strike(Basis basis, bool parameters) {
  MultiBody body;
  falling(body, basis, parameters);
  const Model model(body);
  const Dynamics dynamics(model);
  const State state = model.initial_state();
  PlaneImpact struck;
  MeshFinder(model).find(state, 0, struck.contacts);
  Workspace<double> work;
  dynamics.evaluate_masses(state.time(), state.q, state.v, {0}, work);
  ContactProblem problem(model, state, work, struck.contacts);
  struck.solution = problem.solve(0);
  return struck;
}

}  // namespace

TEST_CASE("impulses on all modes of a shell agree with those on its nodes", "[contact][modal]") {
  for (const bool parameters : {false, true}) {
    CAPTURE(parameters);
    const PlaneImpact nodes = strike(Basis::nodes, parameters), modes = strike(Basis::modes, parameters);
    REQUIRE(nodes.contacts.size() == modes.contacts.size());
    REQUIRE(nodes.contacts.size() >= 3);
    CHECK(modes.solution.residual < 1e-12);
    // The nodes are point masses. Contacts of point masses are solved only to 1e-6 of the largest contact
    // velocity (kSweepExactOfPointMasses in solve/coulomb_cluster-inl.h).
    double largest = 0;
    for (const Vec3<double>& p : nodes.solution.impulse) largest = std::max(largest, p.norm());
    REQUIRE(largest > 0);
    for (std::size_t k = 0; k < nodes.contacts.size(); ++k) {
      CHECK(modes.contacts[k].gap == Approx(nodes.contacts[k].gap).epsilon(1e-9));
      CHECK((modes.solution.impulse[k] - nodes.solution.impulse[k]).norm() < 1e-4 * largest);
    }
  }
}

TEST_CASE("an elastic ball dropped on a plane comes to rest, and the plane carries its weight",
          "[contact][modal]") {
  for (const std::string method : {"semi_implicit_euler", "rk4"}) {
    CAPTURE(method);
    MultiBody body;
    jelly(body, "ball", {0, 0, 0.15}).damping(0, 0, 5);
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    Simulation simulation(body, method);
    const double weight = 9.81 * body.parts()[0]->total_mass(), h = 4e-4;
    double impulse = 0, highest = simulation.ledger().energy(), deep = 0;
    for (int i = 0; i < 4000; ++i) {
      simulation.step(h);
      if (i % 10 == 0) deep = std::max(deep, deepest(simulation));
      if (i % 50 == 0) {
        const double energy = simulation.ledger().energy();
        CHECK(energy < highest + 1e-3 * weight * 0.05);
        highest = energy;
      }
      if (i >= 3500)
        for (const Vec3<double>& p : simulation.contact()->impulses()) impulse += p[2];
    }
    CHECK(deep < 1e-3 * kRadius);
    CHECK(impulse / (500 * h) == Approx(weight).epsilon(1e-2));
    CHECK(simulation.ledger().kinetic < 1e-3 * weight * 0.05);
    CHECK(simulation.step_counters().contact_residual < 1e-7);
  }
}

TEST_CASE("elastic balls that collide, or hit a rigid box, conserve momentum and lose energy",
          "[contact][modal][long]") {
  for (const bool box : {false, true}) {
    CAPTURE(box);
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    jelly(body, "left", {-0.12, 0.01, 0}).velocity({0.5, 0, 0}, {0, 3, 0});
    if (box)
      body.add(make_part("right", "box", {}, 500))
          .rest({{"a1", 0.05}, {"a2", 0.04}, {"a3", 0.06}})
          .place({0.1, 0.02, 0.01})
          .velocity({-0.5, 0, 0}, {1, 2, -1});
    else
      jelly(body, "right", {0.12, -0.02, 0.02}).velocity({-0.5, 0, 0}, {0, 0, -5});
    Simulation simulation(body, "rk4");
    const Ledger before = simulation.ledger();
    const double scale = body.parts()[0]->total_mass() * 0.5;
    double deep = 0;
    bool met = false;
    for (int k = 0; k < 1500; ++k) {
      simulation.step(2e-4);
      met = met || !simulation.contact()->contacts().empty();
      deep = std::max(deep, deepest(simulation));
    }
    const Ledger after = simulation.ledger();
    CHECK(met);
    CHECK(deep < 2e-3 * kRadius);
    CHECK((after.momentum - before.momentum).norm() < 1e-12 * scale);
    CHECK((after.angular_momentum - before.angular_momentum).norm() < 5e-3 * scale * kRadius);
    CHECK(after.energy() < before.energy());
    if (!box) CHECK(simulation.state().v[simulation.model().parts()[0].v0] < 0.1);
  }
}

TEST_CASE("a jointed elastic ball hits a wall, and its joint stays closed",
          "[contact][modal][joints][long]") {
  MultiBody body;
  Part& ball = jelly(body, "ball", {0.3, 0, 0});
  Part& arm = body.add(make_part("arm", "ellipsoid", {}, 1000));
  arm.rest({{"a1", 0.1}, {"a2", 0.02}, {"a3", 0.02}}).place({0.1, 0, 0});
  body.ball("pivot", world(0, 0, 0), point(arm, 0, kPi));
  body.ball("grip", point(arm, 0, 0), point(ball, 0, kPi));
  body.plane("wall", Vec3<double>(-0.05, 0, 0), {1, 0, 0});
  body.contact.friction = 0.3;
  Simulation simulation(body, "rk4");
  const double start = simulation.ledger().energy();
  bool met = false;
  for (int i = 0; i < 5000; ++i) {
    simulation.step(2e-4);
    REQUIRE(widest_gap(simulation) < 1e-10);
    REQUIRE(deepest(simulation) < 3e-3 * kRadius);
    met = met || !simulation.contact()->contacts().empty();
  }
  CHECK(met);
  CHECK(simulation.ledger().energy() < start);
}

TEST_CASE("if contact is possible, the fastest mode of a part limits the step", "[contact][modal][long]") {
  for (const std::string method : {"semi_implicit_euler", "rk4"}) {
    MultiBody free, touching;
    jelly(free, "ball", {0, 0, 0.2});
    jelly(touching, "ball", {0, 0, 0.2});
    touching.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    CHECK(largest_stable_step(Simulation(free, method)) > 1);
    const double h = largest_stable_step(Simulation(touching, method)),
                 omega = std::sqrt(touching.parts()[0]->local()->oscillators()->omega2.maxCoeff());
    CHECK(h == Approx(1 / omega).epsilon(1e-9));
    Simulation simulation(touching, method);
    const double start = simulation.ledger().energy();
    test::run(simulation, 2, static_cast<int>(2 / (0.95 * h)));
    CHECK(simulation.ledger().energy() < start);
  }
}

}  // namespace modal_contact_test
