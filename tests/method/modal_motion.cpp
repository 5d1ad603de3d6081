// Motion of parts whose local deformation is a sum of modes: exact solution of the oscillators, free flight,
// forces, joints, agreement with nodal meshes.
#include "catch.h"

#include <complex>
#include <string>

#include <pliant/body/joints/all_joints.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/part/local/modal_deformation.h>
#include <pliant/simulate/stable_step.h>

#include "motion.h"
#include "widest_gap.h"

namespace modal_motion_test {

using namespace pliant;
using test::widest_gap;

namespace {

using Basis = LocalSettings::Basis;

Vec3<double> sample_velocity(const Vec3<double>& X) {
  return 0.2 * Vec3<double>(X[1] * X[2] / 0.25, 2 * X[0] * X[2], std::cos(3 * X[1]) * X[2]);
}
Vec3<double> sample_displacement(const Vec3<double>& X) {
  return 0.02 * Vec3<double>(4 * X[0] * X[1], X[2], 4 * X[1] * X[1] - X[2]);
}

LocalSettings soft(Basis basis, double E = 2e3) {
  LocalSettings settings;
  settings.basis = basis;
  settings.degree = 3;
  settings.modes = 12;
  settings.resolution = 3;
  settings.energies = {local_law("elastic", {E, 0.3})};
  settings.displacement = sample_displacement;
  settings.velocity = sample_velocity;
  return settings;
}

/// Adds a tumbling, oscillating solid and returns it. parameters: whether three of its parameters are
/// dynamic.
Part& tumbling(MultiBody& body, Basis basis, bool parameters) {
  body.gravity.setZero();
  auto& part = body.add(make_part("soft", "superellipsoid", {"taper", "twist"}, 20));
  part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}, {"taper.tx", 0.2}})
      .place({1, 2, 3}, Eigen::Quaterniond(0.5, 0.5, -0.1, 0.3))
      .velocity({0.3, -0.2, 0.1}, {1, 0.6, -0.8});
  if (parameters)
    part.stiffness({{"a1", 200}, {"taper.tx", 20}, {"twist.angle", 15}})
        .initial({{"a1", 0.52}, {"twist.angle", 0.3}})
        .initial_rate({{"taper.tx", 0.3}});
  part.deform_locally(soft(basis));
  return part;
}

}  // namespace

TEST_CASE("a mode of a free sphere is integrated exactly over a hundred periods with three steps each",
          "[modal]") {
  for (const char* method : {"rk4", "semi_implicit_euler"})
    for (const double beta : {0.0, 1e-4, 0.5}) {
      MultiBody body;
      body.gravity.setZero();
      auto& part = body.add<Primitive<Sphere>>("ball", 1000);
      part.rest({{"r", 0.1}});
      LocalSettings settings = soft(Basis::polynomial, 1e5);
      settings.degree = 4;
      settings.displacement = settings.velocity = nullptr;
      settings.beta = beta;
      part.deform_locally(settings);
      Simulation simulation(body, method);
      const Oscillators& all = *part.local()->oscillators();
      const double omega = std::sqrt(all.omega2[0]), period = 2 * kPi / omega;
      State state = simulation.state();
      state.q[7] = 1e-3;
      simulation.set_state(state);
      test::run(simulation, 100.25 * period, 401 * 3 / 4);
      const double g = 0.5 * all.damping[0], t = simulation.state().time();
      // `one` and `other` are the roots of x^2 + 2 g x + omega^2. The solution is q = 1e-3 c, with the rate
      // -1e-3 omega^2 s.
      const std::complex<double> kappa = std::sqrt(std::complex<double>(all.omega2[0] - g * g)), i(0, 1),
                                 one = i * kappa - g, other = all.omega2[0] / one;
      const double s = ((std::exp(one * t) - std::exp(other * t)) / (one - other)).real(),
                   c = ((one * std::exp(other * t) - other * std::exp(one * t)) / (one - other)).real();
      CAPTURE(method, beta, t, kappa);
      CHECK(simulation.state().q[7] == Approx(1e-3 * c).epsilon(1e-10).margin(1e-13));
      CHECK(simulation.state().v[6] ==
            Approx(-1e-3 * all.omega2[0] * s).epsilon(1e-10).margin(1e-13 * omega));
    }
}

