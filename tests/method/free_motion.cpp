// Free motion with known solutions: the torque-free top, dust (a solid without elasticity), steady spin,
// breathing, and pseudo-rigid bodies. A tumbling solid with all parameters dynamic has no known solution:
// conservation and order are checked.
// N17, N26 and N28 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include "motion.h"
#include "worst.h"

namespace free_motion_test {

using namespace pliant;

namespace {

Vec3<double> omega_of(const Simulation& s) {
  return s.state().v.segment<3>(3);
}

}  // namespace

TEST_CASE("torque-free top: a solid ellipsoid agrees with the exact solution to 1.5e-10", "[motion]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Ellipsoid>>("top", 1000);
  part.rest({{"a1", std::sqrt(1.75)}, {"a2", std::sqrt(0.75)}, {"a3", 0.5}})
      .mass(5)
      .velocity({0.3, 0, 0}, {1, 0, 1.2});
  Simulation simulation(body, "rk4");
  const MatMax<double>& M = part.rest_inertia().M;
  CHECK(M(3, 3) == Approx(1).epsilon(1e-13));
  CHECK(M(4, 4) == Approx(2).epsilon(1e-13));
  CHECK(M(5, 5) == Approx(2.5).epsilon(1e-13));
  const Ledger start = simulation.ledger();
  test::run(simulation, 10, 10000);
  CHECK((omega_of(simulation) - Vec3<double>(0.9646371098, -0.3228201816, 1.1766137016)).norm() < 1.5e-10);
  const Ledger end = simulation.ledger();
  CHECK(end.kinetic == Approx(start.kinetic).epsilon(1e-12));
  CHECK((end.angular_momentum - start.angular_momentum).norm() < 1e-11);
  CHECK((end.momentum - start.momentum).norm() < 1e-14);
}

TEST_CASE("torque-free top: omega returns to its initial value after one period", "[motion]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Ellipsoid>>("top", 1000);
  part.rest({{"a1", std::sqrt(1.75)}, {"a2", std::sqrt(0.75)}, {"a3", 0.5}})
      .mass(5)
      .velocity({0, 0, 0}, {1, 0, 1.2});
  Simulation simulation(body, "rk4");
  test::run(simulation, 10.3653773746, 8000);
  CHECK((omega_of(simulation) - Vec3<double>(1, 0, 1.2)).norm() < 2e-10);
}

TEST_CASE("torque-free top: a lamina given by its inertia", "[motion]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Box>>("lamina", 1000);
  part.inertia(1, Vec3<double>(1, 2, 3).asDiagonal()).velocity({0, 0, 0}, {1, 0, 1.2});
  Simulation simulation(body, "rk4");
  test::run(simulation, 10, 10000);
  // Reference: Euler's equations in long double.
  CHECK((omega_of(simulation) - Vec3<double>(0.2342940841, -0.9721657689, 1.0606434710)).norm() < 1.5e-10);
  Simulation again(body, "rk4");
  test::run(again, 5.58617892142, 5000);
  CHECK((omega_of(again) - Vec3<double>(1, 0, 1.2)).norm() < 2e-10);
}

TEST_CASE("torque-free top: a perturbation of spin about the middle axis grows at the known rate",
          "[motion]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Box>>("box", 1000);
  const double tiny = 1e-7;
  part.inertia(1, Vec3<double>(1, 2, 2.5).asDiagonal());
  const double rate = 1.5 * std::sqrt(1.0 * 0.5 / 2.5);
  // The unstable direction: omega_1 / omega_3 = -sqrt(I3 (I3 - I2) / (I1 (I2 - I1))).
  part.velocity({0, 0, 0}, {tiny, 1.5, -tiny / std::sqrt(2.5 * 0.5)});
  Simulation simulation(body, "rk4");
  test::run(simulation, 4, 4000);
  CHECK(std::abs(omega_of(simulation)[0]) == Approx(tiny * std::exp(rate * 4)).epsilon(1e-4));
}

TEST_CASE("N17: a free box over 500 steps: drift of energy and angular momentum", "[motion]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Box>>("box", 1000);
  part.rest({{"a1", 0.1}, {"a2", 0.2}, {"a3", 0.3}}).mass(1).velocity({0, 0, 0}, {1, 2, 3});
  Simulation simulation(body, "rk4");
  const Ledger start = simulation.ledger();
  test::run(simulation, 5, 500);
  const Ledger end = simulation.ledger();
  CHECK(std::abs(end.kinetic / start.kinetic - 1) <= 1e-9);
  CHECK((end.angular_momentum - start.angular_momentum).norm() <= 1e-8 * start.angular_momentum.norm());
}

TEST_CASE("a dust ellipsoid: every particle moves on a straight line", "[motion]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Ellipsoid>>("dust", 700);
  part.rest({{"a3", 0.7}})
      .make_dynamic({"a1", "a2", "a3"})
      .place({1, 2, 3})
      .velocity({0.1, 0, -0.2}, {0, 0, 2});
  Simulation simulation(body, "rk4");
  std::vector<Material<double>> particles;
  for (double u : {-1.2, -0.3, 0.0, 0.8})
    for (double v : {-2.0, 0.4, 3.0})
      for (double w : {0.3, 1.0}) particles.push_back(material_at(u, v, w));
  std::vector<Vec3<double>> x0;
  for (const Material<double>& m : particles)
    x0.push_back(simulation.model().world_point(simulation.state(), 0, m));
  const double T = 2;
  test::run(simulation, T, 4000);
  const State& state = simulation.state();
  const double growth = std::sqrt(1 + 4 * T * T);
  CHECK(state.q[7] == Approx(growth).epsilon(1e-11));
  CHECK(state.q[8] == Approx(growth).epsilon(1e-11));
  CHECK(state.q[9] == Approx(0.7).epsilon(1e-13));
  CHECK(2 * std::atan2(state.q[6], state.q[3]) == Approx(std::atan(2 * T)).epsilon(1e-11));
  for (std::size_t i = 0; i < particles.size(); ++i) {
    const Vec3<double> v =
        Vec3<double>(0.1, 0, -0.2) + Vec3<double>(0, 0, 2).cross(x0[i] - Vec3<double>(1, 2, 3));
    CHECK((simulation.model().world_point(state, 0, particles[i]) - (x0[i] + T * v)).norm() < 1e-10);
  }
}

TEST_CASE("steady spin: an ellipsoid that starts with the width a0 / (1 - m omega^2 / (5 k)) keeps it",
          "[motion]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Ellipsoid>>("body", 1000);
  const double k = 2000, omega = 3, m = 100;
  const double wide = 0.5 / (1 - m * omega * omega / (5 * k));
  part.rest({{"a1", 0.5}, {"a2", 0.5}, {"a3", 0.4}}).mass(m).stiffness({{"a1", k}, {"a2", k}, {"a3", k}});
  part.initial({{"a1", wide}, {"a2", wide}}).velocity({0, 0, 0}, {0, 0, omega});
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    Simulation simulation(body, method);
    test::run(simulation, 10, 2000);
    CHECK(simulation.state().q[7] == Approx(wide).epsilon(1e-10));
    CHECK(simulation.state().q[8] == Approx(wide).epsilon(1e-10));
    CHECK(simulation.state().v[5] == Approx(omega).epsilon(1e-10));
  }
}

