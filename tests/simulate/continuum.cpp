// Parts whose global parameters have an elastic material: free flight, damping, derivatives, failures, and
// the comparison with a mesh of the same material.
#include "catch.h"

#include <cmath>

#include <pliant/part/local/local_laws.h>

#include "differences.h"
#include "draws.h"
#include "motion.h"

namespace continuum_test {

using namespace pliant;

namespace {

/// Adds a tumbling solid whose only stiffness is that of its material, with all kinds of parameters dynamic,
/// and sets gravity to zero. law: name of the material law; beta: damping, s.
Part& rubber(MultiBody& body, const std::string& law, double beta = 0) {
  body.gravity.setZero();
  Part& part = test::add(body, "rubber", "ellipsoid", {"taper", "twist", "shear", "bend"}, 1000);
  part.rest({{"a1", 0.3}, {"a2", 0.25}, {"a3", 0.6}, {"taper.tx", 0.1}, {"bend.angle", 0.2}});
  part.make_dynamic({"a1", "a2", "a3", "taper.tx", "twist.angle", "shear.sx", "bend.angle"});
  part.elasticity({law, 4e5, 0.3, 0});
  part.damping(0, beta);
  part.initial({{"a1", 0.31}, {"twist.angle", 0.2}, {"bend.angle", 0.3}});
  part.initial_rate({{"a3", -0.5}, {"taper.tx", 1}, {"shear.sx", 0.7}});
  part.place({0.1, -0.2, 0.3}, Eigen::Quaterniond(0.8, 0.1, -0.5, 0.2));
  part.velocity({0.5, -0.3, 0.2}, {2, -1.5, 1});
  return part;
}

/// Errors and losses of a run. balance: absolute value of the balance of the ledger at the end of a run,
/// relative to the energy at the start. momentum, angular: norms of the changes of P and L in the run,
/// relative to the norms at the start. dissipated: work of damping, positive if energy is lost, relative to
/// the energy at the start.
struct Drift {
  double balance, momentum, angular, dissipated;
};
/// Simulates rubber() for 0.3 s in free flight.
Drift free_flight_drift(const std::string& law, double beta, int steps) {
  MultiBody body;
  rubber(body, law, beta);
  Simulation simulation(body, "rk4");
  const Ledger start = simulation.ledger();
  test::run(simulation, 0.3, steps);
  const Ledger end = simulation.ledger();
  return {std::abs(end.balance) / start.energy(),
          (end.momentum - start.momentum).norm() / start.momentum.norm(),
          (end.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm(),
          -end.work[static_cast<int>(Work::damping)] / start.energy()};
}

/// Returns the frequency (1/s) of a function of the state, from the times of its zero crossings over a number
/// of periods. h: step, s.
template <class F>
double frequency(Simulation& simulation, double h, int periods, F&& of_state) {
  double before = of_state(simulation.state()), first = -1, last = -1;
  int crossings = 0;
  while (crossings < 2 * periods + 1) {
    simulation.step(h);
    const double now = of_state(simulation.state());
    if ((now > 0) != (before > 0)) {
      last = simulation.time() - h * now / (now - before);
      if (crossings == 0) first = last;
      ++crossings;
    }
    before = now;
  }
  return periods / (last - first);
}

}  // namespace

TEST_CASE("an elastic solid of seven parameters in free flight conserves P and L, and energy at order 4",
          "[continuum][motion][long]") {
  for (const char* law : {"elastic", "st_venant_kirchhoff", "neo_hookean"}) {
    CAPTURE(law);
    std::vector<double> balance, momentum, angular;
    for (const int steps : {100, 200, 400}) {
      const Drift drift = free_flight_drift(law, 0, steps);
      balance.push_back(drift.balance);
      momentum.push_back(drift.momentum);
      angular.push_back(drift.angular);
      CHECK(drift.dissipated == 0);
    }
    CAPTURE(balance, momentum, angular);
    CHECK(test::observed_order(balance) >= 3.9);
    CHECK(balance.back() <= 1e-4);
    CHECK(momentum.back() <= 1e-8);
    CHECK(angular.back() <= 1e-7);
  }
}

TEST_CASE("damping of the material removes energy, which the ledger records, and conserves P and L",
          "[continuum][motion][long]") {
  auto end_of = [](int steps) {
    MultiBody body;
    rubber(body, "neo_hookean", 1e-3);
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.1, steps);
    return simulation.state().q;
  };
  const VecX<double> exact = end_of(1600);
  std::vector<double> error;
  for (const int steps : {50, 100, 200}) error.push_back((end_of(steps) - exact).norm());
  CAPTURE(error);
  CHECK(test::observed_order(error) >= 3.9);
  const Drift drift = free_flight_drift("neo_hookean", 1e-3, 800);
  CHECK(drift.dissipated > 0.05);
  CHECK(drift.balance <= 1e-6);
  CHECK(drift.momentum <= 1e-8);
  CHECK(drift.angular <= 1e-7);
}

TEST_CASE("a solid that only spins dissipates nothing, even while it is bent", "[continuum][long]") {
  // The motion of the frame causes no strain rate.
  MultiBody body;
  Part& part = rubber(body, "neo_hookean", 0.1);
  part.initial_rate({{"a3", 0}, {"taper.tx", 0}, {"shear.sx", 0}});
  Simulation simulation(body, "rk4");
  Workspace<double> work;
  simulation.dynamics().accelerations(0, simulation.state().q, simulation.state().v, simulation.state(),
                                      work);
  CHECK(work.power[static_cast<int>(Work::damping)] == 0);
}

TEST_CASE("the amplitude of small motion decays at the rate beta omega^2 / 2", "[continuum][motion]") {
  MultiBody body;
  body.gravity.setZero();
  auto& ball = body.add<Primitive<Sphere>>("ball", 1000);
  const Elasticity material(1e5, 0.3);
  const double beta = 1e-4, eta2 = 5 * (3 * material.lambda() + 2 * material.mu()) / material.mu(),
               omega2 = eta2 * material.mu() / 1000;
  ball.make_dynamic({"r"}).elasticity({"neo_hookean", 1e5, 0.3, 0});
  ball.damping(0, beta).initial({{"r", 1 + 1e-6}});
  Simulation simulation(body, "rk4");
  const double start = simulation.ledger().energy(), time = 2 / (beta * omega2);
  test::run(simulation, time, 4000);
  CHECK(std::log(start / simulation.ledger().energy()) == Approx(beta * omega2 * time).epsilon(2e-2));
}

TEST_CASE("the Jacobian-vector product of an elastic part agrees with finite differences",
          "[continuum][long]") {
  for (const double beta : {0.0, 3e-3}) {
    MultiBody body;
    rubber(body, "neo_hookean", beta);
    const Simulation simulation(body, "rk4");
    const Dynamics& dynamics = simulation.dynamics();
    const State& state = simulation.state();
    test::Draws draws(2);
    Workspace<double> scratch;
    for (int trial = 0; trial < 4; ++trial) {
      VecX<double> dq(state.q.size()), dv(state.v.size());
      for (double& x : dq) x = draws.uniform(-0.1, 0.1);
      for (double& x : dv) x = draws.uniform(-1, 1);
      const VecX<double> derivative = dynamics.jvp(state, {dq, dv});
      const VecX<double> expected =
          test::first_derivative(
              [&](long double e) {
                const double k = static_cast<double>(e);
                dynamics.accelerations(0, state.q + k * dq, state.v + k * dv, state, scratch);
                return VecX<long double>(scratch.v_dot.cast<long double>());
              },
              1e-3L)
              .cast<double>();
      CHECK((derivative - expected).norm() <= 1e-7 * expected.norm());
    }
  }
}

TEST_CASE("a solid that is inverted stops the run with a message that names the part",
          "[continuum][failure]") {
  MultiBody body;
  body.gravity.setZero();
  Part& part = test::add(body, "slab", "box", {"bend"}, 1000);
  // The slab is so thick that every quadrature rule has points in the fold, where the map is inverted.
  part.rest({{"a1", 1.5}, {"a3", 1}}).initial_rate({{"bend.angle", 60}});
  part.elasticity({"neo_hookean", 1e3, 0.3, 0});
  Simulation simulation(body, "rk4");
  CHECK_THROWS_WITH(test::run(simulation, 0.1, 1000),
                    test::has_text("part 'slab'") && test::has_text("inside out"));
  CHECK(simulation.state().q.allFinite());
}

TEST_CASE("the predicted stable step of an elastic part agrees with the measured one",
          "[continuum][stable][long]") {
  auto grows = [](double beta, double h) {
    MultiBody body;
    Part& part = rubber(body, "st_venant_kirchhoff", beta);
    part.velocity({0, 0, 0}, {0, 0, 0})
        .initial({{"a1", 0.3 * (1 + 1e-9)}, {"twist.angle", 0}, {"bend.angle", 0.2}});
    part.initial_rate({{"a3", 0}, {"taper.tx", 0}, {"shear.sx", 0}});
    Simulation simulation(body, "rk4");
    const double predicted = largest_stable_step(simulation);
    const double start = simulation.ledger().energy();
    try {
      for (int i = 0; i < 400; ++i) simulation.step(h * predicted);
    } catch (const NumericalFailure&) {
      return kInfinity;  // the amplitude grew until the part was inverted
    }
    return simulation.ledger().energy() / start;
  };
  for (const double beta : {0.0, 1e-3}) {
    CHECK(grows(beta, 0.97) <= 1);
    CHECK(grows(beta, 1.03) > 1e3);
  }
}

TEST_CASE("the strain of frozen parameters is not evaluated, and semi-axes alone need one quadrature point",
          "[continuum][skip]") {
  MultiBody body;
  body.gravity.setZero();
  auto& stone = body.add<Primitive<Ellipsoid>>("stone", 1000);
  stone.elasticity({"neo_hookean", 1e5, 0.3, 0});
  Simulation frozen_run(body, "rk4");
  frozen_run.step(1e-3);
  CHECK(frozen_run.counters().strain_points == 0);
  MultiBody soft;
  soft.gravity.setZero();
  soft.add<Primitive<Ellipsoid>>("ball", 1000)
      .make_dynamic({"a1", "a2", "a3"})
      .elasticity({"neo_hookean", 1e5, 0.3, 0});
  Simulation dynamic_run(soft, "rk4");
  dynamic_run.step(1e-3);
  CHECK(dynamic_run.counters().strain_points == 4);  // one for each evaluation
}

TEST_CASE("assembly before time 0 stretches an elastic part", "[continuum][assembly]") {
  // A rubber ball is joined to two points that are farther apart than its diameter. In the assembly its
  // material acts as a massless spring between the joints.
  MultiBody body;
  body.gravity.setZero();
  body.stabilization.assemble_first = true;
  auto& ball = body.add<Primitive<Ellipsoid>>("ball", 1000);
  ball.make_dynamic({"a1", "a2", "a3"}).elasticity({"neo_hookean", 1e5, 0.3, 0});
  body.ball("left", world(-1.3, 0, 0), point(ball, 0, kPi));
  body.ball("right", world(1.3, 0, 0), point(ball, 0, 0));
  Simulation simulation(body, "rk4");
  const VecX<double> q = simulation.state().q.tail(3);
  CHECK(q[0] == Approx(1.3).epsilon(1e-9));
  CHECK(q[1] == Approx(q[2]).epsilon(1e-6));
  // There is no transverse stress: the derivative of the elastic energy with respect to a2 is zero.
  VecX<double> f = VecX<double>::Zero(3);
  Counters unused;
  ball.continuum()->add_force(ball, VecMax<double>(q), VecMax<double>(VecMax<double>::Zero(3)), 0, f, unused);
  CHECK(std::abs(f[1]) <= 1e-5 * std::abs(f[0]));
  CHECK(q[1] < 0.95);
}

TEST_CASE("with a mesh of the same material, frequencies of the semi-axes converge to those of Lamb",
          "[continuum][motion][long]") {
  // The mode S2 and the breathing mode of a free solid sphere, nu_P = 0.25 (Lamb 1882). The exact values of
  // omega a / c_s (a: radius, c_s: speed of shear waves) are 2.63987 and 4.44000; three semi-axes alone give
  // 3.1623 and 5.0. The initial values of the semi-axes excite the mode. If the semi-axes are frozen, the
  // initial displacements of the nodes excite it.
  const double exact[2] = {2.63987, 4.44000}, scales[2] = {std::sqrt(10.0), 5.0};
  auto eta = [](const std::string& law, int mode, int resolution, bool dynamic) {
    MultiBody body;
    body.gravity.setZero();
    auto& ball = body.add<Primitive<Ellipsoid>>("ball", 1);
    const Vec3<double> direction = mode == 0 ? Vec3<double>(1, 1, -2) : Vec3<double>(1, 1, 1);
    static constexpr double size = 1e-4;
    if (dynamic)
      ball.make_dynamic({"a1", "a2", "a3"})
          .initial({{"a1", 1 + size * direction[0]},
                    {"a2", 1 + size * direction[1]},
                    {"a3", 1 + size * direction[2]}});
    if (resolution == 0) {
      ball.elasticity({law, 2.5, 0.25, 0});
    } else {
      LocalSettings settings;
      settings.resolution = resolution;
      settings.energies.push_back(local_law(law, {2.5, 0.25}));
      if (!dynamic)
        settings.displacement = [direction](const Vec3<double>& X) -> Vec3<double> {
          return size * direction.cwiseProduct(X);
        };
      ball.deform_locally(settings);
    }
    Simulation simulation(body, "rk4");
    // Returns a measure of the strain in the mode, from the nodes, or from the semi-axes without a mesh.
    auto strain = [&](const State& state) {
      if (resolution == 0) return direction.dot(state.q.segment<3>(7) - Vec3<double>::Ones());
      const Nodes x = simulation.model().node_positions(state, 0), &X = ball.local()->mesh().X;
      const VecX<double>& m = ball.local()->mesh().mass;
      double sum = 0;
      for (int i = 0; i < 3; ++i) sum += direction[i] * m.dot(X.col(i).cwiseProduct(x.col(i) - X.col(i)));
      return sum;
    };
    const double h = std::min(0.02, 0.7 * largest_stable_step(simulation));
    return 2 * kPi * frequency(simulation, h, mode == 0 ? 4 : 3, strain);
  };
  for (const char* law : {"neo_hookean", "st_venant_kirchhoff"})
    for (int mode = 0; mode < 2; ++mode) {
      CAPTURE(law, mode);
      const double without_mesh = eta(law, mode, 0, true), coarse = eta(law, mode, 2, true),
                   fine = eta(law, mode, 4, true), by_nodes = eta(law, mode, 4, false);
      CAPTURE(without_mesh, coarse, fine, by_nodes);
      CHECK(without_mesh == Approx(scales[mode]).epsilon(1e-3));
      CHECK(by_nodes == Approx(fine).epsilon(2e-3));
      CHECK(std::abs(fine - exact[mode]) < 0.4 * std::abs(coarse - exact[mode]));
      CHECK(std::abs(fine - exact[mode]) < 0.2 * std::abs(without_mesh - exact[mode]));
    }
}

}  // namespace continuum_test
