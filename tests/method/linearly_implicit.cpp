// The linearly implicit method: its order, its stability in steps far above the explicit limit (the largest
// stable step of RK4), and the number of its factorisations.
// N20 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <new>

#include <pliant/body/joints/all_joints.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/solve/suitesparse.h>

#include "deepest.h"
#include "motion.h"
#include "spring_net.h"
#include "widest_gap.h"

namespace linearly_implicit_test {

using namespace pliant;
using Basis = LocalSettings::Basis;
using test::deepest;
using test::widest_gap;

using test::observed_order;
using test::sample_displacement;
using test::sample_velocity;

namespace {

constexpr const char* kMethod = "linearly_implicit";

struct Law {
  std::string name;
  std::vector<double> numbers;
};

/// Settings of a soft part.
struct Soft {
  std::vector<Law> laws;
  bool shell = false;
  bool parameters = false;         ///< whether its semi-axes are dynamic
  double alpha = 0, beta = 0;      ///< damping coefficients of the nodes and of the dynamic axes
  double displacement_factor = 0;  ///< factors of the sample displacement and velocity at time 0
  double velocity_factor = 0.5;
  int resolution = 2;
  Basis basis = Basis::nodes;
};

Soft solid(const std::string& law, double E) {
  Soft soft;
  soft.laws = {{law, {E, 0.3}}};
  return soft;
}
Soft shell(const std::string& membrane, const std::string& bending, double E) {
  Soft soft;
  soft.laws = {{membrane, {E, 0.3, 0.05}}, {bending, {E, 0.3, 0.05}}};
  soft.shell = true;
  return soft;
}

/// Adds a soft ellipsoid with these settings.
Part& add(MultiBody& body, const std::string& name, const Soft& soft) {
  auto& part = body.add<Primitive<Ellipsoid>>(name, soft.shell ? 2.0 : 10.0);
  if (soft.shell) part.make_shell();
  part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}});
  if (soft.parameters)
    part.stiffness({{"a1", 500}, {"a2", 500}, {"a3", 400}})
        .initial_rate({{"a1", 0.2}})
        .damping(soft.alpha, soft.beta, 0);
  LocalSettings settings;
  settings.resolution = soft.resolution;
  settings.basis = soft.basis;
  settings.degree = 3;
  settings.modes = 12;
  settings.alpha = soft.alpha;
  settings.beta = soft.beta;
  const double displacement_factor = soft.displacement_factor, velocity_factor = soft.velocity_factor;
  settings.displacement = [=](const Vec3<double>& X) -> Vec3<double> {
    return displacement_factor * sample_displacement(X);
  };
  settings.velocity = [=](const Vec3<double>& X) -> Vec3<double> {
    return velocity_factor * sample_velocity(X);
  };
  for (const Law& law : soft.laws) settings.energies.push_back(local_law(law.name, law.numbers));
  part.deform_locally(settings);
  return part;
}

using Build = std::function<void(MultiBody&)>;

/// Returns a function that adds one spinning part in free flight.
Build flying(const Soft& soft) {
  return [=](MultiBody& body) {
    body.gravity.setZero();
    add(body, "soft", soft).place({1, 2, 3}).velocity({0.3, -0.2, 0.1}, {0.5, -0.4, 0.6});
  };
}
/// Returns a function that adds two parts; the lower one hangs from the upper one.
Build hanging(const Soft& soft) {
  return [=](MultiBody& body) {
    Part& upper = add(body, "upper", soft).place({0, 0, -0.6});
    Part& lower = add(body, "lower", soft).place({0.5, 0, -1.2});
    body.ball("top", world(0, 0, 0), point(upper, kPi / 2, 0));
    body.ball("between", point(upper, 0, 0), point(lower, kPi / 2, 0));
  };
}

/// Returns a function that adds one part on two damped springs.
Build between_springs(const Soft& soft) {
  return [=](MultiBody& body) {
    Part& part = add(body, "soft", soft).velocity({0.3, -0.2, 0.1}, {0.5, -0.4, 0.6});
    body.spring("above", world(0, 0.2, 1.5), point(part, 0.8, 0.3), 100, 0.5, 0.2);
    body.spring("beside", world(-1.5, 0, 0), point(part, 0, kPi), 60, 0.2);
  };
}

