// Laws of every joint formula, and the accelerations of parts with joints.
#include "catch.h"

#include <Eigen/LU>

#include <pliant/body/joints/all_joints.h>
#include <pliant/body/joints/joint_registry.h>

#include "differences.h"
#include "draws.h"
#include "motion.h"

namespace joints_test {

using namespace pliant;
using test::Draws;

namespace {

/// Compares C, C_dot, bias, C_x and gap() of a joint with finite differences, for points that move as
/// x + v t + a t^2 / 2. evaluate() receives these accelerations a, so that the bias is C_ddot.
template <class F>
void check_laws(const F& formula, std::uint64_t seed) {
  constexpr int kPoints = F::first + F::second;
  Draws draws(seed);
  for (int trial = 0; trial < 20; ++trial) {
    std::array<PointMotion<double>, kPoints> motion;
    std::vector<Point> points;
    for (PointMotion<double>& m : motion) {
      m = {draws.vector(2), draws.vector(1), draws.vector(3)};
      points.push_back(world(0, 0, 0));
    }
    const JointOf<F> joint("joint", points, formula);
    const double t0 = draws.uniform(0, 3);
    JointRows<double> rows;
    joint.evaluate(t0, motion.data(), rows);
    REQUIRE(rows.C.size() == F::rows);

    auto along = [&](long double t) {
      std::array<Vec3<long double>, kPoints> x;
      for (std::size_t k = 0; k < x.size(); ++k)
        x[k] = motion[k].x.template cast<long double>() + t * motion[k].x_dot.template cast<long double>() +
               t * t / 2 * motion[k].x_ddot.template cast<long double>();
      return VecX<long double>(joint.template C<long double>(x, static_cast<long double>(t0) + t));
    };
    const VecX<double> C = along(0).template cast<double>();
    const VecX<double> C_dot = test::first_derivative(along, 1e-3L).template cast<double>();
    const VecX<double> C_ddot = test::second_derivative(along, 1e-3L).template cast<double>();
    CHECK((rows.C - C).norm() <= 1e-13 * (1 + C_ddot.norm()));
    CHECK((rows.C_dot - C_dot).norm() <= 1e-10 * (1 + C_ddot.norm()));
    CHECK((rows.bias - C_ddot).norm() <= 1e-9 * (1 + C_ddot.norm()));

    VecX<double> moved(F::rows);
    std::array<Vec3<double>, kPoints> x;
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = motion[k].x;
    CHECK((joint.gap(t0, x.data()) - C).norm() <= 1e-13 * (1 + C_ddot.norm()));
    for (int k = 0; k < kPoints; ++k)
      for (int i = 0; i < 3; ++i) {
        auto shifted = [&](long double e) {
          std::array<Vec3<long double>, kPoints> y;
          for (std::size_t n = 0; n < y.size(); ++n) y[n] = x[n].template cast<long double>();
          y[static_cast<std::size_t>(k)][i] += e;
          return VecX<long double>(joint.template C<long double>(y, static_cast<long double>(t0)));
        };
        const VecX<double> slope = test::first_derivative(shifted, 1e-3L).template cast<double>();
        CHECK((rows.C_x.col(3 * k + i) - slope).norm() <= 1e-9 * (1 + slope.norm()));
      }
  }
}

/// Adds two deforming parts and a rigid part in a closed loop. The loop is also connected to a fixed part, to
/// a moving anchor and, by a string, to the world.
void loop(MultiBody& body) {
  Part& a = test::tumbling_solid(body, "a");
  body.gravity = {0.3, -1, -9.81};
  a.damping(0.4, 0.02, 0.1);
  Part& b = test::add(body, "b", "box", {"taper"}, 800);
  b.rest({{"a1", 0.2}, {"a2", 0.3}, {"a3", 0.4}}).stiffness({{"a1", 3e4}, {"taper.tx", 100}});
  b.place({1.5, 0.3, 0.2}, Eigen::Quaterniond(0.5, 0.5, -0.1, 0.6)).velocity({0, 0.4, 0}, {-1, 0.5, 2});
  Part& c = test::add(body, "c", "sphere", {}, 500);
  c.rest({{"r", 0.3}}).place({0.4, 1, 0}).velocity({0.1, 0.2, 0}, {0, 1, 2});
  Part& post = test::add(body, "post", "cylinder", {}, 1000);
  post.place({-1, 0, 0}).fix();
  body.ball("ab", point(a, 0.5, 0.3), point(b, -0.4, 1, 0.7));
  body.ball("bc", point(b, 0.9, -1), point(c, 0.1, 2));
  body.join("ca", Rod{0.6}, {point(c, -0.3, -1), point(a, 0.1, -1)});
  body.join("hang", Rod{1.2}, {point(a, -0.5, 2), point(post, 0, 0)});
  body.ball("hand", world({test::wave(0.5, 0.3, 4), 0.2, test::wave(0.1, 0.2, 3, 1)}), point(b, 1.2, -2));
  body.join("string", String{0.2}, {world(0.4, 1, 2), point(c, kPi / 2, 0)});
}

}  // namespace

TEST_CASE("every joint: C_dot, C_ddot and C_x are the derivatives of C", "[joints]") {
  std::apply([](const auto&... formula) { (check_laws(formula, 1), ...); }, AllJoints{});
}

TEST_CASE("accelerations: C_ddot + 2 alpha C_dot + beta^2 C = 0 for every row, in closed loops too",
          "[joints]") {
  for (const bool deforming : {true, false}) {
    MultiBody body;
    loop(body);
    if (!deforming)
      for (const auto& part : body.parts()) {
        std::vector<std::string> names;
        for (const int k : part->parameters().dynamic()) names.push_back(part->parameters()[k].name);
        part->freeze(names);
      }
    body.stabilization.rule = BaumgarteRule::free;
    body.stabilization.stab_alpha = 3;
    body.stabilization.stab_beta = 5;
    body.stabilization.speed = 1e6;
    const Simulation simulation(body, "rk4");
    const Dynamics& dynamics = simulation.dynamics();
    const State& state = simulation.state();
    Workspace<double> work;
    const double t = 0.3;
    dynamics.accelerations(t, state.q, state.v, state, work);
    // C_ddot is the central difference of C_dot along q + e q_dot and v + e v_dot, with the accelerations
    // v_dot.
    VecX<double> q_dot;
    auto C_dot = [&](double e) {
      Workspace<double> scratch;
      VecX<double> q = state.q, v = state.v + e * work.v_dot;
      VecX<double> rate;
      dynamics.coordinate_rates(state.q, state.v, rate);
      dynamics.accelerations(t + e, state.q + e * rate, v, state, scratch);
      return scratch.joints.C_dot;
    };
    const double e = 1e-5;
    const VecX<double> C_ddot = (C_dot(e) - C_dot(-e)) / (2 * e);
    const VecX<double> sum = C_ddot + 6 * work.joints.C_dot + 25 * work.joints.C;
    for (const JointModel& joint : simulation.model().joints()) {
      INFO(joint.joint->name());
      CHECK(sum.segment(joint.row, joint.rows).norm() <= 1e-6 * (1 + C_ddot.norm()));
    }
    // The ends of the string are farther apart than its length, so that it exerts a force.
    CHECK(work.joints.lambda[simulation.model().joints().back().row] > 0);
  }
}

TEST_CASE("directional derivatives of the accelerations with joints agree with finite differences",
          "[joints]") {
  MultiBody body;
  loop(body);
  body.find("b")->limits("a1", {0.1, 0.2});  // at its limit from the start
  const Simulation simulation(body, "rk4");
  const Dynamics& dynamics = simulation.dynamics();
  const State& state = simulation.state();
  Draws draws(1);
  Workspace<double> work, scratch;
  Workspace<Dual<1>> dual;
  const double t = 0.3;
  dynamics.accelerations(t, state.q, state.v, state, work);
  auto random = [&](Eigen::Index n, double size) {
    VecX<double> x(n);
    for (Eigen::Index i = 0; i < n; ++i) x[i] = draws.uniform(-size, size);
    return x;
  };
  const PartModel& b = simulation.model().parts()[1];
  for (int trial = 0; trial < 5; ++trial) {
    const VecX<double> dq = random(state.q.size(), 0.1);
    VecX<double> dv = random(state.v.size(), 1);
    dv[b.v0 + 6] = 0;  // the parameter is at its limit
    const VecX<double> derivative = dynamics.jvp(t, state.q, state.v, {dq, dv}, work, dual);
    const VecX<double> expected =
        test::first_derivative(
            [&](long double e) {
              const double k = static_cast<double>(e);
              dynamics.accelerations(t, state.q + k * dq, state.v + k * dv, state, scratch);
              return VecX<long double>(scratch.v_dot.cast<long double>());
            },
            1e-4L)
            .cast<double>();
    CHECK((derivative - expected).norm() <= 1e-6 * expected.norm());
  }
}

TEST_CASE("invalid joints are refused, and the message names them", "[joints]") {
  MultiBody body;
  Part& a = test::add(body, "a", "sphere", {}, 500);
  Part& b = test::add(body, "b", "sphere", {}, 500);
  Part& post = test::add(body, "post", "sphere", {}, 500);
  post.fix();
  body.ball("ab", point(a, 0, 0), point(b, 0, 0));
  CHECK_THROWS_WITH(body.ball("ab", point(a, 0, 0), point(b, 0, 0)), "there are two joints called 'ab'");
  CHECK_THROWS_WITH(body.ball("", point(a, 0, 0), point(b, 0, 0)), "a joint needs a name");
  CHECK_THROWS_WITH(body.join("x", Ball{}, {point(a, 0, 0)}), "ball 'x' ties 2 points, not 1");
  CHECK_THROWS_WITH(body.join("x", Rod{-1}, {point(a, 0, 0), point(b, 0, 0)}), "rod 'x' needs a length > 0");
  CHECK_THROWS_WITH(body.join("x", String{std::nan("")}, {point(a, 0, 0), point(b, 0, 0)}),
                    "string 'x' needs a length > 0");
  body.stabilization.rate = -1;
  CHECK_THROWS_WITH(Model(body), test::has_text("rate must be a number > 0"));
  body.stabilization.rate = 10;
  body.ball("dead", point(post, 0, 0), world(0, 0, 0));
  CHECK_THROWS_WITH(Model(body), "ball 'dead' ties no part that moves");
}

TEST_CASE(
    "joints within a rigid part are refused for every type, as is BaumgarteRule::free with stab_beta = 0",
    "[joints]") {
  for (const JointInfo& info : all_joints()) {
    MultiBody body;
    Part& a = test::add(body, "a", "ellipsoid", {}, 500);
    a.prepare();
    JointSetting setting{point(a, 0, 0, 0), point(a, 0.3, 1)};
    setting.length = 0.5;
    body.join(info.name, "tie", setting);
    CHECK_THROWS_WITH(Model(body),
                      std::string(info.name) + " 'tie' ties part 'a', which does not deform, to itself");
  }
  MultiBody body;
  body.stabilization.rule = BaumgarteRule::free;
  CHECK_THROWS_WITH(Model(body), test::has_text("the rule free needs stab_beta > 0"));
}

}  // namespace joints_test