TEST_CASE("free flight of parts whose modes oscillate while they tumble: order 4, and conservation laws",
          "[modal][motion][long]") {
  for (const Basis basis : {Basis::polynomial, Basis::modes})
    for (const bool parameters : {false, true}) {
      std::vector<double> energy, momentum, angular;
      for (const int steps : {50, 100, 200}) {
        MultiBody body;
        tumbling(body, basis, parameters);
        Simulation simulation(body, "rk4");
        const Ledger start = simulation.ledger();
        test::run(simulation, 0.5, steps);
        const Ledger end = simulation.ledger();
        energy.push_back(std::abs(end.energy() - start.energy()) / start.energy());
        momentum.push_back((end.momentum - start.momentum).norm() / start.momentum.norm());
        angular.push_back((end.angular_momentum - start.angular_momentum).norm() /
                          start.angular_momentum.norm());
      }
      CAPTURE(static_cast<int>(basis), parameters, energy, momentum, angular);
      CHECK(test::observed_order(energy) >= 3.8);
      CHECK(test::observed_order(angular) >= 3.8);
      CHECK((momentum.back() <= 1e-12 || test::observed_order(momentum) >= 3.8));
      CHECK(energy.back() <= 1e-5);
    }
}

TEST_CASE("semi-implicit Euler with modes: first order", "[modal][motion][long]") {
  std::vector<VecX<double>> ends;
  for (const int steps : {200, 400, 800, 1600}) {
    MultiBody body;
    tumbling(body, Basis::polynomial, true);
    Simulation simulation(body, "semi_implicit_euler");
    test::run(simulation, 0.25, steps);
    ends.push_back(simulation.state().q);
  }
  std::vector<double> errors;
  for (std::size_t i = 0; i + 1 < ends.size(); ++i) errors.push_back((ends[i + 1] - ends[i]).norm());
  CHECK(test::observed_order(errors) >= 0.9);
}

TEST_CASE("a force at any node accelerates the centre of mass by F / m and rotates the part by its torque",
          "[modal][long]") {
  for (const Basis basis : {Basis::polynomial, Basis::modes})
    for (const bool parameters : {false, true})
      for (const bool moving : {false, true}) {
        CAPTURE(basis == Basis::polynomial, parameters, moving);
        MultiBody body;
        Part& part = tumbling(body, basis, parameters);
        part.prepare();
        const std::vector<Material<double>> nodes = part.local()->mesh().nodes;
        const Vec3<double> force(100, -200, 50);
        int pushed = -1;
        Vec3<double> place = Vec3<double>::Zero();
        for (int k = 0; k < static_cast<int>(nodes.size()); ++k)
          body.force("push" + std::to_string(k), point(part, nodes[static_cast<std::size_t>(k)]),
                     [&, k](double, const Vec3<double>& x, const Vec3<double>&) -> Vec3<double> {
                       if (k != pushed) return {0, 0, 0};
                       place = x;
                       return force;
                     });
        Simulation simulation(body, "rk4");
        State state = simulation.state();
        if (!moving) state.v.setZero();
        const LocalDeformation& local = *part.local();
        Workspace<double> work;
        PartWorkspace<double>* w = nullptr;
        auto accelerate = [&] {
          simulation.dynamics().accelerations(0, state.q, state.v, state, work);
          w = &work.parts[0];
        };
        accelerate();
        const VecX<double> without = w->a_r, d_without = work.v_dot.tail(local.n_d());
        if (!moving) {
          w->local->place(state.q.data() + 7 + part.n_s(), d_without.data(), local.n_d());
          const LocalMotion rate = local.motion(without, *w->local);
          CHECK(rate.momentum.norm() <= 1e-12 * force.norm());
          CHECK(rate.angular_momentum.norm() <= 1e-12 * force.norm());
        }
        for (pushed = 0; pushed < static_cast<int>(nodes.size()); ++pushed) {
          accelerate();
          const VecX<double> a_r = w->a_r - without, d_ddot = work.v_dot.tail(local.n_d()) - d_without;
          w->local->place(state.q.data() + 7 + part.n_s(), d_ddot.data(), local.n_d());
          const LocalMotion rate = local.motion(a_r, *w->local);
          const Vec3<double> f = w->R.transpose() * force, p = w->R.transpose() * (place - w->c);
          CHECK((rate.momentum - f).norm() <= 1e-12 * f.norm());
          CHECK((rate.angular_momentum - p.cross(f)).norm() <= 1e-12 * f.norm());
        }
      }
}