struct Errors {
  std::vector<double> q, v;
};
/// Returns the errors of q and v at `time` (s) for each number of steps, against fine steps of RK4.
Errors errors(const Build& build, double time, const std::vector<int>& steps) {
  MultiBody exact;
  build(exact);
  Simulation reference(exact, "rk4");
  test::run(reference, time,
            std::max(4 * steps.back(), static_cast<int>(3 * time / largest_stable_step(reference))));
  Errors errors;
  for (const int n : steps) {
    MultiBody body;
    build(body);
    Simulation simulation(body, kMethod);
    test::run(simulation, time, n);
    errors.q.push_back((simulation.state().q - reference.state().q).norm());
    errors.v.push_back((simulation.state().v - reference.state().v).norm());
  }
  return errors;
}
/// Checks that positions and velocities at `time` (s) converge with order 2. steps: numbers of steps.
void check_order(const Build& build, double time, const std::vector<int>& steps) {
  const Errors error = errors(build, time, steps);
  CAPTURE(error.q, error.v);
  CHECK(observed_order(error.q) >= 1.9);
  CHECK(observed_order(error.v) >= 1.9);
}

/// Returns the largest stable step of RK4, s.
double explicit_limit(const Build& build) {
  MultiBody body;
  build(body);
  return largest_stable_step(Simulation(body, "rk4"));
}

}  // namespace

TEST_CASE("a soft part in free flight: order 2 in positions and velocities", "[implicit][motion][long]") {
  Soft linear = solid("elastic", 300), sheet = shell("membrane", "bending", 300);
  SECTION("a linear solid") {
    check_order(flying(linear), 0.4, {100, 200, 400});
  }
  SECTION("with global parameters") {
    linear.parameters = true;
    check_order(flying(linear), 0.4, {100, 200, 400});
  }
  SECTION("a shell that bends, with global parameters, damped") {
    sheet.parameters = true;
    sheet.alpha = 0.5;
    sheet.beta = 2e-3;
    check_order(flying(sheet), 0.4, {100, 200, 400});
  }
  SECTION("St. Venant-Kirchhoff, with global parameters that the strain energy resists") {
    Soft soft = solid("st_venant_kirchhoff", 300);
    soft.parameters = true;
    soft.alpha = 0.5;
    check_order(flying(soft), 0.4, {50, 100, 200});
  }
  SECTION("a shell that contains gas") {
    Soft soft = shell("neo_hookean_membrane", "folding", 300);
    soft.laws.push_back({"gas", {10, 1.4, 8}});
    check_order(flying(soft), 0.4, {50, 100, 200});
  }
  SECTION("an energy that provides no stiffness: order 2 for any approximate Jacobian A") {
    check_order(
        [](MultiBody& body) {
          body.gravity.setZero();
          auto& part = body.add<Primitive<Sphere>>("ball", 1);
          part.make_shell().rest({{"r", 0.5}}).velocity({0, 0, 0}, {0.5, 0.3, 1});
          LocalSettings settings = test::net(2, 5);
          settings.velocity = sample_velocity;
          part.deform_locally(settings);
        },
        0.4, {100, 200, 400});
  }
}

TEST_CASE("soft parts that hang from each other: order 2, joints closed to rounding",
          "[implicit][joints][long]") {
  for (const bool parameters : {false, true}) {
    Soft soft = solid("elastic", 1000);
    soft.parameters = parameters;
    soft.alpha = 1;
    soft.beta = 5e-3;
    CAPTURE(parameters);
    check_order(hanging(soft), 0.3, {100, 200, 400});
  }
  check_order(hanging(solid("corotated", 1000)), 0.2, {50, 100, 200});
}

