// Every law of local deformation: energy balance and momenta in free flight, damping, and the largest stable
// step.
// N20 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <pliant/part/local/local_laws.h>

#include "draws.h"
#include "motion.h"
#include "spring_net.h"

namespace local_laws_test {

using namespace pliant;

namespace {

/// Returns the numbers of a law (moduli, thickness, ...) for a soft part, in the order of the law.
std::vector<double> numbers(const LocalLawInfo& law) {
  static const std::vector<std::pair<std::string, double>> known{
      {"E", 300}, {"nu", 0.3}, {"thickness", 0.1}, {"w0", 10},  {"w1", 5},
      {"p", 3},   {"p0", 10},  {"gamma", 1.4},     {"p_ext", 8}};
  std::vector<double> values;
  for (const LocalLawInfo::Number& n : law.numbers)
    for (const auto& [key, value] : known)
      if (key == n.key) values.push_back(value);
  return values;
}

/// Adds a soft part with the law and with two dynamic global parameters, and returns the part.
Part& tumbling(MultiBody& body, const LocalLawInfo& law, double beta) {
  body.gravity.setZero();
  auto& part = body.add<Primitive<Ellipsoid>>("soft", law.shell ? 1 : 3);
  if (law.shell) part.make_shell();
  part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}})
      .stiffness({{"a1", 100}, {"a3", 100}})
      .initial_rate({{"a1", 0.2}})
      .velocity({0.3, 0, 0.1}, {0.5, -0.4, 0.6});
  LocalSettings settings;
  settings.resolution = 2;
  settings.beta = beta;
  settings.displacement = [](const Vec3<double>& X) -> Vec3<double> {
    return 0.3 * test::sample_displacement(X);
  };
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return 0.5 * test::sample_velocity(X); };
  settings.energies.push_back(local_law(law.name, numbers(law)));
  // Pressure or bending alone does not resist in-plane motion of the nodes, so a membrane is added.
  const std::string name = law.name;
  if (name == "pressure" || name == "gas" || name == "bending" || name == "folding")
    settings.energies.push_back(local_law("st_venant_kirchhoff_membrane", {300, 0.3, 0.1}));
  part.deform_locally(settings);
  return part;
}

}  // namespace

TEST_CASE(
    "under every law of local deformation, damped or not, the energy balance is of order 4 and momenta are "
    "conserved",
    "[local][motion][long]") {
  for (const LocalLawInfo& law : all_local_laws())
    for (const double beta : {0.0, 1e-4}) {
      CAPTURE(law.name, beta);
      std::vector<double> balance, momentum, angular;
      for (const int steps : {80, 160, 320}) {
        MultiBody body;
        tumbling(body, law, beta);
        Simulation simulation(body, "rk4");
        const Ledger start = simulation.ledger();
        test::run(simulation, 0.4, steps);
        const Ledger end = simulation.ledger();
        balance.push_back(std::abs(end.balance) / start.kinetic);
        momentum.push_back((end.momentum - start.momentum).norm() / start.momentum.norm());
        angular.push_back((end.angular_momentum - start.angular_momentum).norm() /
                          start.angular_momentum.norm());
        const double dissipated = -end.work[static_cast<int>(Work::damping)] / start.kinetic;
        CHECK((beta > 0 ? dissipated > 1e-5 : dissipated == 0));
      }
      CAPTURE(balance, angular, momentum);
      const bool exact = balance.back() <= 1e-10;  // exact to rounding
      CHECK((exact || test::observed_order(balance) >= 3.8));
      CHECK(balance.back() <= 1e-5);
      CHECK(momentum.back() <= 1e-8);
      CHECK(angular.back() <= 1e-7);
    }
}

TEST_CASE("a step that inverts an element of neo_hookean_log ends with a message that names the part",
          "[local]") {
  for (const char* law : {"neo_hookean_log", "corotated"}) {
    MultiBody body;
    Part& part = body.add<Primitive<Ellipsoid>>("heart", 3);
    LocalSettings settings;
    settings.resolution = 2;
    // Both halves move towards each other, faster than waves in the material.
    settings.velocity = [](const Vec3<double>& X) { return Vec3<double>(-300 * X[0], 0, 0); };
    settings.energies.push_back(local_law(law, {300, 0.3}));
    part.deform_locally(settings);
    Simulation simulation(body, "rk4");
    CHECK_THROWS_WITH(
        [&] {
          for (int i = 0; i < 1000; ++i) simulation.step(1e-3);
        }(),
        test::has_text("part 'heart'") && test::has_text(law) && test::has_text("inverted"));
  }
}

