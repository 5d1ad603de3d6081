// Energy and momentum in contact: inelastic, frictional motion gains no energy beyond the error of a step,
// and a rod in Painleve's paradox jams. An impact on a springboard follows the closed form. A joint that
// pulls a part through a floor stays closed, and the contact residual is reported.
// N57 and N59 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <cmath>
#include <functional>

#include <pliant/body/joints/all_joints.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>

#include "motion.h"
#include "worst.h"

namespace contact_balance_test {

using namespace pliant;

namespace {

using Build = std::function<void(MultiBody&)>;

void floor(MultiBody& body) {
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
void tumbling_box(MultiBody& body) {
  Part& part = body.add(make_part("box", "box", {}, 1000));
  part.rest({{"a1", 0.1}, {"a2", 0.15}, {"a3", 0.2}});
  part.place({0, 0, 0.6}, Eigen::Quaterniond(0.8, 0.1, -0.5, 0.2).normalized());
  part.velocity({1, 0.3, 0}, {3, -2, 5});
  floor(body);
}
void pile(MultiBody& body) {
  for (int i = 0; i < 6; ++i)
    body.add(make_part("part" + std::to_string(i), "ellipsoid", {}, 1000))
        .rest({{"a1", 0.1}, {"a2", 0.08}, {"a3", 0.06}})
        .place({0.03 * (i % 2), 0.02 * (i % 3), 0.15 + 0.25 * i},
               Eigen::Quaterniond(Eigen::AngleAxisd(i, Vec3<double>(1, 2, 3).normalized())));
  floor(body);
}
void chain(MultiBody& body) {
  Part* last = nullptr;
  for (int i = 0; i < 4; ++i) {
    Part& part = body.add(make_part("part" + std::to_string(i), "ellipsoid", {}, 1000));
    part.rest({{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.15}});
    part.place({0.3 * i, 0, 0.5}, Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 2, Vec3<double>::UnitY())));
    if (last != nullptr)
      body.ball("joint" + std::to_string(i), point(*last, kPi / 2, 0), point(part, -kPi / 2, 0));
    last = &part;
  }
  floor(body);
}

/// Adds a part with two dynamic semi-axes and a dynamic taper.
void tumbling_solid(MultiBody& body) {
  Part& part = test::add(body, "solid", "superellipsoid", {"taper"}, 1000);
  part.rest({{"a1", 0.1}, {"a2", 0.15}, {"a3", 0.2}, {"taper.tx", 0.3}});
  part.stiffness({{"a1", 3000}, {"a3", 2000}, {"taper.tx", 20}});
  part.place({0, 0, 0.6}, Eigen::Quaterniond(0.8, 0.1, -0.5, 0.2).normalized());
  part.velocity({1, 0.3, 0}, {3, -2, 5});
  floor(body);
}
/// Adds three parts with dynamic semi-axes.
void soft_pile(MultiBody& body) {
  for (int i = 0; i < 3; ++i)
    test::add(body, "part" + std::to_string(i), "ellipsoid", {}, 1000)
        .rest({{"a1", 0.1}, {"a2", 0.08}, {"a3", 0.06}})
        .stiffness({{"a1", 4000}, {"a2", 4000}, {"a3", 4000}})
        .place({0.03 * (i % 2), 0.02 * i, 0.15 + 0.25 * i},
               Eigen::Quaterniond(Eigen::AngleAxisd(i, Vec3<double>(1, 2, 3).normalized())));
  floor(body);
}
void soft_pair_on_a_joint(MultiBody& body) {
  std::vector<Part*> parts;
  for (int i = 0; i < 2; ++i) {
    parts.push_back(&test::add(body, "part" + std::to_string(i), "ellipsoid", {}, 1000));
    parts[i]->rest({{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.15}});
    parts[i]->stiffness({{"a1", 4000}, {"a2", 4000}, {"a3", 4000}});
    parts[i]->place({0.3 * i, 0, 0.3}, Eigen::Quaterniond(Eigen::AngleAxisd(kPi / 2, Vec3<double>::UnitY())));
    parts[i]->velocity({1, 0, 0}, {0, 0, 0});
  }
  body.ball("joint", point(*parts[0], kPi / 2, 0), point(*parts[1], -kPi / 2, 0));
  floor(body);
}
Part& balloon(MultiBody& body, const Vec3<double>& at) {
  Part& part = test::add(body, "balloon", "ellipsoid", {}, 1);
  part.make_shell().rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}}).place(at);
  LocalSettings settings;
  settings.resolution = 2;
  settings.alpha = 2;
  settings.energies = {local_law("neo_hookean_membrane", {2e4, 0.4, 1e-3}), local_law("pressure", {20})};
  return part.deform_locally(settings);
}
void rolling_balloon(MultiBody& body) {
  balloon(body, {0, 0, 0.12}).velocity({0.5, 0, -1}, {0, 5, 0});
  floor(body);
}
void balloon_on_an_arm(MultiBody& body) {
  Part& held = balloon(body, {0.3, 0, 0.2});
  Part& arm = test::add(body, "arm", "ellipsoid", {}, 100);
  arm.rest({{"a1", 0.1}, {"a2", 0.02}, {"a3", 0.02}}).place({0.1, 0, 0.2});
  body.ball("pivot", world(0, 0, 0.2), point(arm, 0, kPi));
  body.ball("grip", point(arm, 0, 0), point(held, 0, kPi));
  floor(body);
}