TEST_CASE("free breathing of one semi-axis: omega^2 = k / (m s), where s is the mean of (z / a3)^2",
          "[motion]") {
  struct Body {
    bool shell;
    double eps, mean_square;
  };
  for (const Body& b : {Body{false, 1, 0.2}, Body{true, 1, 1.0 / 3}, Body{false, 0.5, 0.274168},
                        Body{false, 0.1, 0.328868}}) {
    MultiBody body;
    body.gravity.setZero();
    auto& part = body.add(make_part("body", "superellipsoid", {}, 1000));
    part.rest({{"eps1", b.eps}, {"eps2", b.eps}}).mass(3).stiffness({{"a3", 50}}).initial({{"a3", 1.2}});
    if (b.shell) part.make_shell();
    Simulation simulation(body, "rk4");
    const double period = 2 * kPi / std::sqrt(50 / (3 * b.mean_square));
    test::run(simulation, period, 1000);
    CHECK(simulation.state().q[7] == Approx(1.2).epsilon(1e-6));
    CHECK(std::abs(simulation.state().v[6]) < 2e-4);
  }
}

TEST_CASE("pseudo-rigid ellipsoid against the integration of its own Lagrangian", "[motion]") {
  const double m = 10, k[3] = {300, 500, 400}, rest[3] = {0.5, 0.4, 0.6};
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Ellipsoid>>("body", 1000);
  part.rest({{"a1", rest[0]}, {"a2", rest[1]}, {"a3", rest[2]}}).mass(m);
  part.stiffness({{"a1", k[0]}, {"a2", k[1]}, {"a3", k[2]}})
      .initial({{"a1", 0.6}})
      .initial_rate({{"a2", 0.5}});
  part.velocity({0, 0, 0}, {2, 3, 1});
  part.mass(m);
  Simulation simulation(body, "rk4");

  // The state (a, a_dot, H = I omega) in the body frame.
  using Vec9 = Vec<double, 9>;
  auto inertia = [m](const Vec9& y) {
    return Vec3<double>(m / 5 * (y[1] * y[1] + y[2] * y[2]), m / 5 * (y[0] * y[0] + y[2] * y[2]),
                        m / 5 * (y[0] * y[0] + y[1] * y[1]));
  };
  auto rate = [&](const Vec9& y) {
    const Vec3<double> H = y.tail<3>(), w = H.cwiseQuotient(inertia(y));
    Vec9 d;
    d.head<3>() = y.segment<3>(3);
    for (int i = 0; i < 3; ++i)
      d[3 + i] = (w.squaredNorm() - w[i] * w[i]) * y[i] - 5 / m * k[i] * (y[i] - rest[i]);
    d.tail<3>() = H.cross(w);
    return d;
  };
  Vec9 y;
  y << 0.6, rest[1], rest[2], 0, 0.5, 0, 0, 0, 0;
  y.tail<3>() = inertia(y).cwiseProduct(Vec3<double>(2, 3, 1));
  // The mass is given, so the initial semi-axes do not change the mass.
  const double T = 3;
  const int steps = 6000;
  for (int i = 0; i < steps; ++i) {
    const double h = T / steps;
    const Vec9 k1 = rate(y), k2 = rate(y + h / 2 * k1), k3 = rate(y + h / 2 * k2), k4 = rate(y + h * k3);
    y += h / 6 * (k1 + 2 * k2 + 2 * k3 + k4);
  }
  test::run(simulation, T, 6000);
  for (int i = 0; i < 3; ++i) {
    CHECK(simulation.state().q[7 + i] == Approx(y[i]).epsilon(1e-10));
    CHECK(simulation.state().v[6 + i] == Approx(y[3 + i]).epsilon(1e-9).margin(1e-10));
    CHECK(simulation.state().v[3 + i] == Approx(y[6 + i] / inertia(y)[i]).epsilon(1e-10));
  }
}