TEST_CASE("damping of every law: K x_dot about rest, zero for rigid motion, never adds energy", "[local]") {
  test::Draws draws(6);
  for (const LocalLawInfo& law : all_local_laws()) {
    CAPTURE(law.name);
    MultiBody body;
    Part& part = tumbling(body, law, 0);
    const Model model(body);
    const LocalMesh& mesh = part.local()->mesh();
    const auto energy = local_law(law.name, numbers(law)).make_energy(mesh);
    const bool of_position = energy->of() == NodalEnergy::Of::position;
    const Eigen::Index n = mesh.X.rows(), own = energy->own_inertia().size();
    NodalEnergy::Buffer buffer;
    auto random = [&](double size) {
      VecX<double> x(3 * n + own);
      for (double& value : x) value = draws.uniform(-size, size);
      return x;
    };
    VecX<double> rest = VecX<double>::Zero(3 * n + own);
    if (of_position) nodes(rest, n) = mesh.X;
    auto viscous = [&](const VecX<double>& x, const VecX<double>& x_dot) {
      VecX<double> f = VecX<double>::Zero(x.size());
      energy->add_viscous_force(x, x_dot, f, buffer, nullptr);
      return f;
    };
    const VecX<double> x_dot = random(1);
    VecX<double> K_x_dot = VecX<double>::Zero(x_dot.size());
    energy->add_derivative(rest, x_dot, K_x_dot, buffer, nullptr);
    const std::string name = law.name;
    if (name == "pressure" || name == "gas") {
      CHECK(viscous(rest, x_dot).isZero(0));
      continue;
    }
    CHECK((viscous(rest, x_dot) - K_x_dot).norm() <= 1e-12 * K_x_dot.norm());
    for (int trial = 0; trial < 5; ++trial) {
      const VecX<double> x = rest + random(0.03), rate = random(1), f = viscous(x, rate);
      CHECK(f.dot(rate) < 0);
      if (!of_position) continue;
      // The total force and torque are zero; in rigid motion each force is zero.
      const Nodes at = nodes(x, n), force = nodes(std::as_const(f), n);
      Vec3<double> couple = Vec3<double>::Zero();
      for (Eigen::Index k = 0; k < n; ++k)
        couple += Vec3<double>(at.row(k).transpose()).cross(Vec3<double>(force.row(k).transpose()));
      CHECK(force.colwise().sum().norm() <= 1e-12 * f.norm());
      CHECK(couple.norm() <= 1e-12 * f.norm());
      const Vec3<double> c = draws.vector(1), omega = draws.vector(1);
      VecX<double> rigid = VecX<double>::Zero(x.size());
      for (Eigen::Index k = 0; k < n; ++k)
        nodes(rigid, n).row(k) = (c + omega.cross(Vec3<double>(at.row(k).transpose()))).transpose();
      CHECK(viscous(x, rigid).norm() <= 1e-12 * f.norm());
    }
  }
}

TEST_CASE("small motion decays equally under the nonlinear laws and under the linear law",
          "[local][motion][long]") {
  for (const bool shell : {false, true}) {
    auto remaining_energy = [&](const char* law) {
      MultiBody body;
      body.gravity.setZero();
      auto& ball = body.add<Primitive<Sphere>>("ball", 1);
      if (shell) ball.make_shell();
      LocalSettings settings;
      settings.resolution = 3;
      settings.beta = 0.02;
      settings.displacement = [](const Vec3<double>& X) -> Vec3<double> {
        return 1e-5 * Vec3<double>(X[0], X[1], -2 * X[2]);
      };
      settings.energies.push_back(
          local_law(law, shell ? std::vector<double>{30, 0.3, 0.1} : std::vector<double>{10, 0.3}));
      ball.deform_locally(settings);
      Simulation simulation(body, "rk4");
      const double start = simulation.ledger().energy();
      test::run(simulation, 3, 600);
      return simulation.ledger().energy() / start;
    };
    const double linear = remaining_energy(shell ? "membrane" : "elastic");
    CHECK(linear < 0.8);
    for (const char* law : {"st_venant_kirchhoff", "neo_hookean", "corotated"}) {
      CAPTURE(law);
      if (shell && law == std::string("corotated")) continue;
      CHECK(remaining_energy((std::string(law) + (shell ? "_membrane" : "")).c_str()) ==
            Approx(linear).epsilon(1e-4));
    }
  }
}

TEST_CASE("laws of shells are refused for solids, and laws of solids for shells", "[local]") {
  for (const bool shell : {false, true}) {
    MultiBody body;
    auto& part = body.add<Primitive<Ellipsoid>>("soft");
    if (shell) part.make_shell();
    LocalSettings settings;
    settings.resolution = 2;
    settings.energies.push_back(shell ? local_law("elastic", {1e5, 0.3})
                                      : local_law("membrane", {1e5, 0.3, 0.1}));
    part.deform_locally(settings);
    CHECK_THROWS_WITH(Simulation(body, "rk4"), test::has_text(shell ? "not for shells" : "not for solids"));
  }
  CHECK_THROWS_WITH(local_law("jelly", {}), test::has_text("there are: membrane"));
}

TEST_CASE("N20: the largest stable step includes the beta damping of every law", "[local][stable][long]") {
  for (const LocalLawInfo& law : all_local_laws())
    for (const char* method : {"rk4", "semi_implicit_euler"}) {
      MultiBody body;
      tumbling(body, law, 0.05);
      Simulation simulation(body, method);
      // The predicted limit is that of small motions about the initial state. The motion changes the shape,
      // so the step is shorter.
      const double h = 0.9 * largest_stable_step(simulation), start = simulation.ledger().energy();
      CAPTURE(law.name, method, h);
      CHECK_NOTHROW([&] {
        for (int i = 0; i < 100; ++i) simulation.step(h);
      }());
      CHECK(simulation.ledger().energy() < start);
    }
}

}  // namespace local_laws_test