/// Energy gains of a run, relative to the energy at the start. `energy` is the largest rise of the energy in
/// a step, minus the error of the step. `balance` is the largest rise of the energy minus the work in the
/// ledger, minus the error of the step. `sum` adds up the positive rises of all steps, each minus the error
/// of the step. `remaining` is the energy at the end.
struct Gain {
  test::Worst energy, balance;
  double sum = 0, remaining = 0;
};
/// Runs `steps` steps of h (s). substep_counts: numbers of substeps with which the error of a step is
/// estimated.
Gain gain(const Build& build, const std::string& method, double h, int steps,
          const std::vector<int>& substep_counts = {2, 4}) {
  MultiBody one, other;
  build(one);
  build(other);
  Simulation full_step(one, method), substeps(other, method);
  const double start = full_step.ledger().energy();
  auto balance = [](const Ledger& ledger) { return ledger.energy() - ledger.work.sum(); };
  Gain gain;
  for (int i = 0; i < steps; ++i) {
    const State at = full_step.state();
    const Ledger before = full_step.ledger();
    full_step.step(h);
    const Ledger after = full_step.ledger();
    // The error of a step is proportional to the square of its length. To leading order, n substeps therefore
    // have 1 / n of the error of the full step. Four substeps are tried too, because an impact near the
    // middle also divides the full step into halves, and two substeps then show no error. More substeps are
    // needed if a step contains several impacts.
    double energy = 0, balanced = 0;
    for (const int n : substep_counts) {
      substeps.set_state(at);
      for (int k = 0; k < n; ++k) substeps.step(h / n);
      const Ledger finer = substeps.ledger();
      const double error_ratio = n / (n - 1.0);
      energy = std::max(energy, error_ratio * std::abs(after.energy() - finer.energy()));
      balanced = std::max(balanced, error_ratio * std::abs(balance(after) - balance(finer)));
    }
    const double rise = (after.energy() - before.energy() - energy) / start;
    gain.energy.note(rise);
    gain.sum += std::max(0.0, rise);
    gain.balance.note((balance(after) - balance(before) - balanced) / start);
  }
  gain.remaining = full_step.ledger().energy() / start;
  return gain;
}

}  // namespace

TEST_CASE("inelastic contact with friction gains no energy beyond the error of a step", "[contact][long]") {
  for (const Build& build : std::vector<Build>{tumbling_box, pile, chain})
    for (const char* method : {"rk4", "semi_implicit_euler"}) {
      CAPTURE(method);
      const Gain result = gain(build, method, 1e-3, 700, {2, 4, 16});
      // Parts may overlap after a collision within a step. The step separates them, and the ledger contains
      // the work of this separation.
      CHECK(result.energy <= 1e-9);
      CHECK(result.balance <= (std::string(method) == "semi_implicit_euler" ? 1e-6 : 1e-7));
      CHECK(result.sum <= 1e-7);
      CHECK(result.remaining < 0.95);
    }
}

TEST_CASE("deformable parts gain no energy in inelastic contact beyond the error of a step",
          "[contact][long]") {
  struct Scene {
    const char* name;
    Build build;
    double h;
    int steps;
    std::vector<std::string> methods;
  };
  const std::vector<std::string> all{"rk4", "implicit_midpoint", "semi_implicit_euler"};
  const std::vector<Scene> scenes{{"tumbling solid", tumbling_solid, 1e-3, 700, all},
                                  {"soft pile", soft_pile, 1e-3, 500, all},
                                  {"soft pair on a joint", soft_pair_on_a_joint, 1e-3, 700, all},
                                  {"rolling balloon", rolling_balloon, 2e-4, 1500, all},
                                  {"balloon on an arm", balloon_on_an_arm, 2e-4, 2000, all},
                                  {"rolling balloon", rolling_balloon, 1e-3, 300, {"linearly_implicit"}},
                                  {"balloon on an arm", balloon_on_an_arm, 1e-3, 400, {"linearly_implicit"}}};
  for (const Scene& scene : scenes)
    for (const std::string& method : scene.methods) {
      CAPTURE(scene.name, method);
      const Gain result = gain(scene.build, method, scene.h, scene.steps);
      const bool first_order = method == "semi_implicit_euler";
      // The error of a step is estimated to leading order only. For vibrations with a method of first order,
      // the estimate is accurate to a few per cent.
      CHECK(result.energy <= (first_order ? 1e-4 : 2e-7));
      CHECK(result.balance <= (first_order ? 1e-4 : 1e-6));
      CHECK(result.sum <= (first_order ? 1e-3 : 1e-5));
      CHECK(result.remaining < 0.6);
    }
}