TEST_CASE("tumbling with all parameters dynamic: orders of RK4", "[motion][long]") {
  std::vector<VecX<double>> ends;
  std::vector<double> energy, momentum, angular;
  for (int steps : {100, 200, 400, 800, 3200}) {
    MultiBody body;
    test::tumbling_solid(body);
    Simulation simulation(body, "rk4");
    const Ledger start = simulation.ledger();
    test::run(simulation, 1, steps);
    const Ledger end = simulation.ledger();
    ends.push_back(simulation.state().q);
    if (steps == 3200) {
      CHECK(std::abs(end.energy() / start.energy() - 1) < 1e-9);
      CHECK((end.momentum - start.momentum).norm() < 1e-9 * start.momentum.norm());
      CHECK((end.angular_momentum - start.angular_momentum).norm() < 1e-9 * start.angular_momentum.norm());
      continue;
    }
    energy.push_back(std::abs(end.energy() - start.energy()));
    momentum.push_back((end.momentum - start.momentum).norm());
    angular.push_back((end.angular_momentum - start.angular_momentum).norm());
  }
  std::vector<double> trajectory;
  for (std::size_t i = 0; i < 4; ++i) trajectory.push_back((ends[i] - ends.back()).norm());
  INFO("trajectory " << trajectory[0] << " " << trajectory[3] << " energy " << energy[0] << " " << energy[3]
                     << " P " << momentum[0] << " " << momentum[3] << " L " << angular[0] << " "
                     << angular[3]);
  CHECK(test::observed_order(trajectory) >= 3.9);
  CHECK(test::observed_order(energy) >= 3.9);
  CHECK(test::observed_order(momentum) >= 3.9);
  CHECK(test::observed_order(angular) >= 3.9);
}

