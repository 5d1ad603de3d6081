// Joints, springs and limits of parts whose nodes deform locally.
#include "catch.h"

#include "motion.h"
#include "spring_net.h"

using namespace pliant;

namespace {

Part& balloon(MultiBody& body, const std::string& name, const Vec3<double>& at, bool soft) {
  auto& part = body.add<Primitive<Ellipsoid>>(name, 2.0);
  part.make_shell().rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}}).place(at);
  if (soft) part.stiffness({{"a1", 500}, {"a2", 500}, {"a3", 400}});
  LocalSettings settings = test::net(3, 60);
  settings.velocity = test::rush;
  part.deform_locally(settings);
  return part;
}

double widest(const Simulation& simulation) {
  double gap = 0;
  for (std::size_t j = 0; j < simulation.model().joints().size(); ++j)
    gap = std::max(gap, simulation.model().gap(simulation.state(), static_cast<int>(j)));
  return gap;
}

}  // namespace

TEST_CASE("soft shells hung from each other: joints hold, and the order is kept", "[local][joints]") {
  for (const bool soft : {false, true}) {
    std::vector<double> energy;
    for (const int steps : {100, 200, 400}) {
      MultiBody body;
      Part& upper = balloon(body, "upper", {0, 0, -0.6}, soft);
      Part& lower = balloon(body, "lower", {0.5, 0, -1.2}, soft);
      body.ball("top", world(0, 0, 0), point(upper, kPi / 2, 0));
      body.ball("between", point(upper, 0, 0), point(lower, kPi / 2, 0));
      Simulation simulation(body, "rk4");
      const double start = simulation.ledger().energy();
      for (int i = 0; i < steps; ++i) {
        simulation.step(1.0 / steps);
        REQUIRE(widest(simulation) <= 1e-11);
      }
      energy.push_back(std::abs(simulation.ledger().energy() - start));
    }
    CAPTURE(soft, energy[0], energy[1], energy[2]);
    CHECK(test::observed_order(energy) >= 3.8);
    CHECK(energy.back() <= 1e-4);
  }
}