TEST_CASE("dust: material points of a spinning body of polynomials without elasticity move on straight lines",
          "[modal]") {
  std::vector<double> errors;
  for (const int steps : {50, 100, 200}) {
    MultiBody body;
    body.gravity.setZero();
    auto& part = body.add<Primitive<Ellipsoid>>("dust", 1);
    part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}}).velocity({0.1, 0, 0}, {0.2, 0.3, 0.4});
    part.make_dynamic({"a1", "a2", "a3"});
    LocalSettings settings = soft(Basis::polynomial);
    settings.energies.clear();
    settings.displacement = nullptr;
    settings.velocity = [](const Vec3<double>& X) -> Vec3<double> {
      return 0.3 * Vec3<double>(X[1] * X[2], X[0] * X[2], X[0] * X[0]);
    };
    part.deform_locally(settings);
    Simulation simulation(body, "rk4");
    std::vector<Material<double>> points;
    for (int i = 0; i < 20; ++i) points.push_back(material_at(0.15 * i - 1.4, 0.7 * i, 0.2 + 0.04 * i));
    auto places = [&] {
      Nodes x(20, 3);
      for (int i = 0; i < 20; ++i)
        x.row(i) = simulation.model()
                       .world_point(simulation.state(), 0, points[static_cast<std::size_t>(i)])
                       .transpose();
      return x;
    };
    const Nodes x0 = places();
    test::run(simulation, 0.5, steps);
    const Nodes x1 = places();
    test::run(simulation, 0.5, steps);
    errors.push_back((places() - 2 * x1 + x0).norm() / x0.norm());
  }
  CAPTURE(errors);
  CHECK(test::observed_order(errors) >= 3.9);
  CHECK(errors.back() <= 1e-7);
}

TEST_CASE("modes on a ball joint, a hinge and a loop: joints stay closed, and the order is kept",
          "[modal][joints][long]") {
  for (const Basis basis : {Basis::polynomial, Basis::modes})
    for (const bool loop : {false, true}) {
      std::vector<double> energy;
      for (const int steps : {200, 400, 800}) {
        MultiBody body;
        auto add = [&](const std::string& name, const Vec3<double>& at) -> Part& {
          auto& part = body.add<Primitive<Ellipsoid>>(name, 20);
          part.rest({{"a1", 0.3}, {"a2", 0.3}, {"a3", 0.6}}).place(at);
          LocalSettings settings = soft(basis, 4e3);
          settings.displacement = settings.velocity = nullptr;
          part.deform_locally(settings);
          return part;
        };
        Part &upper = add("upper", {0, 0, -0.6}), &lower = add("lower", {0.3, 0, -1.2});
        body.ball("top", world(0, 0, 0), point(upper, kPi / 2, 0));
        body.hinge("between", point(upper, 0, 0), point(lower, kPi / 2, 0), {0, 1, 0});
        if (loop) body.ball("foot", world(0.3, 0, -1.8), point(lower, -kPi / 2, 0));
        Simulation simulation(body, "rk4");
        const double start = simulation.ledger().energy();
        for (int i = 0; i < steps; ++i) {
          simulation.step(0.5 / steps);
          REQUIRE(widest_gap(simulation) <= 1e-10);
        }
        energy.push_back(std::abs(simulation.ledger().energy() - start));
      }
      CAPTURE(static_cast<int>(basis), loop, energy);
      CHECK(test::observed_order(energy) >= 3.7);
    }
}

