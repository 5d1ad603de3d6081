// Models in which nothing moves, or almost nothing acts. Every method must run these models, with and without
// contact.
#include "catch.h"

#include <functional>
#include <memory>

#include <pliant/body/joints/string.h>

#include "motion.h"

namespace degenerate_test {

using namespace pliant;

namespace {

/// A model without degrees of freedom, or with a feature that has nothing to act on.
struct Case {
  const char* name;
  std::function<void(MultiBody&)> build;
};

Part& ball(MultiBody& body, const std::string& name, double x) {
  return body.add<Primitive<Sphere>>(name, 1000).rest({{"r", 0.1}}).place({x, 0, 1});
}

const Case kCases[] = {
    {"no part", [](MultiBody&) {}},
    {"one fixed part", [](MultiBody& body) { ball(body, "a", 0).fix(); }},
    {"two fixed parts that overlap",
     [](MultiBody& body) {
       ball(body, "a", 0).fix();
       ball(body, "b", 0.1).fix();
     }},
    {"one free part", [](MultiBody& body) { ball(body, "a", 0); }},
    {"a slack string that is the only joint of its parts",
     [](MultiBody& body) {
       Part &a = ball(body, "a", 0), &b = ball(body, "b", 0.5);
       body.join("slack", String{10}, {point(a, 0, 0, 0), point(b, 0, 0, 0)});
     }},
    {"a joint that has not begun to act",
     [](MultiBody& body) {
       Part &a = ball(body, "a", 0), &b = ball(body, "b", 0.2);
       body.ball("later", point(a, 0, 0, 0), point(b, 0, 0, 0)).during(100);
     }},
};

/// Runs a case for a tenth of a second in steps of 10 ms, and checks that its ledger is exact.
void check_run(const Case& model, const std::string& method, double tolerance, bool contact) {
  INFO(model.name << ", " << method << ", tolerance " << tolerance << ", contact " << contact);
  MultiBody body;
  body.gravity = Vec3<double>(0, 0, -9.81);
  model.build(body);
  if (contact) {
    body.contact.between_parts = true;
    body.plane("floor", Vec3<double>(0, 0, -5), {0, 0, 1});
  }
  Simulation simulation(body, method, 1, tolerance);
  for (int k = 0; k < 10; ++k) simulation.step(0.01);
  const Ledger ledger = simulation.ledger();
  CHECK(simulation.time() == Approx(0.1));
  CHECK(simulation.state().q.allFinite());
  CHECK(ledger.work.allFinite());
  // In free fall the first-order method has an error of h / t = 0.1 of the kinetic energy.
  const double allowed = method == "semi_implicit_euler" ? 0.1 * ledger.kinetic : 0;
  CHECK(std::abs(ledger.balance) <= (1 + 1e-9) * allowed + 1e-12);
}

}  // namespace

TEST_CASE("models without degrees of freedom, contact pairs or joint rows run with every method",
          "[failure]") {
  const std::vector<std::string> controlled = controlled_integrators();
  for (const Case& model : kCases)
    for (const bool contact : {false, true}) {
      check_run(model, kAutomatic, 1e-6, contact);
      for (const std::string& method : controlled) check_run(model, method, 1e-6, contact);
      for (const IntegratorInfo& info : all_integrators()) check_run(model, info.name, 0, contact);
    }
}

}  // namespace degenerate_test
