// Motion with joints: decay laws of Baumgarte's equation, momenta, pendulums and chains with known solutions,
// strings, parameter limits under joints, orders of convergence, joints that contradict each other.
// N34 to N60 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <array>
#include <map>

#include <Eigen/Geometry>

#include <pliant/body/joints/rod.h>
#include <pliant/body/joints/string.h>
#include <pliant/math/eigenvalues.h>

#include "draws.h"
#include "motion.h"

namespace joints_test {

using namespace pliant;

namespace {

/// Adds a sphere of radius 0.2 m. A ball joint at its centre exerts no torque.
Part& sphere(MultiBody& body, const std::string& name, const Vec3<double>& c, double density = 1000) {
  Part& part = test::add(body, name, "sphere", {}, density);
  part.rest({{"r", 0.2}}).place(c);
  return part;
}
Point centre(const Part& part) {
  return point(part, 0, 0, 0);
}

/// Adds two spheres with an open joint between their centres, and sets gravity to zero. Nothing rotates.
void open_pair(MultiBody& body) {
  body.gravity.setZero();
  Part &a = sphere(body, "a", {0, 0, 0}), &b = sphere(body, "b", {0.3, 0.1, -0.2}, 300);
  body.ball("ab", centre(a), centre(b));
}

/// Returns the first minus the second point of a joint, m, world.
Vec3<double> gap(const Simulation& simulation, std::size_t joint = 0) {
  const Joint& j = *simulation.model().joints()[joint].joint;
  auto place = [&](const Point& p) -> Vec3<double> {
    if (p.part == nullptr) return p.world.value(simulation.time());
    return simulation.model().world_point(simulation.state(), simulation.model().body().index(*p.part),
                                          p.material);
  };
  return place(j.points()[0]) - place(j.points()[1]);
}

/// Adds a chain of ellipsoids 0.6 m long, joined tip to tip. The first tip is joined to the origin, and the
/// chain starts along x. turn: initial rotation about x of each link relative to the link before, rad.
void chain(MultiBody& body, int links, double turn = 0) {
  for (int i = 0; i < links; ++i) {
    const std::string name = "link" + std::to_string(i);
    Part& link = test::add(body, name, "ellipsoid", {}, 1000);
    link.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}});
    link.place({0.3 + 0.6 * i, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(turn * i, Vec3<double>::UnitX())));
    const Part* before = i > 0 ? body.find("link" + std::to_string(i - 1)) : nullptr;
    body.ball("joint" + std::to_string(i), before == nullptr ? world(0, 0, 0) : point(*before, 0, 0),
              point(link, 0, kPi));
  }
}

/// Returns the lowest observed order that is accepted for a method of order p.
double min_order(int p) {
  return p <= 5 ? p - 0.1 : p - 0.5;
}

}  // namespace

TEST_CASE(
    "N37: from rest, translation only, a gap closes as C0 (1 + alpha t) e^(-alpha t), at the method's order",
    "[joints]") {
  for (const IntegratorInfo& method : all_integrators()) {
    const int coarse = method.order == 1 ? 2000 : method.order == 2 ? 400 : method.order < 8 ? 80 : 10;
    std::vector<double> errors;
    for (const int steps : {coarse, 2 * coarse}) {
      MultiBody body;
      open_pair(body);
      body.stabilization.rule = BaumgarteRule::critical;
      body.stabilization.rate = 4;
      body.stabilization.projection = false;
      Simulation simulation(body, method.name);
      double error = 0;
      for (int i = 0; i < steps; ++i) {
        simulation.step(1.0 / steps);
        const double t = simulation.time();
        error = std::max(
            error, (gap(simulation) - Vec3<double>(-0.3, -0.1, 0.2) * (1 + 4 * t) * std::exp(-4 * t)).norm());
      }
      errors.push_back(error);
      CHECK(simulation.ledger().momentum.norm() <= 1e-12);
    }
    INFO(method.name << ": " << errors.front() << " to " << errors.back() << " m, order "
                     << test::observed_order(errors));
    CHECK(test::observed_order(errors) >= min_order(method.order));
  }
}

TEST_CASE("BaumgarteRule::step_consistent: C_n = C0 r^n (1 + n (1 - r)), to rounding and for any step",
          "[joints]") {
  for (const double rate_h : {0.01, 0.3, 1.0, 5.0, 1000.0}) {
    MultiBody body;
    open_pair(body);
    body.stabilization.rate = 20;
    body.stabilization.projection = false;
    Simulation simulation(body, "semi_implicit_euler");
    const double h = rate_h / 20, r = std::exp(-rate_h);
    for (int n = 1; n <= 40; ++n) {
      simulation.step(h);
      const Vec3<double> expected = Vec3<double>(-0.3, -0.1, 0.2) * std::pow(r, n) * (1 + n * (1 - r));
      INFO(rate_h << " " << n);
      CHECK((gap(simulation) - expected).norm() <= 1e-14);
    }
  }
}

namespace {

/// Returns whether a gap decays under critically damped Baumgarte terms with the rate alpha and the step h,
/// alpha h = x. Fails the test if the gap neither decays nor grows by a factor of 1e6.
bool decays(const char* method, double x) {
  MultiBody body;
  open_pair(body);
  body.stabilization.rule = BaumgarteRule::critical;
  body.stabilization.rate = 10;
  body.stabilization.speed = 1e9;
  body.stabilization.projection = false;
  Simulation simulation(body, method);
  const double h = x / 10, open = gap(simulation).norm();
  for (int i = 0; i < 5000; ++i) {
    simulation.step(h);
    // The gap may pass 0 with any rate, so the measure includes the rate.
    const Vec3<double> rate = simulation.state().v.head<3>() - simulation.state().v.segment<3>(6);
    const double size = gap(simulation).norm() + h * rate.norm();
    if (size <= 1e-6 * open) return true;
    if (!(size <= 1e6 * open)) return false;
  }
  FAIL("the gap neither decays nor grows");
  return false;
}

}  // namespace