TEST_CASE("a rod that slides on its tip in Painleve's paradox jams, and gains no energy", "[contact]") {
  // A thin rod slides on the floor, inclined by `angle`, with its lower tip ahead of its centre. The mass of
  // the rod is m, the speed of the tip v, and s and c are the sine and cosine of the angle. If 3 mu s c > 1 +
  // 3 c^2, no motion with finite forces obeys Coulomb's law; if the rod also rotates away from the floor,
  // more than one motion obeys it. The solution is an impulse without a collision, which stops the tip at
  // once. Its components along and normal to the floor are m v (1 + 3 c^2) / 4 and 3 m v s c / 4.
  const double half = 0.5, radius = 0.005, speed = 2, h = 1e-3;
  for (const char* method : {"rk4", "semi_implicit_euler"})
    for (const double angle : {kPi / 4, std::atan(2.0), 1.3})
      for (const double spin : {0.0, 8.0}) {
        CAPTURE(method, angle, spin);
        const double s = std::sin(angle), c = std::cos(angle), mu = 2.5;
        REQUIRE(3 * mu * s * c > 1 + 3 * c * c);
        MultiBody body;
        body.contact.friction = mu;
        floor(body);
        Part& rod = test::add(body, "rod", "capsule", {}, 1000);
        rod.rest({{"r", radius}, {"l", 2 * (half - radius)}});
        const Eigen::Quaterniond R(Eigen::AngleAxisd(kPi / 2 - angle, Vec3<double>::UnitY()));
        const Vec3<double> omega(0, spin, 0);
        rod.place({0, 0, (half - radius) * s + radius}, R);
        rod.velocity(Vec3<double>(-speed, 0, 0) + omega.cross(Vec3<double>(half * c, 0, half * s)),
                     R.conjugate() * omega);
        Simulation simulation(body, method);
        const double start = simulation.ledger().energy();
        double energy = start;
        for (int i = 0; i < 100; ++i) {
          simulation.step(h);
          REQUIRE(simulation.ledger().energy() < energy + 2e-5 * start);
          energy = simulation.ledger().energy();
          for (const Contact& contact :
               ContactFinder(simulation.model()).find(simulation.state(), simulation.time(), 0))
            REQUIRE(contact.gap > -1e-4 * half);
          if (i > 0 || spin > 0) continue;
          Vec3<double> jam = Vec3<double>::Zero();
          for (const Vec3<double>& p : simulation.contact()->impulses()) jam += p;
          const double unit = rod.total_mass() * speed / 4;
          CHECK(jam[0] == Approx(unit * (1 + 3 * c * c)).epsilon(0.03));
          CHECK(jam[2] == Approx(unit * 3 * s * c).epsilon(0.03));
          CHECK(start - energy == Approx(0.5 * unit * speed * (1 + 3 * c * c)).epsilon(0.03));
        }
        CHECK(energy < (1 + 2e-5) * start);
        CHECK(simulation.step_counters().contact_residual < 5e-11);
        CHECK(simulation.step_counters().contact_fallbacks == 0);
      }
}