TEST_CASE("a part with modes, free, on joints and on springs: order 2 in positions and velocities",
          "[implicit][modal][joints][long]") {
  for (const bool parameters : {false, true}) {
    Soft soft = solid("elastic", 1000);
    soft.parameters = parameters;
    soft.alpha = 0.5;
    soft.beta = 1e-3;
    for (const Basis basis : {Basis::polynomial, Basis::modes}) {
      CAPTURE(parameters, basis == Basis::polynomial);
      soft.basis = basis;
      check_order(flying(soft), 0.4, {100, 200, 400});
      check_order(hanging(soft), 0.3, {100, 200, 400});
      check_order(between_springs(soft), 0.3, {100, 200, 400});
    }
  }
  Soft sheet = shell("membrane", "bending", 300);
  sheet.basis = Basis::modes;
  sheet.parameters = true;
  check_order(flying(sheet), 0.4, {100, 200, 400});
  check_order(hanging(sheet), 0.3, {100, 200, 400});
}

TEST_CASE("a stiff solid with light damping: order 2 in steps of half to twice the explicit limit",
          "[implicit][motion][joints][long]") {
  for (const bool parameters : {false, true})
    for (const double velocity_factor : {0.0, 0.5}) {
      CAPTURE(parameters, velocity_factor);
      Soft soft = solid("elastic", 1e7);
      soft.parameters = parameters;
      soft.resolution = 3;
      soft.velocity_factor = velocity_factor;
      soft.beta = 3e-5;  // near critical damping of the fastest motion, which these steps do not resolve
      for (const Build& build : {flying(soft), hanging(soft)})
        check_order(build, 32 * explicit_limit(build), {16, 32, 64});
    }
}

TEST_CASE("momentum of a free soft part is conserved to rounding, angular momentum at order 2",
          "[implicit][motion][long]") {
  for (const bool parameters : {false, true}) {
    std::vector<double> angular;
    for (const int steps : {100, 200, 400}) {
      Soft soft = solid("elastic", 300);
      soft.parameters = parameters;
      MultiBody body;
      flying(soft)(body);
      Simulation simulation(body, kMethod);
      const Ledger start = simulation.ledger();
      test::run(simulation, 0.4, steps);
      const Ledger end = simulation.ledger();
      CHECK((end.momentum - start.momentum).norm() <= 1e-13 * start.momentum.norm() * steps);
      angular.push_back((end.angular_momentum - start.angular_momentum).norm());
    }
    CAPTURE(parameters, angular);
    CHECK(observed_order(angular) >= 1.9);
  }
}

TEST_CASE("the centre of mass of a stiff part moves on a straight line at 100 times the explicit limit",
          "[implicit][motion]") {
  const Build build = flying(solid("elastic", 3e5));
  MultiBody body;
  build(body);
  Simulation simulation(body, kMethod);
  const Vec3<double> c = simulation.model().position(simulation.state(), 0);
  const Vec3<double> c_dot = simulation.state().v.head<3>();
  const double h = 100 * explicit_limit(build);
  for (int i = 0; i < 200; ++i) simulation.step(h);
  CHECK((simulation.model().position(simulation.state(), 0) - c - simulation.time() * c_dot).norm() <=
        1e-12 * simulation.time());
}

TEST_CASE("the ledger of a soft part with damping, drag, a spring and a moving anchor, at order 2",
          "[implicit][joints][long]") {
  std::vector<double> balance;
  for (const int steps : {200, 400, 800}) {
    MultiBody body;
    Soft soft = shell("membrane", "bending", 1000);
    soft.parameters = true;
    soft.alpha = 0.4;
    soft.beta = 2e-3;
    Part& part = add(body, "ball", soft).place({0, 0, -0.6}).damping(0.3, 1e-3, 0.2);
    const TimeVector hand(test::wave(0, 0.1, 3), test::wave(0, 0.05, 4), TimeFunction(0.0));
    body.ball("hand", world(hand), point(part, kPi / 2, 0));
    body.spring("spring", world(1, 0, -1), point(part, 0.3, 0.4), 30, 0.5);
    Simulation simulation(body, kMethod);
    test::run(simulation, 0.5, steps);
    const Ledger end = simulation.ledger();
    balance.push_back(std::abs(end.balance));
    for (const Work work : {Work::damping, Work::drag, Work::spring_damping})
      CHECK(end.work[static_cast<int>(work)] < 0);
    CHECK(std::abs(end.work[static_cast<int>(Work::anchors)]) > 0.01);
  }
  CAPTURE(balance);
  CHECK(observed_order(balance) >= 1.9);
}