TEST_CASE("N34: the stability limits of Baumgarte's equation, for alpha h from 0.01 to 4 and above",
          "[joints][long]") {
  // Limits x = alpha h of the explicit methods: |R(-x)| = 1, with the stability function R of the method. The
  // linearly implicit method treats joints explicitly. The value 0 means no limit.
  const std::map<std::string, double> stability_limits{{"semi_implicit_euler", 2 * (std::sqrt(2.0) - 1)},
                                                       {"rk4", 2.785294},
                                                       {"linearly_implicit", 0.960432},
                                                       {"implicit_midpoint", 0},
                                                       {"esdirk", 0},
                                                       {"dormand_prince", 3.306568},
                                                       {"dop853", 6.393651}};
  const MatX<double> K = MatX<double>::Ones(1, 1), D = 2 * K;
  for (const IntegratorInfo& info : all_integrators()) {
    const std::unique_ptr<Integrator> method = info.make();
    const double limit = stability_limits.at(info.name);
    std::vector<double> sweep;
    for (int k = 0; k <= 24; ++k) sweep.push_back(0.01 * std::pow(400, k / 24.0));
    sweep.insert(sweep.end(), {10, 100});
    if (limit > 0) sweep.insert(sweep.end(), {0.99 * limit, 1.01 * limit});
    for (const double x : sweep) {
      if (limit > 0 && std::abs(x / limit - 1) < 0.0099) continue;  // too close to the limit
      INFO(info.name << " at " << x);
      CHECK(decays(info.name, x) == (limit == 0 || x < limit));
      CHECK((method->growth(K, D, x) <= 1) == (limit == 0 || x < limit));
    }
  }
}

namespace {

/// Adds two spheres that translate and rotate, joined away from their centres by a wide open joint. Sets
/// gravity to zero.
void open_and_turning(MultiBody& body) {
  body.gravity.setZero();
  Part &a = sphere(body, "a", {0, 0, 0}), &b = sphere(body, "b", {1, 0.5, 0.3}, 400);
  a.velocity({0, 0.3, 0}, {1, 2, 0});
  b.velocity({0, 0, 0.4}, {0, -1, 3});
  body.ball("ab", point(a, 0.3, 1), point(b, -0.5, 2));
  body.stabilization.rate = 3;
  body.stabilization.projection = false;
}

/// Returns C x lambda of the first joint: the torque (N m) of its two forces, whose points are C apart.
Vec3<double> torque(const Simulation& simulation) {
  Workspace<double> work;
  const State& s = simulation.state();
  simulation.dynamics().accelerations(s.time(), s.q, s.v, s, work);
  return Vec3<double>(work.joints.C.head<3>()).cross(Vec3<double>(work.joints.lambda.head<3>()));
}

}  // namespace

TEST_CASE("N37: while a joint is open, P is conserved and dL/dt is the torque of its two forces",
          "[joints]") {
  struct Case {
    const char* method;
    std::vector<int> steps;
    double error;
  };
  for (const Case& c : {Case{"rk4", {50, 100, 200}, 1e-6}, Case{"dop853", {2000}, 1e-10}}) {
    std::vector<double> errors;
    for (const int steps : c.steps) {
      MultiBody body;
      open_and_turning(body);
      Simulation simulation(body, c.method);
      const Vec3<double> P = simulation.ledger().momentum, L = simulation.ledger().angular_momentum;
      // The torque is integrated by Simpson's rule over pairs of steps.
      Vec3<double> angular_impulse = Vec3<double>::Zero();
      const double h = 1.0 / steps;
      Vec3<double> start = torque(simulation);
      for (int i = 0; i < steps; i += 2) {
        simulation.step(h);
        const Vec3<double> middle = torque(simulation);
        simulation.step(h);
        const Vec3<double> end = torque(simulation);
        angular_impulse += h / 3 * (start + 4 * middle + end);
        start = end;
      }
      CHECK((simulation.ledger().momentum - P).norm() <= 1e-13 * P.norm());
      errors.push_back((simulation.ledger().angular_momentum - L - angular_impulse).norm() / L.norm());
    }
    INFO(c.method << " " << errors.back());
    CHECK(errors.back() <= c.error);
    if (errors.size() > 1) CHECK(test::observed_order(errors) >= 3.8);
  }
}

TEST_CASE("compound pendulum: exact periods from 30 to 150 degrees", "[joints]") {
  // An ellipsoid hangs from the tip of its long axis, the point O. The equivalent length is l = I_O / (m r),
  // with I_O the moment of inertia about O and r the distance of the centre from O.
  const double r = 0.3, l = (0.09 + 0.01) / (5 * r) + r;
  for (const double degrees : {30, 60, 90, 120, 150}) {
    const double theta = degrees * kPi / 180, period = 4 * std::sqrt(l / 9.81) * test::elliptic_K(theta);
    MultiBody body;
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}});
    // The long axis of the part points down when theta is 0.
    const Eigen::Quaterniond R(Eigen::AngleAxisd(kPi / 2 - theta, Vec3<double>::UnitY()));
    part.place(R * Vec3<double>(0.3, 0, 0), R);
    body.ball("pivot", world(0, 0, 0), point(part, 0, kPi));
    Simulation simulation(body, "rk4");
    test::run(simulation, period, 1000);
    INFO(degrees);
    CHECK((simulation.state().q.head<3>() - R * Vec3<double>(0.3, 0, 0)).norm() <= 1e-9);
    CHECK(gap(simulation).norm() <= 1e-12);
    CHECK(std::abs(simulation.ledger().balance) <= 1e-7);
  }
}

TEST_CASE("orders of convergence on a chain of 8 links: coordinates, velocities and forces, for every method",
          "[joints]") {
  auto at_end = [](const char* method, int steps) {
    MultiBody body;
    chain(body, 8, 0.7);
    Simulation simulation(body, method);
    test::run(simulation, 0.5, steps);
    Workspace<double> work;
    const State& s = simulation.state();
    simulation.dynamics().accelerations(s.time(), s.q, s.v, s, work);
    return std::array<VecX<double>, 3>{s.q, s.v, work.joints.lambda};
  };
  const auto reference = at_end("dop853", 500);
  const std::array names{"q", "v", "lambda"};
  for (const IntegratorInfo& method : all_integrators()) {
    const int coarse = method.order == 1 ? 2000 : method.order == 2 ? 400 : method.order < 8 ? 200 : 24;
    std::array<std::vector<double>, 3> errors;
    for (const int steps : {coarse, 2 * coarse}) {
      const auto end = at_end(method.name, steps);
      for (std::size_t i = 0; i < 3; ++i)
        errors[i].push_back((end[i] - reference[i]).norm() / reference[i].norm());
    }
    for (std::size_t i = 0; i < 3; ++i) {
      INFO(method.name << " " << names[i] << ": " << errors[i].front() << " to " << errors[i].back()
                       << ", order " << test::observed_order(errors[i]));
      CHECK(test::observed_order(errors[i]) >= min_order(method.order));
    }
  }
}

