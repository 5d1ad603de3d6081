// Free modes (modes of local deformation on which no joint or contact acts) under explicit Runge-Kutta
// methods with error control. The methods integrate these oscillators exactly, so that stiff modes do not
// shorten the steps.
#include "catch.h"

#include <pliant/part/local/local_laws.h>
#include <pliant/simulate/stable_step.h>

#include "motion.h"

namespace free_stages_test {

using namespace pliant;

namespace {

/// Adds a tumbling solid with polynomial modes. parameters: whether three of its parameters are dynamic.
/// ringing: whether its modes oscillate from the start.
void tumbling(MultiBody& body, double E, double beta, bool parameters, bool ringing = true) {
  body.gravity.setZero();
  auto& part = body.add(make_part("soft", "superellipsoid", {"taper", "twist"}, 20));
  part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}, {"taper.tx", 0.2}})
      .place({1, 2, 3}, Eigen::Quaterniond(0.5, 0.5, -0.1, 0.3))
      .velocity({0.3, -0.2, 0.1}, {1, 0.6, -0.8});
  if (parameters)
    part.stiffness({{"a1", 200}, {"taper.tx", 20}, {"twist.angle", 15}}).initial({{"twist.angle", 0.3}});
  LocalSettings settings;
  settings.basis = LocalSettings::Basis::polynomial;
  settings.degree = 3;
  settings.energies = {local_law("elastic", {E, 0.3})};
  if (ringing)
    settings.velocity = [](const Vec3<double>& X) -> Vec3<double> {
      return 0.2 * Vec3<double>(4 * X[1] * X[2], 2 * X[0] * X[2], std::cos(3 * X[1]) * X[2]);
    };
  settings.beta = beta;
  part.deform_locally(settings);
}

/// Returns q and v after 0.4 s of tumbling().
VecX<double> end_of(const std::string& method, int steps, double beta, bool parameters) {
  MultiBody body;
  tumbling(body, 2e3, beta, parameters);
  Simulation simulation(body, method);
  test::run(simulation, 0.4, steps);
  VecX<double> end(simulation.state().q.size() + simulation.state().v.size());
  end << simulation.state().q, simulation.state().v;
  return end;
}

}  // namespace

TEST_CASE("explicit methods keep their orders with free modes", "[modal][long]") {
  for (const bool parameters : {false, true})
    for (const double beta : {0.0, 5e-4}) {
      const VecX<double> reference = end_of("dop853", 400, beta, parameters);
      struct Method {
        const char* name;
        int steps;
        double order;
      };
      for (const Method& method : {Method{"dormand_prince", 40, 4.9}, Method{"dop853", 45, 7.5}}) {
        std::vector<double> errors;
        for (const int times : {1, 2}) {
          const VecX<double> end = end_of(method.name, times * method.steps, beta, parameters);
          errors.push_back((end - reference).norm() / reference.norm());
        }
        CAPTURE(method.name, parameters, beta, errors);
        CHECK(test::observed_order(errors) >= method.order);
        CHECK(errors.back() <= 1e-6);
      }
    }
}

TEST_CASE(
    "with error control, the number of steps hardly grows with the stiffness of fast modes on which no joint "
    "or contact acts",
    "[modal]") {
  for (const char* method : {"dormand_prince", "dop853"}) {
    std::vector<double> steps, energies, stable;
    for (const double E : {1e5, 1e8, 1e11}) {
      MultiBody body;
      tumbling(body, E, 0, false, false);
      Simulation simulation(body, method, 1, 1e-6);
      const double start = simulation.ledger().energy();
      while (simulation.time() < 2) simulation.step_up_to(2);
      steps.push_back(static_cast<double>(simulation.step_counters().steps));
      energies.push_back(std::abs(simulation.ledger().energy() / start - 1));
      stable.push_back(largest_stable_step(simulation));
    }
    CAPTURE(method, steps, energies, stable);
    CHECK(steps[1] <= 6 * steps[0]);  // the lowest modes of the softest solid are as slow as the tumbling
    CHECK(steps[2] <= 1.5 * steps[1]);
    CHECK(stable[2] >= 0.5 * stable[0]);  // the spin limits the step, not the modes
    for (const double energy : energies) CHECK(energy <= 1e-4);
  }
}

}  // namespace free_stages_test
