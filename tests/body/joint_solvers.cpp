// The two solvers of joints factor W_c = C_q M^-1 C_q^T by blocks, or the augmented matrix of Eq. (14) by
// Eigen or SuiteSparse. Both solvers give equal motion, and Model chooses between them.
#include "catch.h"

#include <algorithm>
#include <numeric>

#include <Eigen/Geometry>

#include <pliant/body/joints/rod.h>
#include <pliant/body/joints/string.h>
#include <pliant/solve/suitesparse.h>

#include "draws.h"
#include "motion.h"

namespace joint_solvers_test {

using namespace pliant;
using test::Draws;
using Choice = JointSolver::Choice;

namespace {

/// Adds deforming and rigid parts in loops, with a doubled joint, a rod, a hinge, a moving anchor, two
/// strings and a parameter at its limit.
void tangled_parts(MultiBody& body) {
  Part& a = test::tumbling_solid(body, "a");
  body.gravity = {0.3, -1, -9.81};
  a.damping(0.4, 0.02, 0.1);
  a.limits("a1", {0.2, 0.32});
  Draws draws(3);
  std::vector<Part*> parts{&a};
  for (int i = 0; i < 5; ++i) {
    Part& part =
        test::add(body, "p" + std::to_string(i), i % 2 == 0 ? "ellipsoid" : "cylinder", {}, 500 + 200 * i);
    part.place(draws.vector(1)).velocity(draws.vector(1), draws.vector(2));
    if (i == 2) part.stiffness({{"a1", 1e4}, {"a3", 2e4}});
    body.ball("b" + std::to_string(i), point(*parts.back(), draws.uniform(-1, 1), draws.uniform(-3, 3)),
              point(part, draws.uniform(-1, 1), draws.uniform(-3, 3)));
    parts.push_back(&part);
  }
  body.ball("loop", point(*parts.back(), 0.3, 1), point(a, -0.7, 2));
  body.ball("again", point(*parts.back(), 0.3, 1), point(a, -0.7, 2));
  body.join("rod", Rod{0.6}, {point(*parts[1], -0.3, -1), point(*parts[3], 0.1, -1)});
  body.ball("hand", world({test::wave(0.5, 0.3, 4), 0.2, test::wave(0.1, 0.2, 3, 1)}),
            point(*parts[2], 1.2, -2));
  body.join("string", String{0.2}, {world(0.4, 1, 2), point(*parts[4], kPi / 2, 0)});
  Part& bob = test::add(body, "bob", "sphere", {}, 700);
  bob.place({0.5, -0.4, -2}).velocity({0.1, 0.4, 0}, {1, 0, 2});
  body.join("cord", String{1.5}, {point(*parts[3], 0, 0), point(bob, kPi / 2, 0)});
  body.hinge("hinge", point(*parts[2], 0, 0, 0), point(*parts[4], 0, 1, 0.5), {1, 0, 0});
}

/// Adds one hub with many arms on ball joints.
void star(MultiBody& body, int arms) {
  Part& hub = test::add(body, "hub", "sphere", {}, 1000);
  for (int i = 0; i < arms; ++i) {
    Part& arm = test::add(body, "arm" + std::to_string(i), "ellipsoid", {}, 1000);
    arm.rest({{"a1", 0.02}, {"a2", 0.02}, {"a3", 0.2}});
    const double u = std::asin(2 * (i + 0.5) / arms - 1), v = 2.4 * i;
    const Vec3<double> out(std::cos(u) * std::cos(v), std::cos(u) * std::sin(v), std::sin(u));
    arm.place(1.2 * out, Eigen::Quaterniond::FromTwoVectors(Vec3<double>::UnitZ(), out));
    body.ball("joint" + std::to_string(i), point(hub, u, v), point(arm, -kPi / 2, 0));
  }
}

struct Backend {
  const char* name;
  void (*use)(JointSolver&);
};
const Backend backends[] = {{"Eigen", [](JointSolver&) {}}, {"SuiteSparse", use_suitesparse}};

}  // namespace

TEST_CASE("both solvers give equal accelerations, forces and derivatives", "[joints]") {
  for (const Backend& backend : backends) {
    MultiBody one, two;
    tangled_parts(one);
    tangled_parts(two);
    one.joint_solver.choice = Choice::blocks;
    two.joint_solver.choice = Choice::augmented;
    backend.use(two.joint_solver);
    const Simulation blocks(one, "rk4"), augmented(two, "rk4");
    REQUIRE(augmented.model().islands()[0].augmented);
    REQUIRE_FALSE(blocks.model().islands()[0].augmented);
    Workspace<double> work, other;
    const State& state = blocks.state();
    blocks.dynamics().accelerations(0.1, state.q, state.v, state, work);
    augmented.dynamics().accelerations(0.1, state.q, state.v, state, other);
    INFO(backend.name);
    CHECK((work.v_dot - other.v_dot).norm() <= 1e-10 * work.v_dot.norm());
    // Two equal joints ("loop" and "again") may share their force in any way. The other forces are unique.
    for (int j = 0; j < static_cast<int>(one.joints().size()); ++j) {
      const std::string& name = blocks.model().joints()[static_cast<std::size_t>(j)].joint->name();
      if (name == "loop" || name == "again") continue;
      INFO(name);
      const Wrench a = blocks.dynamics().joint_wrench(0.1, j, work),
                   b = augmented.dynamics().joint_wrench(0.1, j, other);
      CHECK((a.force - b.force).norm() <= 1e-9 * work.joints.lambda.norm());
      CHECK((a.torque - b.torque).norm() <= 1e-9 * work.joints.lambda.norm());
    }
    auto redundant = [](const Simulation& simulation, const Workspace<double>& of) {
      const std::vector<int> rows = redundant_rows(simulation.model(), of.joints);
      return std::accumulate(rows.begin(), rows.end(), 0);
    };
    CHECK(redundant(blocks, work) == 3);
    CHECK(redundant(augmented, other) == 3);

    Draws draws(1);
    StateDirection along{VecX<double>(state.q.size()), VecX<double>(state.v.size())};
    for (double& x : along.q) x = draws.uniform(-1, 1);
    for (double& x : along.v) x = draws.uniform(-1, 1);
    Workspace<Dual<1>> dual, other_dual;
    const VecX<double> d = blocks.dynamics().jvp(0.1, state.q, state.v, along, work, dual);
    const VecX<double> e = augmented.dynamics().jvp(0.1, state.q, state.v, along, other, other_dual);
    CHECK((d - e).norm() <= 1e-8 * d.norm());
  }
}

TEST_CASE(
    "both solvers give equal motion, by rk4 and by semi-implicit Euler, with closing joints, strings and "
    "limits",
    "[joints][long]") {
  for (const Backend& backend : backends)
    for (const char* method : {"rk4", "semi_implicit_euler"}) {
      MultiBody one, two;
      tangled_parts(one);
      tangled_parts(two);
      one.joint_solver.choice = Choice::blocks;
      two.joint_solver.choice = Choice::augmented;
      backend.use(two.joint_solver);
      for (MultiBody* body : {&one, &two}) body->stabilization.assemble_first = false;
      Simulation blocks(one, method), augmented(two, method);
      test::run(blocks, 0.02, 20);
      test::run(augmented, 0.02, 20);
      INFO(backend.name << " " << method);
      CHECK((blocks.state().q - augmented.state().q).norm() <= 1e-9);
      CHECK((blocks.state().v - augmented.state().v).norm() <= 1e-7 * blocks.state().v.norm());
      CHECK(blocks.state().joints == augmented.state().joints);
    }
}

TEST_CASE("extreme mass ratios: the solvers agree after iterative refinement", "[joints]") {
  for (const Backend& backend : backends) {
    VecX<double> v_dot[2];
    double largest = 0, lightest = 0;
    for (const bool augmented : {false, true}) {
      MultiBody body;
      body.joint_solver.choice = augmented ? Choice::augmented : Choice::blocks;
      backend.use(body.joint_solver);
      for (int i = 0; i < 200; ++i) {
        Part& link = test::add(body, "link" + std::to_string(i), "ellipsoid", {}, i % 2 == 0 ? 1 : 1e6);
        link.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).place({0.3 + 0.6 * i, 0, 0});
        body.ball("joint" + std::to_string(i),
                  i == 0 ? world(0, 0, 0) : point(*body.parts()[static_cast<std::size_t>(i) - 1], 0, 0),
                  point(link, 0, kPi));
      }
      const Simulation simulation(body, "rk4");
      Workspace<double> work;
      const State& state = simulation.state();
      simulation.dynamics().accelerations(0, state.q, state.v, state, work);
      v_dot[augmented ? 1 : 0] = work.v_dot;
      largest = work.joints.lambda.lpNorm<Eigen::Infinity>();
      lightest = body.parts()[0]->total_mass();
    }
    INFO(backend.name);
    // The bound is 1e-10 m/s^2 plus 100 eps lambda / m. eps is the rounding of a double, lambda the largest
    // joint force, and m the mass of the first link, which is light.
    CHECK((v_dot[0] - v_dot[1]).lpNorm<Eigen::Infinity>() <= 1e-10 + 100 * 2.2e-16 * largest / lightest);
  }
}

TEST_CASE(
    "the choice: blocks for chains and few joints on a part, the augmented matrix for many joints on a part",
    "[joints]") {
  MultiBody few, many;
  star(few, 8);
  star(many, 400);
  for (MultiBody* body : {&few, &many}) use_suitesparse(body->joint_solver);
  const Model of_few(few);
  CHECK_FALSE(of_few.islands()[0].augmented);
  Simulation simulation(many, "rk4");
  CHECK(simulation.model().islands()[0].augmented);
  test::run(simulation, 0.01, 10);
  for (int j = 0; j < 400; ++j) REQUIRE(simulation.model().gap(simulation.state(), j) <= 1e-12);

  MultiBody chain;
  for (int i = 0; i < 2000; ++i) {
    Part& link = test::add(chain, "link" + std::to_string(i), "sphere", {}, 1000);
    link.place({2. * i, 0, 0});
    if (i > 0)
      chain.ball("joint" + std::to_string(i), point(*chain.parts()[static_cast<std::size_t>(i) - 1], 0, 0),
                 point(link, 0, kPi));
  }
  const Model of_chain(chain);
  CHECK_FALSE(of_chain.islands()[0].augmented);
}

}  // namespace joint_solvers_test
