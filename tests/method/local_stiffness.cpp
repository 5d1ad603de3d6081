// The factor of the local stiffness. A constant factor is equivalent to multiplied constants of the laws. The
// energy balance contains the work of a changing factor.
#include "catch.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <pliant/part/local/local_laws.h>
#include <pliant/simulate/stable_step.h>

#include "motion.h"
#include "spring_net.h"

namespace local_stiffness_test {

using namespace pliant;

namespace {

using Basis = LocalSettings::Basis;

/// Returns the numbers of a law (moduli, thickness, ...) for a soft part, in the order of the law. scale:
/// multiplies the numbers in which the energy is linear.
std::vector<double> numbers(const LocalLawInfo& law, double scale) {
  static const std::vector<std::pair<std::string, double>> moduli{{"E", 300}, {"w0", 10}, {"w1", 5},
                                                                  {"p", 3},   {"p0", 10}, {"p_ext", 8}},
      others{{"nu", 0.3}, {"thickness", 0.1}, {"gamma", 1.4}};
  std::vector<double> values;
  for (const LocalLawInfo::Number& n : law.numbers) {
    for (const auto& [key, value] : moduli)
      if (key == n.key) values.push_back(scale * value);
    for (const auto& [key, value] : others)
      if (key == n.key) values.push_back(value);
  }
  return values;
}

/// Adds a soft part that tumbles and has two dynamic global parameters. The constants of its laws are
/// multiplied by `scale`.
Part& tumbling(MultiBody& body, const LocalLawInfo& law, Basis basis, double scale) {
  body.gravity.setZero();
  auto& part = body.add<Primitive<Ellipsoid>>("soft", law.shell ? 1 : 3);
  if (law.shell) part.make_shell();
  part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}})
      .stiffness({{"a1", 100}, {"a3", 100}})
      .velocity({0.3, 0, 0.1}, {0.5, -0.4, 0.6});
  LocalSettings settings;
  settings.basis = basis;
  settings.resolution = 2;
  settings.degree = 2;
  settings.modes = 6;
  settings.alpha = 0.1;
  settings.beta = 1e-3;
  settings.displacement = [](const Vec3<double>& X) -> Vec3<double> {
    return 0.2 * test::sample_displacement(X);
  };
  settings.energies.push_back(local_law(law.name, numbers(law, scale)));
  const std::string name = law.name;
  if (name == "pressure" || name == "gas" || name == "bending" || name == "folding")
    settings.energies.push_back(local_law("st_venant_kirchhoff_membrane", {scale * 300, 0.3, 0.1}));
  part.deform_locally(settings);
  return part;
}

/// Returns whether a shell with this law alone has modes. Its energy must be quadratic in d and resist
/// in-plane motion.
bool has_shell_modes(const LocalLawInfo& law) {
  return law.quadratic && law.shell && std::string(law.name) != "bending";
}

/// Compares a part whose laws have a factor with a part whose laws have multiplied constants, after 40 steps
/// of length `step` (s). accuracy: largest difference of a coordinate.
void check_factor(const LocalLawInfo& law, Basis basis, const std::string& method, double step,
                  double accuracy) {
  CAPTURE(law.name, method);
  const double factor = 2.5;
  MultiBody with_factor, multiplied, plain;
  tumbling(with_factor, law, basis, 1).scale_local(factor);
  tumbling(multiplied, law, basis, factor);
  tumbling(plain, law, basis, 1);
  Simulation one(with_factor, method), other(multiplied, method), soft(plain, method);
  if (basis == Basis::nodes && method == "rk4")
    CHECK(largest_stable_step(one) == Approx(largest_stable_step(other)).epsilon(1e-9));
  for (Simulation* simulation : {&one, &other, &soft}) test::run(*simulation, 40 * step, 40);
  // Modes are compared by the displacements of nodes, because their signs are arbitrary.
  const auto difference = [](const Simulation& a, const Simulation& b) {
    const PartModel& m = a.model().parts()[0];
    const VecX<double> frames = a.state().q.head(7 + m.n_s) - b.state().q.head(7 + m.n_s);
    const Nodes d = m.local->displacements(a.state().q.data() + 7 + m.n_s) -
                    b.model().parts()[0].local->displacements(b.state().q.data() + 7 + m.n_s);
    return std::max(frames.cwiseAbs().maxCoeff(), d.cwiseAbs().maxCoeff());
  };
  CHECK(difference(one, other) <= accuracy);
  CHECK(difference(one, soft) > 1e4 * accuracy);
  CHECK(one.ledger().local == Approx(other.ledger().local).epsilon(100 * accuracy));
  CHECK(one.ledger().work[static_cast<int>(Work::damping)] ==
        Approx(other.ledger().work[static_cast<int>(Work::damping)]).epsilon(100 * accuracy));
  CHECK(one.ledger().work[static_cast<int>(Work::actuation)] == 0);
}

}  // namespace