TEST_CASE("tumbling with all parameters dynamic: semi-implicit Euler is of first order", "[motion][long]") {
  std::vector<VecX<double>> ends;
  std::vector<double> energy;
  for (int steps : {2000, 4000, 8000}) {
    MultiBody body;
    test::tumbling_solid(body);
    Simulation simulation(body, "semi_implicit_euler");
    test::run(simulation, 0.5, steps);
    energy.push_back(std::abs(simulation.ledger().balance));
    ends.push_back(simulation.state().q);
  }
  MultiBody body;
  test::tumbling_solid(body);
  Simulation reference(body, "rk4");
  test::run(reference, 0.5, 2000);
  std::vector<double> trajectory;
  for (const VecX<double>& q : ends) trajectory.push_back((q - reference.state().q).norm());
  CHECK(test::observed_order(trajectory) == Approx(1).margin(0.1));
  CHECK(test::observed_order(energy) >= 0.9);
}

TEST_CASE("with a dynamic exponent, energy and angular momentum are conserved at order 4", "[motion][long]") {
  std::vector<double> energy, angular;
  for (int steps : {80, 160, 320}) {
    MultiBody body;
    body.gravity.setZero();
    auto& part = body.add(make_part("body", "superellipsoid", {"taper"}, 1000));
    part.rest({{"eps1", 0.7}, {"eps2", 1}, {"a3", 0.5}, {"taper.tx", 0.3}})
        .stiffness({{"eps1", 20000}, {"a1", 40000}});
    part.initial({{"eps1", 0.8}}).initial_rate({{"a1", 1}}).velocity({0, 0, 0}, {1, -2, 1.5});
    Simulation simulation(body, "rk4");
    const Ledger start = simulation.ledger();
    test::run(simulation, 0.25, steps);
    const Ledger end = simulation.ledger();
    energy.push_back(std::abs(end.balance));
    angular.push_back((end.angular_momentum - start.angular_momentum).norm());
  }
  CHECK(test::observed_order(energy) >= 3.9);
  CHECK(test::observed_order(angular) >= 3.9);
}

TEST_CASE("momentum is conserved to rounding if the frame is at the centre of mass", "[motion]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    body.gravity.setZero();
    auto& part = body.add(make_part("body", "ellipsoid", {"twist"}, 1000));
    part.rest({{"a2", 0.5}}).stiffness({{"a1", 1e5}, {"a3", 1e5}, {"twist.angle", 1e4}});
    part.initial({{"a1", 1.2}, {"twist.angle", 0.7}}).velocity({0.3, 0.2, -0.1}, {1, 2, 3});
    Simulation simulation(body, method);
    const Vec3<double> P = simulation.ledger().momentum;
    test::run(simulation, 1, 500);
    CHECK((simulation.ledger().momentum - P).norm() <= 1e-12 * P.norm());
  }
}

TEST_CASE("N26: after reversal of the velocities RK4 returns to the start at its order", "[motion][long]") {
  std::vector<double> errors;
  for (int steps : {100, 200, 400}) {
    MultiBody body;
    test::tumbling_solid(body);
    Simulation simulation(body, "rk4");
    const VecX<double> q0 = simulation.state().q;
    test::run(simulation, 0.5, steps);
    State back = simulation.state();
    back.v = -back.v;
    simulation.set_state(back);
    test::run(simulation, 0.5, steps);
    errors.push_back((simulation.state().q - q0).norm());
  }
  INFO(errors[0] << " " << errors[2]);
  CHECK(test::observed_order(errors) >= 3.9);
}

TEST_CASE("N28: the time is the number of steps times the step", "[motion]") {
  MultiBody body;
  body.add<Primitive<Sphere>>("ball", 1000);
  Simulation simulation(body);
  for (int i = 0; i < 1000; ++i) simulation.step(1e-3);
  CHECK(simulation.time() == 1000 * 1e-3);
  for (int i = 0; i < 10; ++i) simulation.step(0.1);
  CHECK(simulation.time() == 1.0 + 10 * 0.1);
  State late = simulation.state();
  late.step = 1000000000;
  CHECK(late.time() == late.start + 1e9 * 0.1);
}

}  // namespace free_motion_test