TEST_CASE("implicit methods form no matrix for a long chain if iterations without a matrix cost less",
          "[joints]") {
  // 200 links have more velocities than the dense matrix of an implicit method may have rows.
  constexpr int links = 200;
  constexpr double end = 0.2;
  MultiBody same;
  chain(same, links, 0.7);
  Simulation exact(same, "dop853", 1, 1e-9);
  while (exact.time() < end) exact.step_up_to(end);
  struct Bound {
    const char* method;
    int steps;
    double error;
    long evaluations;
  };
  for (const Bound& bound :
       {Bound{"implicit_midpoint", 32, 2e-4, 25 * 32}, Bound{"esdirk", 8, 1e-4, 125 * 8}}) {
    MultiBody body;
    chain(body, links, 0.7);
    Simulation simulation(body, bound.method);
    test::run(simulation, end, bound.steps);
    const double error = (simulation.state().q - exact.state().q).cwiseAbs().maxCoeff();
    CAPTURE(bound.method, error, simulation.step_counters().evaluations);
    CHECK(error < bound.error);
    CHECK(simulation.step_counters().factorisations == 0);
    CHECK(simulation.step_counters().evaluations < bound.evaluations);
  }
}

TEST_CASE("small oscillations of a chain of points: frequencies from the roots of the Laguerre polynomial",
          "[joints]") {
  // Rods of 1 m join the centres of spheres. The rods exert no torque, so the spheres move as material
  // points.
  for (const auto& [n, roots] :
       {std::pair<int, std::vector<double>>{2, {0.585786437627, 3.414213562373}},
        {3, {0.415774556783, 2.294280360279, 6.289945082937}},
        {5, {0.263560319718, 1.413403059107, 3.596425771041, 7.085810005859, 12.640800844276}}}) {
    MultiBody body;
    body.gravity = {0, 0, -1};
    for (int i = 0; i < n; ++i) {
      Part& mass = sphere(body, "mass" + std::to_string(i), {0, 0, -1.0 - i});
      const Part* before = i > 0 ? body.find("mass" + std::to_string(i - 1)) : nullptr;
      body.join("rod" + std::to_string(i), Rod{1},
                {before == nullptr ? world(0, 0, 0) : centre(*before), centre(mass)});
    }
    const Simulation simulation(body, "rk4");
    // x_ddot = -A x for horizontal motions, from directional derivatives at rest.
    MatX<double> A(n, n);
    for (int k = 0; k < n; ++k) {
      StateDirection along{VecX<double>::Zero(simulation.model().n_q()),
                           VecX<double>::Zero(simulation.model().n_v())};
      along.q[simulation.model().parts()[static_cast<std::size_t>(k)].q0] = 1;
      const VecX<double> a = simulation.dynamics().jvp(simulation.state(), along);
      for (int i = 0; i < n; ++i) A(i, k) = -a[simulation.model().parts()[static_cast<std::size_t>(i)].v0];
    }
    const VecX<double> values = eigenvalues(A).real();
    std::vector<double> found(values.data(), values.data() + n);
    std::sort(found.begin(), found.end());
    for (std::size_t i = 0; i < found.size(); ++i) CHECK(found[i] == Approx(roots[i]).epsilon(1e-10));
  }
}

TEST_CASE("a hanging ellipsoid: a3 oscillates about its rest value + m g / k, with omega^2 = k / (1.2 m)",
          "[joints]") {
  const double k = 2000;
  MultiBody body;
  Part& ball = test::add(body, "ball", "ellipsoid", {}, 1);
  ball.rest({{"a1", 0.5}, {"a2", 0.5}, {"a3", 0.5}}).mass(3).stiffness({{"a3", k}}).place({0, 0, -0.5});
  body.ball("string", world(0, 0, 0), point(ball, kPi / 2, 0));
  Simulation simulation(body, "rk4");
  const double stretch = 3 * 9.81 / k, omega = std::sqrt(k / 3.6);
  for (int i = 1; i <= 400; ++i) {
    simulation.step(1e-3);
    const double expected = 0.5 + stretch * (1 - std::cos(omega * simulation.time()));
    REQUIRE(simulation.state().q[7] == Approx(expected).margin(1e-8));
    REQUIRE(gap(simulation).norm() <= 1e-13);
  }
}

TEST_CASE("N39: a hanging chain carries its weight: each joint force is the weight below it", "[joints]") {
  for (const double end_mass : {1.0, 1e6}) {
    MultiBody body;
    const int n = 1000;
    for (int i = 0; i < n; ++i) {
      Part& link = test::add(body, "link" + std::to_string(i), "ellipsoid", {}, 1000);
      link.rest({{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.3}})
          .mass(i + 1 == n ? end_mass : 1)
          .place({0, 0, -0.3 - 0.6 * i});
      const Part* before = i > 0 ? body.find("link" + std::to_string(i - 1)) : nullptr;
      body.ball("joint" + std::to_string(i), before == nullptr ? world(0, 0, 0) : point(*before, -kPi / 2, 0),
                point(link, kPi / 2, 0));
    }
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.01, 10);
    Workspace<double> work;
    const State& s = simulation.state();
    simulation.dynamics().accelerations(s.time(), s.q, s.v, s, work);
    const double weight = 9.81 * (n - 1 + end_mass);
    CHECK(std::abs(std::abs(work.joints.lambda[2]) / weight - 1) <= 1e-8);
    CHECK(s.v.lpNorm<Eigen::Infinity>() <= 1e-6);
  }
}

TEST_CASE("N41: doubled and tripled joints give the motion of single joints", "[joints]") {
  VecX<double> single;
  for (const int copies : {1, 2, 3}) {
    MultiBody body;
    chain(body, 5, 0.4);
    for (int copy = 1; copy < copies; ++copy)
      for (int i = 1; i < 5; ++i)
        body.ball("copy" + std::to_string(copy) + "-" + std::to_string(i),
                  point(*body.find("link" + std::to_string(i - 1)), 0, 0),
                  point(*body.find("link" + std::to_string(i)), 0, kPi));
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.5, 500);
    if (copies == 1) single = simulation.state().q;
    CHECK((simulation.state().q - single).norm() <= 1e-10);
  }
}