namespace {

/// Adds a part with a basis, in free flight or hanging from a point of its surface. For Basis::nodes the mesh
/// is coarse.
void add_part(MultiBody& body, Basis basis, bool hanging) {
  auto& part = body.add<Primitive<Ellipsoid>>("soft", 20);
  part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}})
      .stiffness({{"a1", 200}})
      .initial({{"a1", 0.52}})
      .place({0, 0, -0.6})
      .velocity({0.3, -0.2, 0.1}, {1, 0.6, -0.8});
  LocalSettings settings = soft(basis, 500);
  if (basis == Basis::nodes) settings.resolution = 1;
  if (hanging) settings.displacement = nullptr;
  part.deform_locally(settings);
  if (hanging)
    body.ball("top", world(0, 0, 0), point(part, kPi / 2, 0));
  else
    body.gravity.setZero();
}

/// Returns the state of add_part() after 0.2 s.
State end_of(Basis basis, bool hanging, const std::string& method, int steps) {
  MultiBody body;
  add_part(body, basis, hanging);
  Simulation simulation(body, method);
  test::run(simulation, 0.2, steps);
  return simulation.state();
}

struct MethodCase {
  const char* method;
  int steps;  ///< number of steps of the coarsest run
};

}  // namespace

TEST_CASE(
    "each method converges with its order to a fine rk4 solution, for parts with local deformation, free and "
    "on a joint",
    "[modal][methods][joints][long]") {
  for (const Basis basis : {Basis::nodes, Basis::polynomial, Basis::modes})
    for (const bool hanging : {false, true}) {
      const State exact = end_of(basis, hanging, "rk4", 8000);
      std::vector<MethodCase> all{{"esdirk", 20}, {"implicit_midpoint", 40}};
      if (basis == Basis::nodes || hanging) {
        all.push_back({"dop853", basis == Basis::modes ? 3 : 8});
        all.push_back({"dormand_prince", basis == Basis::modes        ? 10
                                         : basis == Basis::polynomial ? 160
                                         : hanging                    ? 80
                                                                      : 40});
      }
      for (const MethodCase& tested : all) {
        CAPTURE(static_cast<int>(basis), hanging, tested.method);
        std::vector<double> q, v;
        for (int halving = 0; halving < 3; ++halving) {
          const State at = end_of(basis, hanging, tested.method, tested.steps << halving);
          q.push_back((at.q - exact.q).norm());
          v.push_back((at.v - exact.v).norm());
        }
        CAPTURE(q, v);
        const int order = make_integrator(tested.method)->order();
        const double min_order = order >= 8 ? order - 0.5 : order - 0.1;
        CHECK(test::observed_order(q) >= min_order);
        CHECK(test::observed_order(v) >= min_order);
      }
    }
}

TEST_CASE("a spinning body swells equally with polynomials of a high degree, modes and a fine mesh",
          "[modal][long]") {
  std::vector<Nodes> shapes;
  double swell = 0;
  for (const Basis basis : {Basis::nodes, Basis::modes, Basis::polynomial}) {
    MultiBody body;
    body.gravity.setZero();
    auto& part = body.add<Primitive<Ellipsoid>>("ball", 100);
    part.rest({{"a1", 0.3}, {"a2", 0.35}, {"a3", 0.5}}).velocity({0.5, 0, 0}, {0, 10, 3});
    LocalSettings settings = soft(basis, 5e4);
    settings.displacement = settings.velocity = nullptr;
    settings.degree = 8;
    settings.resolution = 2;
    settings.order = 2;
    settings.modes = 60;
    part.deform_locally(settings);
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.05, basis == Basis::nodes ? 400 : 100);
    auto places = [&](const State& state) {
      Nodes x(20, 3);
      for (int i = 0; i < 20; ++i)
        x.row(i) = simulation.model().world_point(state, 0, material_at(0.15 * i - 1.4, 0.7 * i)).transpose();
      return x;
    };
    shapes.push_back(places(simulation.state()));
    State undeformed = simulation.state();
    undeformed.q.tail(part.n_d()).setZero();
    swell = (places(undeformed) - shapes.back()).norm();
  }
  const double nodes_error = (shapes[0] - shapes[2]).norm(), modes_error = (shapes[1] - shapes[2]).norm();
  CAPTURE(swell, nodes_error, modes_error);
  CHECK(nodes_error <= 0.02 * swell);
  CHECK(modes_error <= 0.05 * swell);
}