TEST_CASE("steps of 100 times the explicit limit are stable for a thousand steps",
          "[implicit][stable][long]") {
  std::vector<std::pair<std::string, Build>> all;
  auto each = [&](const std::string& name, Soft soft) {
    soft.displacement_factor = 0.05;
    soft.velocity_factor = 0.1;
    all.emplace_back(name, flying(soft));
    soft.parameters = true;
    all.emplace_back(name + ", global parameters", flying(soft));
  };
  each("linear", solid("elastic", 3e5));
  each("St. Venant-Kirchhoff", solid("st_venant_kirchhoff", 3e5));
  each("corotated", solid("corotated", 3e5));
  each("neo-Hookean", solid("neo_hookean", 3e5));
  each("membrane and bending", shell("membrane", "bending", 3e5));
  Soft damped = solid("elastic", 3e5);
  damped.alpha = 0.5;
  damped.beta = 1e-3;
  each("damped", damped);
  for (const auto& [name, build] : all) {
    MultiBody body;
    build(body);
    Simulation simulation(body, kMethod);
    const double h = 100 * explicit_limit(build);
    CAPTURE(name, h);
    REQUIRE(h <= largest_stable_step(simulation));
    const Ledger start = simulation.ledger();
    for (int i = 0; i < 1000; ++i) {
      simulation.step(h);
      if (i % 50 == 0) REQUIRE(simulation.ledger().energy() <= 1.05 * start.energy());
    }
    const Ledger end = simulation.ledger();
    // The motions that are too fast for the step have decayed, and the spin has not.
    CHECK(end.local <= 1e-3 * start.energy());
    CHECK(end.kinetic >= 0.5 * start.kinetic);
  }
}

TEST_CASE(
    "damping by beta of a stretched rubber block only removes energy, in steps far above the explicit limit",
    "[implicit][stable][long]") {
  // The block hangs at its top, and its weight stretches it by a tenth. In this state the matrix V of the
  // viscous forces (method/implicit/README.md) is not K, and forces on displaced nodes also turn the frame of
  // the part.
  for (const double beta : {0.003, 0.01, 0.1}) {
    MultiBody body;
    auto& bar = body.add<Primitive<Box>>("bar", 1000.0);
    bar.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.3}}).place({0, 0, -0.3});
    LocalSettings settings;
    settings.resolution = 2;
    settings.beta = beta;
    settings.energies = {local_law("neo_hookean", {4e4, 0.49})};
    bar.deform_locally(settings);
    body.weld("top", point(bar, bar.label(Vec3<double>(0, 0, 0.3), bar.parameters().rest()), 0.15),
              world(0, 0, 0));
    Simulation simulation(body, kMethod);
    const double start = simulation.ledger().energy();
    double highest = start, kinetic = 0, balance = 0;
    CAPTURE(beta);
    for (int i = 0; i < 200; ++i) {
      REQUIRE_NOTHROW(simulation.step(0.005));
      const Ledger ledger = simulation.ledger();
      highest = std::max(highest, ledger.energy());
      kinetic = std::max(kinetic, ledger.kinetic);
      balance = std::max(balance, std::abs(ledger.balance));
    }
    CHECK(highest <= start + 1e-3 * kinetic);
    CHECK(balance <= 0.05 * kinetic);
  }
}