TEST_CASE("N38: mass ratios of 1e6 and 1e-6 in a chain of two: gaps and tensions", "[joints]") {
  for (const double ratio : {1e-6, 1e6}) {
    MultiBody body;
    Part &a = sphere(body, "a", {0, 0, -1}), &b = sphere(body, "b", {0, 0, -2}, 1000 * ratio);
    body.join("upper", Rod{1}, {world(0, 0, 0), centre(a)});
    body.join("lower", Rod{1}, {centre(a), centre(b)});
    b.velocity({1e-3, 0, 0}, {0, 0, 0});
    Simulation simulation(body, "rk4");
    // A light bead on a loaded rod is a fast pendulum: omega^2 = (2 g / l) (m_b / m_a).
    for (int i = 0; i < 500; ++i) {
      simulation.step(ratio > 1 ? 1e-4 : 1e-3);
      REQUIRE(std::abs(gap(simulation, 0).norm() - 1) <= 1e-12);
      REQUIRE(std::abs(gap(simulation, 1).norm() - 1) <= 1e-12);
    }
    Workspace<double> work;
    const State& s = simulation.state();
    simulation.dynamics().accelerations(s.time(), s.q, s.v, s, work);
    // The tensions of two point masses on rods of 1 m, from the condition that the lengths of the rods have
    // no second derivative.
    const double m_a = a.total_mass(), m_b = b.total_mass();
    const Vec3<double> g(0, 0, -9.81), up = s.q.head<3>().normalized(),
                                       down = (s.q.segment<3>(7) - s.q.head<3>()).normalized();
    const double cosine = up.dot(down), pull_a = up.dot(g) + s.v.head<3>().squaredNorm(),
                 pull_ab = (s.v.segment<3>(6) - s.v.head<3>()).squaredNorm();
    const double give = up.cross(down).squaredNorm() / m_a + 1 / m_b;
    const double tension[] = {((1 + m_a / m_b) * pull_a + cosine * pull_ab) / give,
                              (cosine * pull_a + pull_ab) / give};
    for (const int i : {0, 1}) {
      INFO(ratio << ", joint " << i << ": " << std::abs(work.joints.lambda[i]) / tension[i] - 1);
      CHECK(std::abs(work.joints.lambda[i]) == Approx(tension[i]).epsilon(1e-12));
    }
    CHECK(std::abs(simulation.ledger().balance) <= 1e-9 * (a.total_mass() + b.total_mass()));
  }
}

TEST_CASE("N35: a spinning rod, by Baumgarte terms alone and with projection", "[joints]") {
  const double h = 0.01, r = std::exp(-10 * h);
  struct Case {
    const char* name;
    Stabilization gains;
    /// Steady gap (m) for a bias of 1 m/s^2; the bias is the acceleration of the gap without joint forces.
    /// The offset is h alpha / beta^2 for constant gains alpha and beta.
    double offset;
  };
  auto gains = [](BaumgarteRule rule, double rate) {
    Stabilization made;
    made.rule = rule;
    made.rate = rate;
    return made;
  };
  Stabilization dead_beat = gains(BaumgarteRule::free, 10);
  dead_beat.stab_alpha = 1 / (2 * h);
  dead_beat.stab_beta = 1 / h;
  for (const Case& c :
       {Case{"alpha = 10", gains(BaumgarteRule::critical, 10), h / 10},
        Case{"alpha = 0.5 / h", gains(BaumgarteRule::critical, 0.5 / h), h / (0.5 / h)},
        Case{"dead beat", dead_beat, h * h / 2},
        Case{"step-consistent", gains(BaumgarteRule::step_consistent, 10), h * h * (1 + r) / (2 * (1 - r))}})
    for (const bool projected : {false, true}) {
      MultiBody body;
      body.gravity.setZero();
      Part& mass = sphere(body, "mass", {1, 0, 0});
      mass.velocity({0, 2, 0}, {0, 0, 0});  // the bias is v^2 / r = 4 m/s^2
      body.join("rod", Rod{1}, {world(0, 0, 0), centre(mass)});
      body.stabilization = c.gains;
      body.stabilization.projection = projected;
      Simulation simulation(body, "semi_implicit_euler");
      for (int i = 0; i < 1000; ++i) simulation.step(h);
      const double offset = std::abs(gap(simulation).norm() - 1);
      INFO(c.name << ": " << offset << " m");
      if (projected)
        CHECK(offset <= 1e-13);
      else
        CHECK(offset == Approx(4 * c.offset).epsilon(0.02));
    }
}

TEST_CASE("N47: a point on a prescribed path follows it, at the method's order", "[joints][long]") {
  double widest = 0, balance = 0;
  auto at_end = [&](const char* method, int steps) -> VecX<double> {
    MultiBody body;
    Part& part = test::tumbling_solid(body);
    body.gravity = {0, 0, -9.81};
    const Vec3<double> x0 = Model(body).world_point(Model(body).initial_state(), 0, material_at(0.4, 1.0, 1));
    body.ball("hand",
              world({test::wave(x0[0], 0.3, 4), test::wave(x0[1], 0.2, 5), test::wave(x0[2], 0.1, 3)}),
              point(part, 0.4, 1.0));
    Simulation simulation(body, method);
    widest = 0;
    for (int i = 0; i < steps; ++i) {
      simulation.step(0.4 / steps);
      widest = std::max(widest, gap(simulation).norm());
    }
    balance = std::abs(simulation.ledger().balance) / simulation.ledger().energy();
    return simulation.state().q;
  };
  const VecX<double> reference = at_end("dop853", 800);
  for (const IntegratorInfo& method : all_integrators()) {
    const int coarse = method.order == 1 ? 2000 : method.order == 2 ? 400 : method.order < 8 ? 200 : 50;
    std::vector<double> errors, balances;
    for (const int steps : {coarse, 2 * coarse}) {
      errors.push_back((at_end(method.name, steps) - reference).norm());
      balances.push_back(balance);
      CHECK(widest <= 1e-12);
    }
    INFO(method.name << ": " << errors.front() << " to " << errors.back() << ", order "
                     << test::observed_order(errors) << ", of the balance " << balances.front() << " to "
                     << balances.back() << " order " << test::observed_order(balances));
    CHECK(test::observed_order(errors) >= min_order(method.order));
    CHECK(test::observed_order(balances) >= min_order(method.order));
    CHECK(balances.back() <= (method.order == 1 ? 2e-4 : method.order == 2 ? 1e-5 : 1e-8));
  }
}

