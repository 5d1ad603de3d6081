// Every law of local deformation in free flight: order 4, and what is conserved.
#include "catch.h"

#include <pliant/part/local_laws.h>

#include "motion.h"
#include "spring_net.h"

using namespace pliant;

namespace {

/// Numbers that make a soft part of any law.
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

}  // namespace

TEST_CASE("every law of local deformation keeps energy, momentum and angular momentum at order 4",
          "[local][motion]") {
  for (const LocalLawInfo& law : all_local_laws()) {
    CAPTURE(law.name);
    std::vector<double> energy, momentum, turning;
    for (const int steps : {80, 160, 320}) {
      MultiBody body;
      body.gravity.setZero();
      auto& part = body.add<Primitive<Ellipsoid>>("soft", law.shell ? 1 : 3);
      if (law.shell) part.make_shell();
      part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}})
          .stiffness({{"a1", 100}, {"a3", 100}})
          .initial_rate({{"a1", 0.2}})
          .move({0.3, 0, 0.1}, {0.5, -0.4, 0.6});
      LocalSettings settings;
      settings.resolution = 2;
      settings.displacement = [](const Vec3<double>& X) -> Vec3<double> { return 0.3 * test::bump(X); };
      settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return 0.5 * test::rush(X); };
      settings.energies.push_back(local_law(law.name, numbers(law)));
      // What only presses lets the nodes go where they like: something holds them.
      const std::string name = law.name;
      if (name == "pressure" || name == "gas" || name == "bending" || name == "folding")
        settings.energies.push_back(local_law("st_venant_kirchhoff_membrane", {300, 0.3, 0.1}));
      part.deform_locally(settings);
      Simulation simulation(body, "rk4");
      const Ledger start = simulation.ledger();
      test::run(simulation, 0.4, steps);
      const Ledger end = simulation.ledger();
      energy.push_back(std::abs(end.energy() - start.energy()) / start.kinetic);
      momentum.push_back((end.momentum - start.momentum).norm() / start.momentum.norm());
      turning.push_back((end.angular_momentum - start.angular_momentum).norm() /
                        start.angular_momentum.norm());
    }
    CAPTURE(energy[0], energy[1], energy[2], turning[2], momentum[2]);
    CHECK(test::observed_order(energy) >= 3.8);
    CHECK(energy.back() <= 1e-5);
    CHECK(momentum.back() <= 1e-8);
    CHECK(turning.back() <= 1e-7);
  }
}

TEST_CASE("laws of shells are refused by solids, and the other way round", "[local]") {
  for (const bool shell : {false, true}) {
    MultiBody body;
    auto& part = body.add<Primitive<Ellipsoid>>("soft");
    if (shell) part.make_shell();
    LocalSettings settings;
    settings.resolution = 2;
    settings.energies.push_back(shell ? local_law("elastic", {1e5, 0.3})
                                      : local_law("membrane", {1e5, 0.3, 0.1}));
    part.deform_locally(settings);
    CHECK_THROWS_WITH(Simulation(body, "rk4"), test::has_text("is of"));
  }
  CHECK_THROWS_WITH(local_law("jelly", {}), test::has_text("there are: membrane"));
}