TEST_CASE(
    "100 times the explicit limit, membrane laws that are valid for all rotations, also under pressure: no "
    "energy gain",
    "[implicit][stable][long]") {
  for (const std::string membrane : {"st_venant_kirchhoff_membrane", "neo_hookean_membrane"})
    for (const Law& filled : {Law{"nothing", {}}, Law{"pressure", {200}}, Law{"gas", {8200, 1.4, 8000}}})
      for (const bool parameters : {false, true}) {
        CAPTURE(membrane, filled.name, parameters);
        Soft soft = shell(membrane, "folding", 3e5);
        if (!filled.numbers.empty()) soft.laws.push_back(filled);
        soft.displacement_factor = 0.05;
        soft.velocity_factor = 0.1;
        soft.parameters = parameters;
        MultiBody body;
        use_suitesparse(body.joint_solver);
        flying(soft)(body);
        Simulation simulation(body, kMethod);
        const double h = 100 * explicit_limit(flying(soft));
        REQUIRE(h <= largest_stable_step(simulation));
        const Ledger start = simulation.ledger();
        double before = start.energy();
        for (int i = 0; i < 200; ++i) {
          simulation.step(h);
          const double now = simulation.ledger().energy();
          REQUIRE(now <= before + 1e-4 * start.kinetic);  // the rotation is integrated at order 2
          before = now;
        }
        CHECK(before < start.energy());
        CHECK(simulation.ledger().kinetic >= 0.9 * start.kinetic);
      }
}

TEST_CASE("70 times the explicit limit on joints: stable, and joints closed to rounding",
          "[implicit][joints][stable][long]") {
  for (const std::string law : {"elastic", "corotated"})
    for (const bool parameters : {false, true}) {
      Soft soft = solid(law, 3e6);
      soft.parameters = parameters;
      soft.velocity_factor = 0.05;
      MultiBody body;
      hanging(soft)(body);
      Simulation simulation(body, kMethod);
      const double h = 70 * explicit_limit(hanging(soft));
      CAPTURE(law, parameters, h);
      const double start = simulation.ledger().energy();
      const int steps = law == "elastic" ? 1000 : 200;  // each step of "corotated" needs a factorisation
      for (int i = 0; i < steps; ++i) {
        simulation.step(h);
        REQUIRE(widest_gap(simulation) <= 1e-11);
      }
      CHECK(simulation.ledger().energy() <= start + 1e-2 * std::abs(start));
    }
}

TEST_CASE("a stiff part on joints approaches the rigid motion as its stiffness grows", "[implicit][joints]") {
  // All runs use the same step length, far above the explicit limit of the stiff parts.
  auto tip = [](const Build& build) {
    MultiBody body;
    build(body);
    Simulation simulation(body, kMethod);
    test::run(simulation, 0.5, 100);
    return simulation.model().position(simulation.state(), 1);
  };
  const Vec3<double> rigid = tip([](MultiBody& body) {
    std::vector<Part*> parts;
    for (const char* name : {"upper", "lower"}) {
      auto& part = body.add<Primitive<Ellipsoid>>(name, 10.0);
      part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}})
          .place({parts.empty() ? 0 : 0.5, 0, parts.empty() ? -0.6 : -1.2});
      parts.push_back(&part);
    }
    body.ball("top", world(0, 0, 0), point(*parts[0], kPi / 2, 0));
    body.ball("between", point(*parts[0], 0, 0), point(*parts[1], kPi / 2, 0));
  });
  std::vector<double> distance;
  for (const double E : {1e5, 1e6, 1e7}) {
    Soft soft = solid("elastic", E);
    soft.velocity_factor = 0;
    distance.push_back((tip(hanging(soft)) - rigid).norm());
  }
  CAPTURE(distance);
  CHECK(distance[1] <= 0.3 * distance[0]);
  CHECK(distance[2] <= 0.3 * distance[1]);
}