TEST_CASE("a string is slack in free fall, goes taut without rebound, and swings as a rod does", "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    Part& mass = sphere(body, "mass", {0, 0, -0.5});
    body.join("string", String{1}, {world(0, 0, 0), centre(mass)});
    Simulation simulation(body, method);
    INFO(method);
    const double h = 1e-3, taut = std::sqrt(2 * 0.5 / 9.81);
    for (int i = 1; i <= 1000; ++i) {
      simulation.step(h);
      const double t = simulation.time();
      if (t < taut - 2 * h) {
        REQUIRE(simulation.state().joints[0] == JointMode::slack);
        REQUIRE(simulation.state().q[2] == Approx(-0.5 - 0.5 * 9.81 * t * t).margin(9.81 * h * t));
      }
      REQUIRE(gap(simulation).norm() <= 1 + 1e-9);
    }
    CHECK(simulation.state().joints[0] == JointMode::closed);
    CHECK(simulation.state().v.norm() <= 1e-12);
    const Ledger ledger = simulation.ledger();
    CHECK(ledger.work[static_cast<int>(Work::limits)] ==
          Approx(-mass.total_mass() * 9.81 * 0.5).epsilon(method[0] == 'r' ? 1e-9 : 0.01));
  }
  // While the string is taut, the mass moves as on a rod.
  VecX<double> q[2];
  for (const bool rod : {true, false}) {
    MultiBody body;
    Part& mass = sphere(body, "mass", {0.6, 0, -0.8});
    if (rod)
      body.join("rod", Rod{1}, {world(0, 0, 0), centre(mass)});
    else
      body.join("string", String{1}, {world(0, 0, 0), centre(mass)});
    Simulation simulation(body, "rk4");
    test::run(simulation, 1, 500);
    q[rod ? 0 : 1] = simulation.state().q;
    CHECK(std::abs(gap(simulation).norm() - 1) <= 1e-12);
  }
  CHECK((q[0] - q[1]).norm() <= 1e-9);
}

TEST_CASE("N60: two strings that go taut at the same time, and a string whose ends coincide at the start",
          "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    INFO(method);
    // Both strings are taut 0.8 m below the line of their anchors.
    MultiBody body;
    Part& mass = sphere(body, "mass", {0, 0, -0.1});
    for (const double side : {-0.6, 0.6})
      body.join(side < 0 ? "left" : "right", String{1}, {world(side, 0, 0), centre(mass)});
    Simulation simulation(body, method);
    Workspace<double> work;
    for (int i = 0; i < 600; ++i) {
      simulation.step(1e-3);
      const State& state = simulation.state();
      for (const double side : {-0.6, 0.6})
        REQUIRE((state.q.head<3>() - Vec3<double>(side, 0, 0)).norm() <= 1 + 1e-9);
      simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
      REQUIRE(work.joints.lambda.minCoeff() >= 0);
    }
    CHECK(simulation.state().q[2] == Approx(-0.8).epsilon(1e-9));
    CHECK(simulation.state().v.norm() <= 1e-9);
    CHECK(work.joints.lambda[0] == Approx(mass.total_mass() * 9.81 / 1.6).epsilon(1e-9));
    CHECK(work.joints.lambda[1] == Approx(mass.total_mass() * 9.81 / 1.6).epsilon(1e-9));

    MultiBody together;
    Part& other = sphere(together, "mass", {0, 0, 0});
    together.join("string", String{0.2}, {world(0, 0, 0), centre(other)});
    Simulation falling(together, method);
    for (int i = 0; i < 400; ++i) {
      falling.step(1e-3);
      REQUIRE(falling.state().q.allFinite());
      REQUIRE(falling.state().q.head<3>().norm() <= 0.2 * (1 + 1e-9));
    }
    CHECK(falling.state().q[2] == Approx(-0.2).epsilon(1e-9));
  }
  MultiBody body;
  Part& mass = sphere(body, "mass", {0, 0, 0});
  CHECK_THROWS_WITH(body.join("none", String{0}, {world(0, 0, 0), centre(mass)}),
                    "string 'none' needs a length > 0");
}

TEST_CASE("N46: joints act through the global parameters, with and without limits", "[joints]") {
  // The tips of an ellipsoid with a rest length of 1 m are joined to two world points that are 1.2 m apart,
  // so that the ellipsoid stretches. In the second model a limit stops the stretch.
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.5}}).stiffness({{"a3", 1000}}).damping(20, 0);
    body.ball("up", world(0, 0, 0.6), point(part, kPi / 2, 0));
    body.ball("down", world(0, 0, -0.6), point(part, -kPi / 2, 0));
    Simulation simulation(body, method);
    test::run(simulation, 2, 2000);
    INFO(method);
    CHECK(simulation.state().q[7] == Approx(0.6).epsilon(1e-12));
    CHECK(gap(simulation, 0).norm() <= 1e-12);
    CHECK(gap(simulation, 1).norm() <= 1e-12);
    Workspace<double> work;
    const State& s = simulation.state();
    simulation.dynamics().accelerations(s.time(), s.q, s.v, s, work);
    CHECK(std::abs(work.joints.lambda[2]) == Approx(1000 * 0.1 / 2).epsilon(1e-9));

    // A weight hangs from a soft ellipsoid and stretches it to its limit.
    MultiBody hanging;
    Part& soft = test::add(hanging, "soft", "ellipsoid", {}, 1000);
    soft.rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.5}}).stiffness({{"a3", 1000}}).limits("a3", {0.3, 0.55});
    soft.place({0, 0, -0.5});
    Part& weight = sphere(hanging, "weight", {0, 0, -1});
    hanging.ball("pin", world(0, 0, 0), point(soft, kPi / 2, 0));
    hanging.ball("tie", point(soft, -kPi / 2, 0), centre(weight));
    Simulation pulled(hanging, method);
    for (int i = 0; i < 2000; ++i) {
      pulled.step(1e-3);
      REQUIRE(pulled.state().q[7] <= 0.55);
      REQUIRE(gap(pulled, 0).norm() <= 1e-12);
      REQUIRE(gap(pulled, 1).norm() <= 1e-12);
    }
    CHECK(pulled.state().q[7] == 0.55);
    CHECK(pulled.state().v.norm() <= 1e-9);
    CHECK(pulled.step_counters().limit_impulses <= 5);
  }
}

TEST_CASE("N46: a joint that can close only by bending the part", "[joints][long]") {
  // An ellipsoid of 1 m that is bent by the angle b has tips that are sin(b) / b m apart. They are joined to
  // two world points that are 0.9 m apart.
  double b = 0.8;
  for (int i = 0; i < 50; ++i) b -= (std::sin(b) / b - 0.9) / ((b * std::cos(b) - std::sin(b)) / (b * b));
  const double k = 50, rest = 0.4, push = k * (b - rest) * b * b / (std::sin(b) - b * std::cos(b));
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {"bend"}, 1000);
    part.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.5}, {"bend.angle", rest}})
        .stiffness({{"bend.angle", k}})
        .damping(20, 0);
    body.ball("up", world(0, 0, 0.45), point(part, kPi / 2, 0));
    body.ball("down", world(0, 0, -0.45), point(part, -kPi / 2, 0));
    Simulation simulation(body, method);
    CHECK(simulation.state().joints[0] == JointMode::closing);
    test::run(simulation, 3, 3000);
    INFO(method);
    CHECK(simulation.state().q[7] == Approx(b).epsilon(1e-12));
    CHECK(gap(simulation, 0).norm() <= 1e-12);
    CHECK(gap(simulation, 1).norm() <= 1e-12);
    Workspace<double> work;
    const State& s = simulation.state();
    simulation.dynamics().accelerations(s.time(), s.q, s.v, s, work);
    for (const int j : {0, 1})
      CHECK((work.joints.lambda.segment<3>(3 * j) - Vec3<double>(0, 0, j == 0 ? push : -push)).norm() <=
            1e-9 * push);
  }
}