TEST_CASE("a factor of the local stiffness acts as laws with multiplied constants, in every law and method",
          "[local][motion][long]") {
  for (const LocalLawInfo& law : all_local_laws())
    for (const char* method :
         {"semi_implicit_euler", "rk4", "implicit_midpoint", "esdirk", "linearly_implicit"})
      check_factor(law, Basis::nodes, method, 2e-3, 1e-9);
}

TEST_CASE("a factor of the stiffness of modes and polynomials acts as laws with multiplied constants",
          "[local][motion][long]") {
  for (const LocalLawInfo& law : all_local_laws()) {
    const bool polynomial = std::string(law.name) == "elastic";
    if (!polynomial && !has_shell_modes(law)) continue;
    const Basis basis = polynomial ? Basis::polynomial : Basis::modes;
    for (const char* method : {"implicit_midpoint", "esdirk", "linearly_implicit"})
      check_factor(law, basis, method, 2e-3, 1e-9);
    // Explicit methods integrate the oscillators exactly only without a factor, so the step is shorter.
    check_factor(law, basis, "dop853", 5e-4, 1e-9);
  }
}

TEST_CASE("the balance contains the work of a factor of the local stiffness that changes",
          "[local][motion][long]") {
  for (const LocalLawInfo& law : all_local_laws())
    for (const Basis basis : {Basis::nodes, Basis::modes}) {
      const std::string name = law.name;
      if (basis == Basis::modes && !has_shell_modes(law)) continue;
      if (basis == Basis::nodes && name != "loaded_membrane" && name != "neo_hookean" && name != "gas")
        continue;
      CAPTURE(law.name);
      std::vector<double> balance;
      double actuation = 0;
      for (const int steps : {80, 160, 320}) {
        MultiBody body;
        tumbling(body, law, basis, 1).scale_local(test::wave(1.5, 0.8, 15));
        Simulation simulation(body, "rk4");
        test::run(simulation, 0.4, steps);
        const Ledger end = simulation.ledger();
        balance.push_back(std::abs(end.balance));
        actuation = end.work[static_cast<int>(Work::actuation)];
      }
      CAPTURE(balance, actuation);
      CHECK((balance.back() <= 1e-7 * std::abs(actuation) || test::observed_order(balance) >= 3.8));
      CHECK(balance.back() <= 1e-4 * std::abs(actuation));
    }
}

TEST_CASE("in contact and on joints, the energy is that of the present factor of the local stiffness",
          "[local][contact][long]") {
  // A jelly falls on a floor, and hangs on a joint, while its stiffness has a factor between 0.7 and 2.3.
  for (const bool hangs : {false, true})
    for (const char* method : {"rk4", "semi_implicit_euler", "linearly_implicit"}) {
      std::vector<double> balance;
      double movable = 0;
      for (const bool changes : {false, true}) {
        MultiBody body;
        Part& jelly = body.add<Primitive<Ellipsoid>>("jelly", 500);
        jelly.rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.15}}).place({0, 0, 0.2});
        LocalSettings settings;
        settings.resolution = 2;
        settings.beta = 2e-3;
        settings.energies.push_back(local_law("neo_hookean", {2e4, 0.3}));
        jelly.deform_locally(settings).scale_local(changes ? test::wave(1.5, 0.8, 15, -kPi / 2) : 1.5);
        if (hangs) {
          body.ball("hook", point(jelly, kPi / 2, 0), world(TimeVector(0, 0, 0.35)));
        } else {
          body.contact.active = true;
          body.contact.planes.emplace_back().name = "floor";
        }
        Simulation simulation(body, method);
        movable = jelly.total_mass() * body.gravity.norm() * 0.1;
        double worst = 0;
        for (int i = 0; i < 400; ++i) {
          simulation.step(1e-3);
          if (i % 20 == 0) worst = std::max(worst, std::abs(simulation.ledger().balance));
        }
        balance.push_back(worst / movable);
      }
      CAPTURE(hangs, method, balance);
      CHECK(balance[0] <= 0.02);
      CHECK(balance[1] <= 0.01 + 3 * balance[0]);
    }
}

TEST_CASE("a factor of the local stiffness that becomes negative ends the run with a message", "[local]") {
  MultiBody body;
  tumbling(body, all_local_laws().front(), Basis::nodes, 1).scale_local(TimeFunction::formula("1 - 10 * t"));
  Simulation simulation(body, "rk4");
  CHECK_THROWS_WITH(test::run(simulation, 0.2, 100),
                    test::has_text("part 'soft'") && test::has_text("expected a number of at least 0"));
}

TEST_CASE("a factor of the local stiffness is not negative", "[local]") {
  MultiBody body;
  Part& part = tumbling(body, all_local_laws().front(), Basis::nodes, 1);
  CHECK_THROWS_WITH(part.scale_local(-1), test::has_text("part 'soft'") && test::has_text("-1"));
  part.scale_local(1);
  CHECK(part.local_factor() == nullptr);
  CHECK_THROWS_WITH(body.add<Primitive<Sphere>>("stone").scale_local(2),
                    test::has_text("does not deform locally"));
}

}  // namespace local_stiffness_test