TEST_CASE(
    "the stiffness is factored once, again after a change of the step, and in each step if the stiffness "
    "changes",
    "[implicit][long]") {
  MultiBody body;
  flying(solid("elastic", 1000))(body);
  Simulation simulation(body, kMethod);
  for (int i = 0; i < 50; ++i) simulation.step(1e-3);
  CHECK(simulation.step_counters().factorisations == 1);
  CHECK(simulation.step_counters().evaluations == 100);
  simulation.step(5e-4);
  for (int i = 0; i < 10; ++i) simulation.step(1e-3);
  CHECK(simulation.step_counters().factorisations == 3);

  // The coupling to parameters, springs and other parts uses additional small matrices, which do not count as
  // factorisations.
  for (const bool parameters : {false, true}) {
    Soft soft = solid("elastic", 1000);
    soft.parameters = parameters;
    soft.alpha = 0.5;
    for (const auto& [build, parts] :
         {std::pair(flying(soft), 1), {between_springs(soft), 1}, {hanging(soft), 2}}) {
      CAPTURE(parameters, parts);
      MultiBody coupled;
      build(coupled);
      Simulation once(coupled, kMethod);
      for (int i = 0; i < 500; ++i) once.step(1e-3);
      CHECK(once.step_counters().factorisations == parts);
      CHECK(once.step_counters().evaluations == 1000);
    }
  }

  MultiBody changing;
  flying(solid("neo_hookean", 1000))(changing);
  Simulation changing_run(changing, kMethod);
  for (int i = 0; i < 10; ++i) changing_run.step(1e-3);
  CHECK(changing_run.step_counters().factorisations == 10);
}

TEST_CASE("without local deformation no matrix is factored, and an oscillating parameter keeps its energy",
          "[implicit]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Ellipsoid>>("body", 1000);
  part.mass(5).stiffness({{"a3", 500}}).initial_rate({{"a3", 1e-3}});
  // x'' + omega^2 x = 0 with omega^2 = 5 k / m.
  const double h = 0.3 / std::sqrt(500.0);
  Simulation simulation(body, kMethod);
  const double start = simulation.ledger().energy();
  double lowest = start, highest = start;
  for (int i = 0; i < 20000; ++i) {
    simulation.step(h);
    lowest = std::min(lowest, simulation.ledger().energy());
    highest = std::max(highest, simulation.ledger().energy());
  }
  CHECK(simulation.step_counters().factorisations == 0);
  CHECK(lowest >= 0.9 * start);
  CHECK(highest <= 1.1 * start);
}

TEST_CASE("the state is complete: another simulation, resumed from it, gives identical bits", "[implicit]") {
  for (const char* law : {"elastic", "neo_hookean"}) {
    Soft soft = solid(law, 1000);
    soft.parameters = true;
    MultiBody body;
    hanging(soft)(body);
    Simulation unbroken(body, kMethod);
    for (int i = 0; i < 20; ++i) unbroken.step(2e-3);
    const State middle = unbroken.state();
    for (int i = 0; i < 20; ++i) unbroken.step(2e-3);

    MultiBody other;
    hanging(soft)(other);
    Simulation resumed(other, kMethod, 2);
    for (int i = 0; i < 3; ++i) resumed.step(1e-3);  // leaves factors of another step and state in `resumed`
    resumed.set_state(middle);
    for (int i = 0; i < 20; ++i) resumed.step(2e-3);
    CHECK(hash(resumed.state()) == hash(unbroken.state()));
  }
}

TEST_CASE(
    "Eigen's and CHOLMOD's factors give equal motion, with the block solver and with the augmented matrix",
    "[implicit][joints]") {
  std::vector<VecX<double>> ends;
  for (const bool cholmod : {false, true})
    for (const auto solver : {JointSolver::Choice::blocks, JointSolver::Choice::augmented}) {
      MultiBody body;
      if (cholmod) use_suitesparse(body.joint_solver);
      body.joint_solver.choice = solver;
      Soft soft = solid("elastic", 1e5);
      soft.parameters = true;
      hanging(soft)(body);
      Simulation simulation(body, kMethod);
      test::run(simulation, 0.1, 20);
      ends.push_back(simulation.state().q);
    }
  for (const VecX<double>& end : ends) CHECK((end - ends[0]).norm() <= 1e-9 * ends[0].norm());
}

