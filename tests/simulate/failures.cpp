// Runs that must stop, and parameters that cannot move: the messages name the cause, and no state contains a
// number that is not finite.
// N24 and N72 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <limits>

#include <pliant/part/local/local_laws.h>

#include "motion.h"
#include "spring_net.h"

namespace failures_test {

using namespace pliant;
using test::has_text;

namespace {

const char* const kMethods[] = {"rk4", "semi_implicit_euler"};
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

/// Returns a function of time: `value` before the time `when` (s), then `what`, which is not finite.
TimeFunction broken_at(double when, double value, double what) {
  struct Broken : TimeFunction::Impl {
    double when, value, what;
    Taylor2<double> at(double t) const override { return Taylor2<double>(t < when ? value : what); }
  };
  auto impl = std::make_shared<Broken>();
  impl->when = when;
  impl->value = value;
  impl->what = what;
  return TimeFunction(impl);
}

}  // namespace

TEST_CASE("N24: steps that are not positive and finite are refused", "[failure]") {
  MultiBody body;
  body.add<Primitive<Sphere>>("ball", 1000);
  Simulation simulation(body);
  for (double h : {0.0, -1.0, kNaN, kInfinity, -kInfinity}) {
    CHECK_THROWS_AS(simulation.step(h), std::invalid_argument);
    CHECK(simulation.time() == 0);
  }
  CHECK_NOTHROW(simulation.step(1e-300));
  CHECK(simulation.state().q.allFinite());
  CHECK_THROWS_WITH(make_integrator("euler"), has_text("there are: semi_implicit_euler, rk4"));
}

TEST_CASE("N24: an extremely long step gives a finite state or fails", "[failure]") {
  for (const char* method : kMethods) {
    MultiBody body;
    test::tumbling_solid(body);
    Simulation simulation(body, method);
    try {
      simulation.step(1e300);
      CHECK(simulation.state().q.allFinite());
      CHECK(simulation.state().v.allFinite());
    } catch (const NumericalFailure& failure) {
      CHECK(failure.time == 0);
      CHECK(simulation.state().q.allFinite());
      CHECK(simulation.time() == 0);
    }
  }
}

TEST_CASE("N72: a term that is not finite is named, and the last good state is kept", "[failure]") {
  struct Case {
    const char* what;
    std::function<void(MultiBody&, Part&)> add;
  };
  for (const double bad : {kNaN, kInfinity}) {
    const Case cases[] = {
        {"the force 'own'",
         [bad](MultiBody& body, Part& part) {
           body.force("own", point(part, 0.3, 1), [bad](double t, const Vec3<double>&, const Vec3<double>&) {
             return Vec3<double>(0, t < 0.0195 ? 1.0 : bad, 0);
           });
         }},
        {"the force 'timed'",
         [bad](MultiBody& body, Part& part) {
           body.force("timed", point(part, 0.3, 1), TimeVector(0, broken_at(0.0195, 1, bad), 0));
         }},
        {"the torque 'twist'",
         [bad](MultiBody& body, Part& part) {
           body.torque("twist", part, TimeVector(broken_at(0.0195, 1, bad), 0, 0));
         }},
        {"the anchor of spring 'hand'",
         [bad](MultiBody& body, Part& part) {
           body.spring("hand", point(part, 0.3, 1), world({0, broken_at(0.0195, 1, bad), 0}), 100);
         }},
        {"the anchor of spring 'stick'",
         [bad](MultiBody& body, Part& part) {
           body.spring("stick", point(part, 0.3, 1), world({0, broken_at(0.0195, 1, bad), 0}), 100, 0, 0.5);
         }},
        {"the rest value of body.a1",
         [bad](MultiBody&, Part& part) {
           part.rest("a1", broken_at(0.0195, 1, bad)).stiffness({{"a1", 1000}});
         }},
    };
    for (const Case& c : cases)
      for (const char* method : kMethods) {
        MultiBody body;
        Part& other = test::add(body, "other", "box", {}, 1000);
        other.place({5, 0, 0});
        Part& part = test::add(body, "body", "ellipsoid", {"taper"}, 1000);
        part.stiffness({{"a3", 1e4}, {"taper.tx", 1e3}}).velocity({1, 0, 0}, {1, 2, 3});
        c.add(body, part);
        Simulation simulation(body, method);
        State before;
        std::string message;
        double failed_at = -1;
        for (int i = 0; i < 100 && message.empty(); ++i) {
          before = simulation.state();
          try {
            simulation.step(1e-3);
          } catch (const NumericalFailure& failure) {
            message = failure.what();
            failed_at = failure.time;
          }
        }
        INFO(c.what << " " << method << " " << bad << ": " << message);
        CHECK(message.find(c.what) != std::string::npos);
        CHECK(failed_at == Approx(std::string(method) == "rk4" ? 0.019 : 0.02).epsilon(1e-12));
        CHECK(simulation.state().q == before.q);
        CHECK(simulation.state().v == before.v);
        CHECK(simulation.state().work == before.work);
        CHECK(simulation.time() == before.time());
      }
  }
}

TEST_CASE("N72: a load that is not finite is named at a part whose local deformation has modes",
          "[failure]") {
  for (const auto basis : {LocalSettings::Basis::nodes, LocalSettings::Basis::polynomial}) {
    MultiBody body;
    auto& part = body.add<Primitive<Sphere>>("jelly", 1000.0);
    part.rest({{"r", 0.1}});
    LocalSettings settings;
    settings.basis = basis;
    settings.resolution = 2;
    settings.energies = {local_law("elastic", {1e4, 0.3})};
    part.deform_locally(settings);
    body.force("timed", point(part, 0.3, 1), TimeVector(0, broken_at(0.0195, 1, kNaN), 0));
    Simulation simulation(body, "rk4");
    std::string message;
    for (int i = 0; i < 100 && message.empty(); ++i) {
      try {
        simulation.step(1e-3);
      } catch (const NumericalFailure& failure) {
        message = failure.what();
      }
    }
    CHECK_THAT(message, has_text("the force 'timed'"));
  }
}

TEST_CASE("a step far above the stable step fails, and the message names a stable step", "[failure]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "body", "ellipsoid", {}, 1000);
    part.mass(1).place({0.1, 0, 0});
    body.spring("spring", point(part, 0, 0, 0), world(0, 0, 0), 1e4);
    Simulation simulation(body, method);
    std::string message;
    for (int i = 0; i < 100000 && message.empty(); ++i) try {
        simulation.step(0.1);
      } catch (const NumericalFailure& failure) {
        message = failure.what();
      }
    INFO(message);
    CHECK(message.find("body.") != std::string::npos);
    CHECK(message.find("largest stable step at the start is about 0.0") != std::string::npos);
    CHECK(simulation.state().q.allFinite());
  }
}