TEST_CASE("N46: lambda C_q v is the power of the joints on a part that stretches and bends", "[joints]") {
  MultiBody body;
  Part& part = test::add(body, "part", "ellipsoid", {"bend"}, 1000);
  part.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.5}, {"bend.angle", 0.4}})
      .stiffness({{"a3", 2000}, {"bend.angle", 50}})
      .damping(1, 1e-3);
  body.ball("up", world({test::wave(0, 0.1, 5), 0, test::wave(0.5, 0.1, 7)}), point(part, kPi / 2, 0));
  body.ball("down", world(0, 0, -0.45), point(part, -kPi / 2, 0));
  Simulation simulation(body, "rk4");
  bool closing = false;
  for (int i = 0; i < 1000; ++i) {
    simulation.step(2e-3);
    const State& s = simulation.state();
    closing = closing || s.joints[0] == JointMode::closing;
    Workspace<double> with_joints, without_joints;
    simulation.dynamics().accelerations(s.time(), s.q, s.v, s, with_joints);
    State loose = s;
    loose.joints.assign(2, JointMode::off);
    simulation.dynamics().accelerations(s.time(), s.q, s.v, loose, without_joints);
    const PartWorkspace<double>& w = with_joints.parts[0];
    const double power = (mass_matrix(w) * (w.a_r - without_joints.parts[0].a_r)).dot(w.v_r);
    // C_q v is C_dot without the motion of the anchor.
    VecX<double> rates = with_joints.joints.C_dot;
    rates.head<3>() -= Vec3<double>(0.5 * std::cos(5 * s.time()), 0, 0.7 * std::cos(7 * s.time()));
    const VecX<double>& lambda = with_joints.joints.lambda;
    REQUIRE(lambda.norm() > 1);
    REQUIRE(std::abs(power - lambda.dot(rates)) <= 1e-11 * lambda.norm() * s.v.norm());
  }
  CHECK(closing);
  CHECK(simulation.state().joints[0] == JointMode::closed);
  CHECK(simulation.state().v.tail<2>().norm() > 1e-3);
}

TEST_CASE(
    "N36: while a joint closes from far apart, its parts move at up to 1.5 times the largest closing speed, "
    "and the joint is closed at the end",
    "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler"})
    for (const double apart : {3, 10, 100}) {
      MultiBody body;
      body.gravity.setZero();
      Part &a = sphere(body, "a", {0, 0, 0}), &b = sphere(body, "b", {0.2 * apart, 0.1, 0});
      body.ball("ab", point(a, 0.3, 2), point(b, 1, -1));
      Simulation simulation(body, method);
      double fastest = 0;
      const int steps = 1000 + static_cast<int>(50 * apart);
      for (int i = 0; i < steps; ++i) {
        simulation.step(2e-3);
        for (const Part* part : {&a, &b}) {
          const PartModel& m =
              simulation.model().parts()[static_cast<std::size_t>(simulation.model().body().index(*part))];
          fastest = std::max(fastest, simulation.state().v.segment<3>(m.v0).norm());
        }
      }
      INFO(method << " from " << apart);
      CHECK(simulation.state().joints[0] == JointMode::closed);
      CHECK(gap(simulation).norm() <= 1e-12);
      CHECK(fastest <= 1.5 * 0.2 * body.stabilization.rate * body.stabilization.speed);
      CHECK(simulation.ledger().momentum.norm() <= 1e-10);
    }
}

TEST_CASE("N36: ellipsoids assemble during the run from any place and pose, with bounded speed and spin",
          "[joints][long]") {
  const char* method = GENERATE("rk4", "semi_implicit_euler");
  const int joints = GENERATE(1, 4, 12);
  const double apart = GENERATE(3, 10, 30, 100), h = 2e-3;
  if (joints * apart > 130) return;  // this limits the processor time
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    test::Draws draws(100 * seed + static_cast<std::uint64_t>(joints));
    MultiBody body;
    body.gravity.setZero();
    std::vector<Part*> parts;
    for (int i = 0; i < joints; ++i) {
      Part& part = test::add(body, "part" + std::to_string(i), "ellipsoid", {}, 1000);
      part.rest({{"a1", 0.1}, {"a2", 0.2}, {"a3", 0.5}});
      part.place(apart * draws.vector(1), Eigen::Quaterniond(draws.uniform(0.1, 1), draws.uniform(-1, 1),
                                                             draws.uniform(-1, 1), draws.uniform(-1, 1))
                                              .normalized());
      auto random_point = [&](Part& on) { return point(on, draws.uniform(-1.5, 1.5), draws.uniform(-3, 3)); };
      const Point from = random_point(part);
      body.ball(
          "joint" + std::to_string(i),
          i == 0 ? world(0, 0, 0) : random_point(*parts[static_cast<std::size_t>(draws.integer(0, i - 1))]),
          from);
      parts.push_back(&part);
    }
    Simulation simulation(body, method);
    INFO(method << ", " << joints << " joints from " << apart << ", seed " << seed);
    auto all_closed = [&] {
      return std::all_of(simulation.state().joints.begin(), simulation.state().joints.end(),
                         [](JointMode mode) { return mode == JointMode::closed; });
    };
    double max_turn = 0, max_speed = 0;
    while (simulation.time() < 60 && !all_closed()) {
      simulation.step(h);
      for (int i = 0; i < joints; ++i) {
        max_speed = std::max(max_speed, simulation.state().v.segment<3>(6 * i).norm());
        max_turn = std::max(max_turn, h * simulation.state().v.segment<3>(6 * i + 3).norm());
      }
    }
    CHECK(all_closed());
    CHECK(max_turn <= 1);
    const double cap = 0.1 * body.stabilization.rate * body.stabilization.speed;
    CHECK(max_speed <= 20 * cap * joints);
    double widest = 0;
    for (int j = 0; j < joints; ++j) widest = std::max(widest, gap(simulation, j).norm());
    CHECK(widest <= 1e-10 * 0.1);
  }
}