TEST_CASE("a limit stops a parameter of a stiff part, alone and on a joint", "[implicit][limits][long]") {
  for (const bool joined : {false, true}) {
    MultiBody body;
    if (!joined) body.gravity.setZero();
    Soft soft = solid("elastic", 1e5);
    soft.parameters = true;
    Part& part = add(body, "ball", soft);
    // The rest value moves beyond the limit, so that the elasticity presses the parameter against it.
    part.rest("a1", test::wave(0.5, 0.1, 5)).limits("a1", {0.45, 0.52}).place({0, 0, -0.6});
    if (joined) body.ball("top", world(0, 0, 0), point(part, kPi / 2, 0));
    Simulation simulation(body, kMethod);
    const Ledger start = simulation.ledger();
    int steps_at_limit = 0;
    for (int i = 0; i < 600; ++i) {
      simulation.step(2e-3);
      const double a1 = simulation.state().q[7];
      REQUIRE(a1 >= 0.45);
      REQUIRE(a1 <= 0.52);
      steps_at_limit += simulation.state().v[6] == 0 && (a1 == 0.45 || a1 == 0.52) ? 1 : 0;
      if (joined) REQUIRE(widest_gap(simulation) <= 1e-11);
    }
    CAPTURE(joined, steps_at_limit);
    CHECK(steps_at_limit >= 100);
    const Ledger end = simulation.ledger();
    if (!joined) CHECK((end.momentum - start.momentum).norm() <= 1e-9);
  }
}

TEST_CASE("a stiff part on a string that becomes taut", "[implicit][joints][long]") {
  for (const double E : {1e5, 1e6, 1e7, 1e8, 1e9}) {  // 1.3, 4, 13, 40 and 130 times the explicit limit
    CAPTURE(E);
    MultiBody body;
    Soft soft = solid("elastic", E);
    soft.velocity_factor = 0;
    Part& part = add(body, "ball", soft).place({0.4, 0, -0.4});
    body.join("cord", String{0.6}, {world(0, 0, 0), point(part, kPi / 2, 0)});
    Simulation simulation(body, kMethod);
    const double start = simulation.ledger().energy();
    int taut = 0;
    for (int i = 0; i < 2000; ++i) {
      simulation.step(1e-3);
      REQUIRE(widest_gap(simulation) <= 1e-9);
      taut += simulation.state().joints[0] == JointMode::closed ? 1 : 0;
    }
    CHECK(taut >= 100);
    CHECK(simulation.ledger().energy() <= start);
  }
}

namespace {

/// Drops a ball of elements or polynomials, with Young's modulus E (Pa), on a plane, and checks that it comes
/// to rest. Without damping by beta the ball would bounce almost elastically.
void drop(Basis basis, double E) {
  CAPTURE(basis == Basis::nodes, E);
  const double h = 1e-3, radius = 0.1;
  MultiBody body;
  auto& part = body.add<Primitive<Sphere>>("ball", 1000.0);
  part.rest({{"r", radius}}).place({0, 0, 0.15});
  LocalSettings settings;
  settings.basis = basis;
  settings.degree = 3;
  settings.resolution = 3;
  settings.alpha = 5;
  settings.beta = 2 * radius * std::sqrt(1000 / E);  // near the time of a contact
  settings.energies = {local_law("elastic", {E, 0.3})};
  part.deform_locally(settings);
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  Simulation simulation(body, kMethod);
  const double weight = 9.81 * part.total_mass();
  double highest = simulation.ledger().energy(), impulse = 0, deep = 0;
  for (int i = 0; i < 2000; ++i) {
    simulation.step(h);
    deep = std::max(deep, deepest(simulation));
    const double energy = simulation.ledger().energy();
    REQUIRE(energy <= highest + 1e-6 * weight * radius);
    if (i % 10 == 0) highest = energy;
    if (i >= 1500)
      for (const Vec3<double>& p : simulation.contact()->impulses()) impulse += p[2];
  }
  CHECK(impulse / (500 * h) == Approx(weight).epsilon(1e-2));
  CHECK(simulation.ledger().kinetic < 1e-4 * weight * radius);
  CHECK(deep < 0.02 * radius);  // the ball hits at 1 m/s, which is a hundredth of the radius in a step
  // The weight flattens the ball a little. The long steps neither lift nor lower its centre much further.
  const double sag = radius - simulation.state().q[2];
  CHECK(sag > -3e-4 * radius);
  CHECK(sag < 30 * weight / (E * radius));
}

}  // namespace