TEST_CASE("parameters without inertia are fixed and named", "[failure]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "body", "ellipsoid", {"bend_offset", "bend"}, 1000);
    part.make_dynamic(
        {"a1", "bend_offset.b1", "bend_offset.b2", "bend_offset.b3", "bend.angle", "bend.direction"});
    part.initial_rate({{"a1", 0.1}, {"bend_offset.b2", 0.3}, {"bend.direction", 1}})
        .velocity({0, 0, 0}, {0.2, 0.1, 0});
    Simulation simulation(body, method);
    simulation.step(1e-3);
    INFO(method);
    CHECK(simulation.velocities_without_inertia().count("body.bend_offset.b2") == 1);
    CHECK(simulation.velocities_without_inertia().count("body.bend.direction") == 1);
    CHECK(simulation.velocities_without_inertia().count("body.a1") == 0);
    CHECK(simulation.state().q.allFinite());
    CHECK(simulation.state().v.allFinite());
    CHECK(simulation.ledger().energy() >= 0);
    // The other motion does not change: a1 keeps its rate.
    CHECK(simulation.state().v[6] == Approx(0.1).epsilon(1e-2));
    test::run(simulation, 0.1, 100);
    CHECK(simulation.state().q.allFinite());
  }
}

TEST_CASE("parameters without inertia of a part with local deformation are fixed and named",
          "[failure][local]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "body", "ellipsoid", {"bend_offset"}, 1000);
    part.make_shell().stiffness({{"a1", 1e5}, {"bend_offset.b2", 1}});
    part.initial_rate({{"a1", 0.1}, {"bend_offset.b2", 0.3}}).velocity({0, 0, 0}, {0.2, 0.1, 0});
    LocalSettings settings = test::net(2, 1e5);
    settings.velocity = test::sample_velocity;
    part.deform_locally(settings);
    Simulation simulation(body, method);
    simulation.step(1e-4);
    INFO(method);
    CHECK(simulation.velocities_without_inertia().count("body.bend_offset.b2") == 1);
    CHECK(simulation.velocities_without_inertia().size() == 1);
    CHECK(simulation.state().v.allFinite());
    test::run(simulation, 0.01, 100);
    CHECK(simulation.state().q.allFinite());
  }
}

TEST_CASE("a parameter without inertia stays fixed under a load, and the ledger balances", "[failure]") {
  for (const char* method : kMethods) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "body", "ellipsoid", {"bend"}, 1000);
    part.make_dynamic({"a3"}).rest({{"bend.angle", 0.0}}).stiffness({{"bend.direction", 10}, {"a3", 1000}});
    part.initial({{"bend.direction", 0.5}, {"a3", 1.1}}).velocity({0, 0, 0}, {0.1, 0, 0.2});
    Simulation simulation(body, method);
    test::run(simulation, 0.5, 500);
    const Model& model = simulation.model();
    for (int i = 0; i < model.n_q(); ++i)
      if (model.coordinate_name(i) == "body.bend.direction") CHECK(simulation.state().q[i] == 0.5);
    CHECK(std::abs(simulation.ledger().balance) <= 1e-2);
    CHECK(simulation.velocities_without_inertia() == std::set<std::string>{"body.bend.direction"});
  }
}

// The dynamics of a simulation refer to its own model, so that a simulation cannot be copied or moved.
static_assert(!std::is_copy_constructible_v<Simulation> && !std::is_move_constructible_v<Simulation>);

TEST_CASE("gravity that is not finite is refused before the first step", "[failure]") {
  MultiBody body;
  body.add<Primitive<Box>>("box", 1000);
  body.gravity[1] = kNaN;
  REQUIRE_THROWS_AS(Simulation(body), std::invalid_argument);
}

}  // namespace failures_test