TEST_CASE("joints to a fixed part act as joints to the world do", "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    VecX<double> q[2];
    for (const bool fixed : {false, true}) {
      MultiBody body;
      Part& post = sphere(body, "post", {0, 0, 0});
      post.fix();
      Part& mass = sphere(body, "mass", {0.6, 0, -0.8});
      Part& hung = sphere(body, "hung", {0.6, 0, -1.7});
      const Point top = fixed ? centre(post) : world(0, 0, 0);
      body.join("rod", Rod{1}, {top, centre(mass)});
      body.join("string", String{1}, {centre(mass), centre(hung)});
      body.join("leash", String{1.8}, {top, centre(hung)});
      Simulation simulation(body, method);
      test::run(simulation, 0.5, 500);
      q[fixed ? 1 : 0] = simulation.state().q;
      CHECK(std::abs(gap(simulation, 0).norm() - 1) <= 1e-12);
    }
    CHECK(q[0] == q[1]);
  }
}

TEST_CASE("a slack string stays slack at time 0, and no impulses are counted while it is taut and at rest",
          "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    Part& mass = sphere(body, "mass", {0, 0, -0.95});
    body.join("string", String{1}, {world(0, 0, 0), centre(mass)});
    Simulation simulation(body, method);
    CHECK(simulation.state().q[2] == -0.95);
    CHECK(simulation.state().joints[0] == JointMode::slack);
    test::run(simulation, 1, 1000);
    INFO(method);
    CHECK(gap(simulation).norm() == Approx(1).epsilon(1e-12));
    CHECK(simulation.step_counters().limit_impulses <= 3);
  }
}

TEST_CASE(
    "without projection a string with its ends too far apart closes, and has no effect once it is slack",
    "[joints]") {
  MultiBody body;
  body.gravity.setZero();
  Part& mass = sphere(body, "mass", {1.3, 0, 0});
  body.join("string", String{1}, {world(0, 0, 0), centre(mass)});
  body.stabilization.projection = false;
  body.stabilization.speed = 1e9;
  Simulation simulation(body, "rk4");
  bool was_slack = false;
  double speed = 0;
  for (int i = 0; i < 2000; ++i) {
    simulation.step(1e-3);
    if (simulation.state().joints[0] == JointMode::slack) {
      if (was_slack) REQUIRE(simulation.state().v[0] == Approx(speed).margin(1e-12));
      was_slack = true;
      speed = simulation.state().v[0];
    }
  }
  CHECK(gap(simulation).norm() <= 1 + 1e-3);
}

TEST_CASE("a parameter that closing joints stretch stops at its limit", "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    body.gravity.setZero();
    Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
    part.rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.5}}).stiffness({{"a3", 1000}}).limits("a3", {0.3, 0.55});
    body.ball("up", world(0, 0, 0.6), point(part, kPi / 2, 0));
    body.ball("down", world(0, 0, -0.6), point(part, -kPi / 2, 0));
    Simulation simulation(body, method);
    for (int i = 0; i < 2000; ++i) {
      simulation.step(1e-3);
      REQUIRE(simulation.state().q[7] <= 0.55);
    }
    INFO(method);
    CHECK(simulation.state().q[7] == Approx(0.55).epsilon(1e-6));
    CHECK(simulation.state().v.norm() <= 1e-3);
    CHECK(simulation.state().joints[0] == JointMode::closing);
    // The energy that the parameter stores at its limit is 1.25 J.
    CHECK(std::abs(simulation.ledger().balance) <= (method[0] == 'r' ? 0.005 : 0.5));
  }
}

// An island is a set of parts that joints connect.
TEST_CASE("islands are independent: alone and beside others they give identical bits", "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    VecX<double> q;
    for (const bool others : {false, true}) {
      MultiBody body;
      chain(body, 3, 0.7);
      if (others) {
        Part& mass = sphere(body, "mass", {5, 0, -0.5});
        body.join("string", String{1}, {world(5, 0, 0), centre(mass)});
        Part& soft = test::add(body, "soft", "ellipsoid", {}, 1000);
        soft.place({9, 0, 0}).rest({{"a3", 0.5}}).initial_rate({{"a3", 3}}).limits("a3", {0.3, 0.55});
        sphere(body, "far", {20, 3, 1});
        body.ball("open", point(*body.find("far"), 0, 0), world(21, 0, 0));
      }
      Simulation simulation(body, method);
      test::run(simulation, 1, 100);
      const VecX<double> ours = simulation.state().q.head(21);
      if (others)
        CHECK(ours == q);
      else
        q = ours;
    }
  }
}

TEST_CASE("the work of closing joints is recorded: the balance does not jump", "[joints]") {
  MultiBody body;
  Part& mass = sphere(body, "mass", {0.2, 0, -1.1});
  body.ball("pin", world(0, 0, 0), point(mass, kPi / 2, 0));
  Simulation simulation(body, "rk4");
  double before = 0;
  for (int i = 0; i < 3000; ++i) {
    simulation.step(1e-3);
    const double now = simulation.ledger().balance;
    REQUIRE(std::abs(now - before) <= 1e-4);
    before = now;
  }
  CHECK(simulation.state().joints[0] == JointMode::closed);
}

TEST_CASE("N42: joints that contradict each other are named with their gap", "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    MultiBody body;
    Part& mass = sphere(body, "mass", {0, 0, 0});
    body.ball("here", world(0, 0, 0), centre(mass));
    body.ball("there", world(1e-4, 0, 0), centre(mass));
    body.ball("else", point(mass, 0, 0), centre(sphere(body, "other", {0.2, 0, 0})));
    try {
      const Simulation simulation(body, method);
      FAIL("the model was not refused");
    } catch (const UnsatisfiableModel& failure) {
      const std::string what = failure.what();
      CHECK(what.find("'here'") != std::string::npos);
      CHECK(what.find("'there'") != std::string::npos);
      CHECK(what.find("0.0001 m") != std::string::npos);
      CHECK(what.find("'else'") == std::string::npos);
    }
  }
}

/// Methods and their tolerances: every method with fixed steps (tolerance 0), and four methods with error
/// control.
const std::vector<std::pair<const char*, double>> kMethods = {{"rk4", 0},
                                                              {"semi_implicit_euler", 0},
                                                              {"linearly_implicit", 0},
                                                              {"implicit_midpoint", 0},
                                                              {"esdirk", 0},
                                                              {"dormand_prince", 0},
                                                              {"dop853", 0},
                                                              {"dormand_prince", 1e-6},
                                                              {"dop853", 1e-6},
                                                              {"esdirk", 1e-6},
                                                              {"auto", 1e-6}};

