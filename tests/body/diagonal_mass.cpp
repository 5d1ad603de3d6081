// Accelerations from the diagonal of M (section 5 of the paper) are compared with accelerations from the full
// M. With the diagonal, energy is not conserved.
#include <Eigen/LU>

#include "catch.h"
#include "motion.h"

namespace diagonal_mass_test {

using namespace pliant;

namespace {

/// Adds a solid that tumbles while its size a1, its taper and its twist oscillate. diagonal: whether its
/// accelerations are computed with the diagonal of M.
Part& add_solid(MultiBody& body, bool diagonal) {
  body.gravity.setZero();
  Part& a = test::add(body, "a", "superellipsoid", {"taper", "twist"}, 1000);
  a.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.5}, {"eps1", 0.6}, {"taper.tx", 0.3}});
  a.stiffness({{"a1", 3e4}, {"taper.tx", 200}, {"twist.angle", 300}})
      .initial({{"a1", 0.33}, {"twist.angle", 0.4}});
  a.velocity({0.3, 0, 0.1}, {2, 3, 1});
  if (diagonal) a.use_diagonal_mass();
  return a;
}

VecX<double> accelerations(const Simulation& simulation, Workspace<double>& work) {
  const State& state = simulation.state();
  simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
  return work.v_dot;
}

}  // namespace

TEST_CASE("with a diagonal mass matrix, a = f / diag(M)", "[mass]") {
  MultiBody coupled, diagonal;
  add_solid(coupled, false);
  add_solid(diagonal, true);
  const Simulation a(coupled, "rk4"), b(diagonal, "rk4");
  Workspace<double> work, of_diagonal;
  const VecX<double> exact = accelerations(a, work);
  const MatX<double> M = mass_matrix(work.parts[0]);
  VecX<double> a_r = exact;  // in the body frame, which is the world frame at time 0
  const VecX<double> expected = (M * a_r).cwiseQuotient(M.diagonal());
  CHECK((accelerations(b, of_diagonal) - expected).norm() <= 1e-12 * expected.norm());
  CHECK((exact - expected).norm() > 1e-2 * exact.norm());  // the coupling matters here
}

TEST_CASE("a rigid ellipsoid has a diagonal mass matrix in any case", "[mass]") {
  VecX<double> v[2];
  for (const bool diagonal : {false, true}) {
    MultiBody body;
    Part& a = test::add(body, "a", "ellipsoid", {}, 1000);
    a.rest({{"a1", 0.3}, {"a2", 0.2}}).velocity({0, 1, 0}, {2, 3, 1});
    if (diagonal) a.use_diagonal_mass();
    Simulation simulation(body, "dop853", 1, 1e-11);
    simulation.step(1);
    v[diagonal ? 1 : 0] = simulation.state().v;
  }
  CHECK((v[1] - v[0]).norm() <= 1e-10 * v[0].norm());
}

TEST_CASE("the coupled mass matrix conserves the energy, its diagonal does not", "[mass]") {
  double error[2];
  for (const bool diagonal : {false, true}) {
    MultiBody body;
    add_solid(body, diagonal);
    Simulation simulation(body, "dop853", 1, 1e-10);
    double largest = 0;
    for (int i = 0; i < 20; ++i) {
      simulation.step(0.05);
      largest = std::max(largest, std::abs(simulation.ledger().balance));
    }
    error[diagonal ? 1 : 0] = largest / simulation.start_energy();
  }
  CHECK(error[0] <= 1e-8);
  CHECK(error[1] > 1e-3);
}

TEST_CASE("with a diagonal mass matrix, a body whose centre of mass is not the origin falls wrongly",
          "[mass]") {
  double turning[2], momentum[2];
  for (const bool diagonal : {false, true}) {
    MultiBody body;
    body.gravity = {0, 0, -10};
    Part& a = test::add(body, "a", "box", {"bend"}, 1000);
    a.rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 1}, {"bend.angle", 1}});
    if (diagonal) a.use_diagonal_mass();
    Simulation simulation(body, "dop853", 1, 1e-10);
    simulation.step(0.5);
    turning[diagonal ? 1 : 0] = simulation.state().v.segment<3>(3).norm();
    momentum[diagonal ? 1 : 0] =
        std::abs(simulation.ledger().momentum.z() / a.total_mass() + 5);  // m/s, deviation from free fall
  }
  CHECK(turning[0] <= 1e-9);
  CHECK(momentum[0] <= 1e-9);
  CHECK(turning[1] > 0.1);
  CHECK(momentum[1] > 1e-2);
}

TEST_CASE("a diagonal mass matrix is refused for parts that deform locally", "[mass]") {
  MultiBody body;
  Part& a = test::add(body, "a", "sphere", {}, 1000);
  a.use_diagonal_mass().deform_locally({});
  CHECK_THROWS_AS(a.prepare(), std::invalid_argument);
}

}  // namespace diagonal_mass_test
