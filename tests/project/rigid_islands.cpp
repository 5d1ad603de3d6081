// Rigid parts on ball joints (rigid islands): their specialised evaluation and projection of joints agree
// with the general evaluation and projection.
#include "catch.h"

#include <pliant/body/constraint/rigid_island.h>
#include <pliant/body/joints/all_joints.h>
#include <pliant/math/time/linear_keys.h>
#include <pliant/project/project.h>

#include "draws.h"
#include "motion.h"

namespace rigid_islands_test {

using namespace pliant;
using test::Draws;

namespace {

/// Adds n frozen, tapered boxes whose centres of mass are not at their origins. The first box hangs from the
/// world, each other box from an earlier box. A fixed post is not connected to them. If n > 1, a bar hangs
/// from the last box. With loops > 0 the bar closes a loop to the world, and the first joint is doubled.
void add_hanging_boxes(MultiBody& body, int n, int loops, std::uint64_t seed) {
  Draws draws(seed);
  auto random_point = [&](const Part& part) {
    return point(part, draws.uniform(-1, 1), draws.uniform(-3, 3), draws.uniform(0.2, 1));
  };
  auto position = [](const Part& part, const Point& at) {
    return Vec3<double>(part.c0() + part.R0() * part.s({at.material}, part.parameters().rest()).col(0));
  };
  std::vector<Part*> parts;
  auto join_closed = [&](Part& part, const Part& to) {
    // The part is moved, so that its random point coincides with a random point of the other part.
    const Point a = random_point(part), b = random_point(to);
    part.place(part.c0() + position(to, b) - position(part, a), part.R0());
    body.ball("joint" + std::to_string(body.joints().size()), a, b);
  };
  for (int i = 0; i < n; ++i) {
    Part& part = test::add(body, "part" + std::to_string(i), "box", {"taper"}, draws.uniform(300, 3000));
    part.rest({{"a1", draws.uniform(0.1, 0.3)},
               {"a2", draws.uniform(0.1, 0.3)},
               {"a3", draws.uniform(0.1, 0.3)},
               {"taper.tx", draws.uniform(-0.5, 0.5)}});
    part.place(draws.vector(1), Eigen::Quaterniond(draws.uniform(0.1, 1), draws.uniform(-1, 1),
                                                   draws.uniform(-1, 1), draws.uniform(-1, 1))
                                    .normalized());
    if (i == 0) {
      const Point at = random_point(part);
      const Vec3<double> x = position(part, at);
      body.ball("hook", at, world(x[0], x[1], x[2]));
      if (loops > 0) body.ball("hook again", at, world(x[0], x[1], x[2]));
    } else {
      join_closed(part, *parts[static_cast<std::size_t>(draws.integer(0, i - 1))]);
    }
    parts.push_back(&part);
  }
  Part& post = test::add(body, "post", "sphere", {}, 1000);
  post.place({0.2, 0.1, -1}).fix();
  if (n > 1) {
    // The bar is placed so that its joints are closed.
    Part& last = *parts.back();
    const Point end = random_point(last);
    const Vec3<double> x = position(last, end);
    Part& bar = test::add(body, "bar", "box", {}, 800);
    bar.rest({{"a1", 0.4}, {"a2", 0.05}, {"a3", 0.05}});
    const Point near = point(bar, 0, kPi), far = point(bar, 0, 0);
    bar.place(x);
    bar.place(x + x - position(bar, near), bar.R0());
    body.ball("to the bar", end, near);
    if (loops > 0) {
      const Vec3<double> y = position(bar, far);
      body.ball("to the world", far, world(y[0], y[1], y[2]));
    }
  }
}

double gap(const Simulation& simulation) {
  double widest = 0;
  for (int j = 0; j < static_cast<int>(simulation.model().joints().size()); ++j)
    widest = std::max(widest, simulation.model().gap(simulation.state(), j));
  return widest;
}

}  // namespace

TEST_CASE("rigid parts on ball joints: the specialised and the general evaluation give equal accelerations",
          "[rigid_islands]") {
  const int n = GENERATE(1, 2, 3, 4, 5, 9, 18), loops = GENERATE(0, 1);
  MultiBody body;
  add_hanging_boxes(body, n, loops, static_cast<std::uint64_t>(10 * n + loops));
  body.changing_gravity =
      TimeVector(0.5, linear_key_frames({0, 1}, {0, 3}), linear_key_frames({0, 1}, {-9, -7}));
  Simulation simulation(body, "rk4");
  const Model& model = simulation.model();
  REQUIRE(model.rigid_islands().size() == 1);
  for (int instant = 0; instant < 4; ++instant) {
    const State& state = simulation.state();
    Workspace<double> general, special;
    simulation.dynamics().accelerations(state.time(), state.q, state.v, state, general);
    simulation.dynamics().rates(state.time(), state.q, state.v, state, special);
    simulation.dynamics().rates(state.time(), state.q, state.v, state, special);
    REQUIRE(special.rigid[0].used);
    CHECK((special.v_dot - general.v_dot).norm() <= 1e-11 * general.v_dot.norm());
    CHECK(general.power.norm() > 0);
    CHECK((special.power - general.power).norm() <= 1e-12 * general.power.norm());
    const double before = gap(simulation);
    for (int i = 0; i < 10; ++i) simulation.step(0.005);
    CHECK(gap(simulation) <= std::max(before, 1e-12));
  }
}

TEST_CASE("loads and other parts beside rigid islands do not change how the islands are evaluated",
          "[rigid_islands]") {
  MultiBody body;
  add_hanging_boxes(body, 6, 0, 7);
  Part& free = test::add(body, "free", "box", {"taper"}, 900);
  free.rest({{"taper.tx", 0.4}}).place({4, 0, 0}).velocity({0, 1, 0}, {1, 2, 3});
  Part& soft = test::add(body, "soft", "sphere", {}, 500);
  soft.stiffness({{"r", 1e4}}).place({0, 5, 0});
  body.spring("free to chain", point(free, 0.4, 1), point(*body.parts()[2], 0.2, 2), 300, 3, 0.5);
  body.spring("soft to chain", point(soft, 0, 0), point(*body.parts()[4], 0.2, 2), 200, 0, 0);
  body.force("pull", point(*body.parts()[1], 0.7, 1), {5, -3, 2}, Frame::body);
  body.torque("turn", free, {0, 2, 1});
  Simulation simulation(body, "rk4");
  const Model& model = simulation.model();
  REQUIRE(model.rigid_islands().size() == 1);
  CHECK(model.parts()[static_cast<std::size_t>(body.index(soft))].rigid_island == -1);
  for (int i = 0; i < 5; ++i) {
    simulation.step(0.01);
    const State& state = simulation.state();
    Workspace<double> general, special;
    simulation.dynamics().accelerations(state.time(), state.q, state.v, state, general);
    simulation.dynamics().rates(state.time(), state.q, state.v, state, special);
    simulation.dynamics().rates(state.time(), state.q, state.v, state, special);
    CHECK((special.v_dot - general.v_dot).norm() <= 1e-11 * general.v_dot.norm());
    CHECK((special.power - general.power).norm() <= 1e-12 * general.power.norm());
  }
}

TEST_CASE("rigid islands project joints from small gaps; from large gaps they refuse and change nothing",
          "[rigid_islands]") {
  MultiBody body;
  add_hanging_boxes(body, 6, 0, 3);
  Simulation simulation(body, "rk4");
  simulation.step(0.01);
  const State& state = simulation.state();
  const RigidIsland& rigid = simulation.model().rigid_islands()[0];
  const Island& island = simulation.model().islands()[0];
  Workspace<double> work;
  simulation.dynamics().rates(state.time(), state.q, state.v, state, work);
  simulation.dynamics().rates(state.time(), state.q, state.v, state, work);
  Draws draws(5);
  auto perturbed = [&](double size) {
    State to = state;
    for (Eigen::Index i = 0; i < to.q.size(); ++i) to.q[i] += size * draws.uniform(-1, 1);
    for (Eigen::Index i = 0; i < to.v.size(); ++i) to.v[i] += size * draws.uniform(-1, 1);
    return to;
  };
  State near = perturbed(1e-6);
  REQUIRE(
      rigid.close(island, {1e-13, 4e-15, 10}, work.joints.W_c[0].blocks(), work.rigid[0], near.q, near.v));
  double widest = 0;
  for (int j = 0; j < static_cast<int>(simulation.model().joints().size()); ++j)
    widest = std::max(widest, simulation.model().gap(near, j));
  CHECK(widest <= 1e-13);
  simulation.dynamics().accelerations(state.time(), near.q, near.v, near, work);
  CHECK(work.joints.C_dot.lpNorm<Eigen::Infinity>() <= 1e-12);

  const State far = perturbed(0.5);
  State kept = far;
  CHECK_FALSE(
      rigid.close(island, {1e-13, 4e-15, 10}, work.joints.W_c[0].blocks(), work.rigid[0], kept.q, kept.v));
  CHECK(kept.q == far.q);
  CHECK(kept.v == far.v);
}

TEST_CASE(
    "semi-implicit Euler projects joints of rigid parts at the end of its step as the general method does",
    "[rigid_islands]") {
  const int n = GENERATE(1, 6, 13);
  const auto after = [&](bool special) {
    MultiBody body;
    add_hanging_boxes(body, n, 0, static_cast<std::uint64_t>(n));
    // A string that stays slack makes the general method evaluate the island.
    if (!special)
      body.join("slack", String{100},
                {point(*body.parts().front(), 0, 0), point(*body.parts().back(), 0, 0)});
    Simulation simulation(body, "semi_implicit_euler");
    REQUIRE(simulation.model().rigid_islands().size() == (special ? 1 : 0));
    for (int i = 0; i < 200; ++i) simulation.step(0.002);
    CHECK(gap(simulation) <= 1e-12);
    return simulation.state();
  };
  const State special = after(true), general = after(false);
  CHECK((special.q - general.q).norm() <= 1e-9 * general.q.norm());
  CHECK((special.v - general.v).norm() <= 1e-9 * general.v.norm());
}

TEST_CASE("a trial step that is not finite leaves no state behind that stops later steps",
          "[rigid_islands]") {
  for (double size = 1e130; size < 1e165; size *= 1e5) {
    MultiBody body;
    body.gravity.setZero();
    for (int i = 0; i < 4; ++i) {
      Part& link = test::add(body, "link" + std::to_string(i), "box", {}, 1000);
      link.rest({{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.5}}).place({0, 0, -1.0 * i - 0.5});
      body.ball("joint" + std::to_string(i), point(link, kPi / 2, 0),
                i == 0 ? world(0, 0, 0) : point(*body.parts()[static_cast<std::size_t>(i - 1)], -kPi / 2, 0));
    }
    // Only trials of far too long steps reach the region where the force is enormous.
    body.force("push", point(*body.parts()[3], -kPi / 2, 0),
               [&](double t, const Vec3<double>& x, const Vec3<double>&) {
                 double push = t > 1 ? 1000 * std::sin(50 * (t - 1)) : 0;
                 if (std::abs(x[0]) > 3.9) push += size;
                 return Vec3<double>(push, 0.3 * push, 0);
               });
    Simulation simulation(body, "dop853", 1, 1e-6);
    REQUIRE(simulation.model().rigid_islands().size() == 1);
    INFO(size);
    CHECK_NOTHROW(simulation.step(1.5));
  }
}

TEST_CASE("islands that contain more than rigid parts on ball joints use the general evaluation",
          "[rigid_islands]") {
  MultiBody body;
  Part& ball = test::add(body, "ball", "sphere", {}, 1000);
  Part& other = test::add(body, "other", "box", {}, 1000);
  other.place({3, 0, 0});
  body.ball("tie", point(ball, 0, 0), point(other, 0, 0));
  auto islands = [&] { return Model(body).rigid_islands().size(); };
  REQUIRE(islands() == 1);
  SECTION("a dynamic parameter") {
    ball.stiffness({{"r", 1e4}});
    CHECK(islands() == 0);
  }
  SECTION("drag") {
    ball.damping(0, 0, 0.1);
    CHECK(islands() == 0);
  }
  SECTION("a rod") {
    body.join("rod", Rod{3}, {point(ball, 0, 0), point(other, 0, 0)});
    CHECK(islands() == 0);
  }
  SECTION("a moving anchor") {
    body.ball("carried", point(ball, 0, 0), world({test::wave(0, 1, 2), TimeFunction(0), TimeFunction(0)}));
    CHECK(islands() == 0);
  }
  SECTION("joints that are closing, or kept closed by Baumgarte terms alone") {
    body.stabilization.projection = GENERATE(true, false);
    const Simulation simulation(body, "rk4");
    const State& state = simulation.state();
    Workspace<double> work;
    simulation.dynamics().rates(0, state.q, state.v, state, work);
    CHECK_FALSE(work.rigid[0].used);
  }
}

}  // namespace rigid_islands_test