TEST_CASE("N42: contradictory joints that start far open stop the run, with and without projection",
          "[joints][long]") {
  for (const auto& [method, tolerance] : kMethods)
    for (const bool projected : {true, false})
      for (const double on : {0., 0.1003}) {
        MultiBody body;
        body.stabilization.projection = projected;
        Part& mass = sphere(body, "mass", {0, 0, 0});
        body.ball("here", world(0, 0, 0), centre(mass));
        body.ball("there", world(1, 0, 0), centre(mass)).during(on);
        body.ball("else", point(mass, 0, 0), centre(sphere(body, "other", {0.2, 0, 0})));
        INFO(method << " " << tolerance << " " << projected << " " << on);
        Simulation simulation(body, method, 1, tolerance);
        try {
          for (int i = 0; i < 5000; ++i) simulation.step(1e-3);
          FAIL_CHECK("the run did not stop");
        } catch (const UnsatisfiableModel& failure) {
          const std::string what = failure.what();
          CHECK(what.find("'here'") != std::string::npos);
          CHECK(what.find("'there'") != std::string::npos);
          CHECK(what.find("'else'") == std::string::npos);
          CHECK(simulation.time() >= 0.99);
          CHECK(simulation.time() <= 1.02 + on);
        }
      }
}

TEST_CASE("N42: a string too short for the distance between its fixed ends stops the run", "[joints]") {
  for (const auto& [method, tolerance] : kMethods) {
    MultiBody body;
    Part& mass = sphere(body, "mass", {0, 0, 0});
    body.ball("here", world(0, 0, 0), centre(mass));
    body.join("string", String{0.5}, {world(1, 0, 0), centre(mass)});
    INFO(method << " " << tolerance);
    Simulation simulation(body, method, 1, tolerance);
    try {
      for (int i = 0; i < 5000; ++i) simulation.step(1e-3);
      FAIL("the run did not stop");
    } catch (const UnsatisfiableModel& failure) {
      const std::string what = failure.what();
      INFO(what);
      CHECK(what.find("'string' stays open by 0.5 m") != std::string::npos);
      CHECK(what.find("'here'") != std::string::npos);
      CHECK(simulation.time() == Approx(1).margin(0.01));
    }
  }
}

TEST_CASE("N42: an arm pulled beyond its reach stops the run, and the message names the moving anchor",
          "[joints]") {
  for (const auto& [method, tolerance] : kMethods) {
    MultiBody body;
    const Point shoulder = world(0, 0, 0),
                hand = world({TimeFunction::formula("1.2 + t"), TimeFunction(0), TimeFunction(0)});
    Part &upper = test::add(body, "upper", "box", {}, 1000),
         &lower = test::add(body, "lower", "box", {}, 1000);
    for (Part* arm : {&upper, &lower}) arm->rest({{"a1", 0.02}, {"a2", 0.02}, {"a3", 0.5}});
    const Eigen::Vector3d y(0, 1, 0);
    upper.place({0.3, 0, -0.4}, Eigen::Quaterniond(Eigen::AngleAxisd(kPi - std::asin(0.6), y)));
    lower.place({0.9, 0, -0.4}, Eigen::Quaterniond(Eigen::AngleAxisd(std::asin(0.6), y)));
    body.ball("shoulder", point(upper, -kPi / 2, 0), shoulder);
    body.ball("elbow", point(upper, kPi / 2, 0), point(lower, -kPi / 2, 0));
    body.ball("hand", point(lower, kPi / 2, 0), hand);
    Simulation simulation(body, method, 1, tolerance);
    INFO(method << " " << tolerance);
    try {
      for (int i = 0; i < 2000; ++i) simulation.step(1e-3);
      FAIL_CHECK("the run did not stop");
    } catch (const UnsatisfiableModel& failure) {
      CHECK_THAT(failure.what(), test::has_text("'hand'"));
      CHECK(simulation.time() == Approx(0.8).margin(0.01));
    }
  }
}

TEST_CASE("N42: strings that are too short and pull against each other stop the run", "[joints]") {
  for (const char* method : {"rk4", "semi_implicit_euler"})
    for (const double aside : {0.0, 1e-3, 0.1}) {
      MultiBody body;
      Part& mass = sphere(body, "mass", {0, 0, 0});
      body.join("left", String{0.5}, {world(-1, aside, 0), centre(mass)});
      body.join("right", String{0.5}, {world(1, 0, 0), centre(mass)});
      Simulation simulation(body, method);
      double farthest = 0;
      try {
        for (int i = 0; i < 5000; ++i) {
          simulation.step(1e-3);
          farthest = std::max(farthest, simulation.state().q.head<3>().norm());
        }
        FAIL("the run did not stop");
      } catch (const UnsatisfiableModel& failure) {
        const std::string what = failure.what();
        INFO(what);
        CHECK(what.find("string 'left' stays open by 0.5") != std::string::npos);
        CHECK(what.find("held open by string 'right'") != std::string::npos);
        CHECK(farthest < 0.1 + aside);
      }
    }
}

TEST_CASE("a step that opens joints widely is reported as too long, not as contradictory joints",
          "[joints]") {
  MultiBody body;
  const Part* before = nullptr;
  for (int i = 0; i < 8; ++i) {
    Part& link = test::add(body, "link" + std::to_string(i), "ellipsoid", {}, 1000);
    link.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).place({0.3 + 0.6 * i, 0, 0});
    body.ball("joint" + std::to_string(i), before == nullptr ? world(0, 0, 0) : point(*before, 0, 0),
              point(link, 0, kPi));
    before = &link;
  }
  Simulation simulation(body, "rk4");
  try {
    for (int i = 0; i < 100; ++i) simulation.step(0.3);
    FAIL("the run did not stop");
  } catch (const NumericalFailure& failure) {
    CHECK(std::string(failure.what()).find("too long") != std::string::npos);
  }
}

TEST_CASE("a joint quantity that is not finite is named", "[joints]") {
  MultiBody body;
  Part& mass = sphere(body, "mass", {0, 0, 0});
  body.ball("hand", world({TimeFunction::formula("sqrt(0.01 - t)"), 0, 0}), centre(mass));
  Simulation simulation(body, "rk4");
  try {
    for (int i = 0; i < 100; ++i) simulation.step(1e-3);
    FAIL("the run did not stop");
  } catch (const NumericalFailure& failure) {
    CHECK(std::string(failure.what()).find("the anchor of ball 'hand'") != std::string::npos);
  }
}

}  // namespace joints_test