TEST_CASE("N59: the impact of a ball on a springboard follows the closed form", "[contact][joints]") {
  const double radius = 0.05, x = 0.6, speed = 3;
  for (const double e : {0.0, 0.5, 1.0}) {
    MultiBody body;
    body.gravity.setZero();
    body.contact.active = true;
    body.contact.friction = 0;
    body.contact.restitution = e;
    Part& board = body.add(make_part("board", "box", {}, 500));
    board.rest({{"a1", 0.8}, {"a2", 0.1}, {"a3", 0.02}});
    body.hinge("pivot", point(board, 0, 0, 0), world(0, 0, 0), {0, 1, 0});
    Part& ball = body.add(make_part("ball", "sphere", {}, 1000));
    ball.rest({{"r", radius}}).place({x, 0, 0.02 + radius + 1e-2}).velocity({0, 0, -speed}, {0, 0, 0});
    Simulation simulation(body, "rk4");
    const double m = ball.total_mass(), M = board.total_mass();
    const double inertia = M / 3 * (0.8 * 0.8 + 0.02 * 0.02);
    // p is the impulse, at the distance x from the hinge, that separates ball and board with e times the
    // approach speed.
    const double p = (1 + e) * speed / (1 / m + x * x / inertia);
    const ContactRecord& record = simulation.contact()->record();
    while (record.contacts.empty() && simulation.time() < 0.02) simulation.step(1e-3);
    REQUIRE_FALSE(record.contacts.empty());
    const State& state = simulation.state();
    CAPTURE(e, record.contacts.size());
    // The first contact of the record is the impact itself. Ball and board may touch during the rest of the
    // step.
    CHECK(record.impulses[0].norm() == Approx(p).epsilon(1e-9));
    Vec3<double> sum = Vec3<double>::Zero();
    for (std::size_t k = 0; k < record.contacts.size(); ++k)
      sum += (record.contacts[k].a.part == 1 ? 1 : -1) * record.impulses[k];
    CHECK((m * (state.v.segment<3>(6) - Vec3<double>(0, 0, -speed)) - sum).norm() < 1e-10 * p);
    CHECK(std::abs(state.v[6 + 2] + speed - p / m) < 1e-3 * speed);
    CHECK(state.v[4] == Approx(x * p / inertia).epsilon(1e-3));
    Workspace<double> work;
    const Dynamics& dynamics = simulation.dynamics();
    dynamics.evaluate_joints(state.time(), state.q, state.v, state.joints, simulation.model().islands()[0],
                             work);
    // The centre of the board is at rest: the pivot receives the whole impulse.
    const Vec3<double> received = dynamics.joint_wrench(state.time(), 0, work, record.joint_impulses).force;
    CHECK((received - sum).norm() < 1e-10 * p);
    CHECK(simulation.model().gap(state, 0) < 1e-12);
  }
}

TEST_CASE(
    "N57: a joint that pulls a part through the floor stays closed, and the contact residual is reported",
    "[contact][joints]") {
  for (const std::string method : {"rk4", "semi_implicit_euler", "implicit_midpoint", "dop853"}) {
    CAPTURE(method);
    MultiBody body;
    Part& ball = body.add(make_part("ball", "sphere", {}, 1000));
    ball.rest({{"r", 0.1}}).place({0, 0, 0.3});
    floor(body);
    body.ball("pull", point(ball, 0, 0, 0), world(TimeVector(0, 0, test::wave(0.3, -0.4, 1))));
    Simulation simulation(body, method, 1, method == "dop853" ? 1e-8 : 0);
    const double energy_limit = simulation.ledger().energy() + 0.5 * ball.total_mass() * 0.4 * 0.4;
    double lowest = 1;
    for (int i = 0; i < 1500; ++i) {
      simulation.step(2e-3);
      REQUIRE(simulation.model().gap(simulation.state(), 0) < 1e-12);
      REQUIRE(simulation.ledger().energy() <= energy_limit);
      lowest = std::min(lowest, simulation.state().q[2]);
    }
    CHECK(lowest == Approx(-0.1).epsilon(1e-4));  // as deep as the joint pulls it
    // The residual is the speed of the anchor when the ball touches the floor.
    CHECK(simulation.step_counters().contact_residual ==
          Approx(0.4 * std::cos(std::asin(0.5))).epsilon(1e-2));
  }
}

TEST_CASE(
    "N57: a joint that would close through the floor stays open, and a joint inside the floor stays closed",
    "[contact][joints]") {
  for (const std::string method : {"rk4", "semi_implicit_euler", "implicit_midpoint", "dop853"})
    for (const bool in_floor : {false, true}) {
      CAPTURE(method, in_floor);
      MultiBody body;
      Part& ball = body.add(make_part("ball", "sphere", {}, 1000));
      ball.rest({{"r", 0.1}}).place({0, 0, in_floor ? 0.05 : 0.3});
      floor(body);
      body.ball("pull", point(ball, 0, 0, 0), world(0, 0, in_floor ? 0.05 : 0.02));
      Simulation simulation(body, method, 1, method == "dop853" ? 1e-6 : 0);
      const double start = simulation.ledger().energy();
      for (int i = 0; i < 500; ++i) {
        simulation.step(2e-3);
        // The force that closes the joint may accelerate the fall.
        REQUIRE(simulation.ledger().energy() < (in_floor ? 1 + 1e-12 : 1.1) * start);
        REQUIRE(simulation.state().q[2] > (in_floor ? 0.05 : 0.1) - 1e-9);
      }
      CHECK(simulation.state().q[2] == Approx(in_floor ? 0.05 : 0.1).epsilon(1e-9));
      CHECK(simulation.model().gap(simulation.state(), 0) == Approx(in_floor ? 0 : 0.08).margin(1e-9));
      CHECK(simulation.state().v.norm() < 1e-12);
      CHECK(simulation.step_counters().contact_residual < 1e-11);  // no velocity points into the floor
    }
}

}  // namespace contact_balance_test