TEST_CASE("a stiff ball dropped on a plane bounces and comes to rest, at 10 times the explicit limit",
          "[implicit][contact][long]") {
  for (const Basis basis : {Basis::nodes, Basis::polynomial})
    drop(basis, 1e7);  // 10 times the explicit limit
}

TEST_CASE("softer and stiffer balls dropped on a plane, at 3 to 100 times the explicit limit",
          "[implicit][contact][long]") {
  for (const Basis basis : {Basis::nodes, Basis::polynomial})
    for (const double E : {1e6, 1e9}) drop(basis, E);
}

TEST_CASE("gas in a thin shell is stable with steps above the period of its breathing",
          "[implicit][stable]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Sphere>>("ball", 0.1);
  part.make_shell().rest({{"r", 0.3}});
  LocalSettings settings;
  settings.resolution = 2;
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return 1e-3 * X; };
  settings.energies = {local_law("membrane", {1e4, 0.3, 1e-3}), local_law("gas", {1e5, 1.4, 1e5})};
  part.deform_locally(settings);
  Simulation simulation(body, kMethod);
  // omega^2 = 3 gamma p / (mass per area * radius)
  const double h = 20 / std::sqrt(3 * 1.4 * 1e5 / (0.1 * 0.3));
  const double start = simulation.ledger().kinetic;
  for (int i = 0; i < 1000; ++i) simulation.step(h);
  CHECK(simulation.ledger().kinetic <= start);
}

TEST_CASE("N20: springs at the nodes of a stiff part limit the step, and the predicted limit is safe",
          "[implicit][stable]") {
  const Build build = [](MultiBody& body) {
    body.gravity.setZero();
    Soft soft = solid("elastic", 1e5);
    soft.velocity_factor = 1e-6;
    Part& part = add(body, "ball", soft);
    body.spring("spring", world(1, 0, 0), point(part, 0, 0), 2000);
    body.spring("other", world(-1, 0, 0), point(part, 0, kPi), 2000);
  };
  MultiBody body;
  build(body);
  Simulation simulation(body, kMethod);
  const double h = largest_stable_step(simulation);
  CHECK(h >= 3 * explicit_limit(build));
  CHECK(h <= 1);
  const double start = simulation.ledger().energy();
  for (int i = 0; i < 1000; ++i) simulation.step(0.98 * h);
  CHECK(simulation.ledger().energy() <= start + 1e-6);
}

namespace {

/// A sparse factor whose factorisation always fails. memory: true: do_factor() reports that the matrix cannot
/// be factored; false: do_factor() throws std::bad_alloc.
class NoFactor final : public SparseFactor {
 public:
  explicit NoFactor(bool memory) : memory_(memory) {}
  Eigen::Index nonzeros() const override { return 0; }

 private:
  void do_analyse(const SparseMatrix&) override {}
  bool do_factor(const SparseMatrix&) override {
    if (!memory_) throw std::bad_alloc();
    return false;
  }
  void do_solve(Eigen::Ref<Eigen::MatrixXd>) override {}
  bool memory_;
};

}  // namespace

TEST_CASE("a stiffness that cannot be factored, or does not fit into memory, is reported with its part",
          "[implicit][failure]") {
  for (const bool memory : {false, true}) {
    MultiBody body;
    body.joint_solver.make_factor = [=] { return std::make_unique<NoFactor>(memory); };
    flying(solid("elastic", 1000))(body);
    Simulation simulation(body, kMethod);
    const State before = simulation.state();
    if (memory) {
      CHECK_THROWS_WITH(simulation.step(1e-3),
                        test::has_text("part 'soft'") && test::has_text("cannot be factored"));
      CHECK_THROWS_AS(simulation.step(1e-3), NumericalFailure);
    } else {
      CHECK_THROWS_WITH(simulation.step(1e-3),
                        test::has_text("part 'soft'") && test::has_text("out of memory"));
      CHECK_THROWS_AS(simulation.step(1e-3), OutOfMemory);
    }
    CHECK(simulation.state().q == before.q);
  }
}

}  // namespace linearly_implicit_test