TEST_CASE("the momenta of a body with modes are those of its initial velocity field", "[modal]") {
  for (const bool parameters : {false, true}) {
    MultiBody body;
    body.gravity.setZero();
    auto& part = body.add<Primitive<Ellipsoid>>("ball", 20);
    part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}})
        .place({0, 0, 0}, Eigen::Quaterniond(0.5, 0.5, -0.1, 0.3));
    if (parameters) part.make_dynamic({"a1", "a3"});
    LocalSettings settings = soft(Basis::polynomial);
    settings.displacement = nullptr;
    settings.velocity = [](const Vec3<double>& X) -> Vec3<double> {
      return {1 + X[2] + X[0] * X[0], X[0] * X[1], 0.5 * X[1] + X[2] * X[2]};
    };
    part.deform_locally(settings);
    Simulation simulation(body, "rk4");
    const Ledger ledger = simulation.ledger();
    // For an ellipsoid int x^2 dm = m a^2 / 5.
    const double m = part.total_mass();
    const Mat3<double> R = part.R0().toRotationMatrix();
    const Vec3<double> P = m * Vec3<double>(1 + 0.05, 0, 0.36 / 5),
                       L = m / 5 * Vec3<double>(0.5 * 0.16, 0.36, 0);
    CHECK((ledger.momentum - R * P).norm() <= 1e-11 * P.norm());
    CHECK((ledger.angular_momentum - R * L).norm() <= 1e-11 * L.norm());
  }
}

TEST_CASE("modes give identical bits with any number of threads, and after a copy of the state", "[modal]") {
  std::vector<std::uint64_t> bits;
  for (const int threads : {1, 2, 3}) {
    MultiBody body;
    tumbling(body, Basis::polynomial, true);
    Simulation simulation(body, "rk4", threads);
    test::run(simulation, 0.01, 5);
    Simulation again(body, "rk4", threads);
    again.set_state(simulation.state());
    for (int i = 0; i < 5; ++i) {
      simulation.step(0.002);
      again.step(0.002);
    }
    CHECK(hash(again.state()) == hash(simulation.state()));
    bits.push_back(hash(simulation.state()));
  }
  CHECK(bits[0] == bits[1]);
  CHECK(bits[0] == bits[2]);
}

TEST_CASE(
    "the largest stable step of a part with modes is unlimited in free flight; if a spring pulls the part, "
    "the highest mode limits the step",
    "[modal]") {
  for (const bool pulled : {false, true}) {
    MultiBody body;
    body.gravity.setZero();
    auto& part = body.add<Primitive<Sphere>>("ball", 1000);
    LocalSettings settings = soft(Basis::polynomial, 1e5);
    settings.displacement = settings.velocity = nullptr;
    part.rest({{"r", 0.1}}).deform_locally(settings);
    if (pulled) body.spring("spring", world(0, 0, 1), point(part, 0.3, 0.4), 10, 0);
    const StableStep stable = stable_step(Simulation(body, "rk4"));
    const double highest = std::sqrt(part.local()->oscillators()->omega2.maxCoeff());
    if (pulled) {  // the phase of each mode changes by at most one radian per step
      CHECK(stable.step == Approx(1 / highest).epsilon(1e-6));
      CHECK_FALSE(stable.uncounted.empty());
    } else {
      CHECK(std::isinf(stable.step));
    }
  }
}

}  // namespace modal_motion_test
