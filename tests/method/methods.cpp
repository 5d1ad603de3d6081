// All methods of integration: their orders on smooth problems with and without joints, at several times of a
// run; the invariants of the implicit midpoint rule; the step lengths of the stiff method, ESDIRK.
// N17, N18 and N21 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <cmath>
#include <functional>
#include <string>
#include <utility>

#include <pliant/method/integrator.h>
#include <pliant/part/local/local_laws.h>

#include "motion.h"

namespace methods_test {

using namespace pliant;

namespace {

/// A test problem. end: duration of its run, s.
struct Problem {
  const char* name;
  std::function<void(MultiBody&)> build;
  double end;
  int steps;  ///< number of steps; each method uses a multiple or a fraction, by its order
};

/// Adds two stretching links; the second link hangs from the first link.
void soft_pendulum(MultiBody& body) {
  Part* before = nullptr;
  for (int i = 0; i < 2; ++i) {
    Part& link = body.add<Primitive<Ellipsoid>>("link" + std::to_string(i));
    link.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).stiffness({{"a1", 2e4}, {"a2", 2e4}, {"a3", 2e4}});
    link.place({0.3 + 0.6 * i, 0, 0}, Eigen::Quaterniond(Eigen::AngleAxisd(0.7 * i, Vec3<double>::UnitX())));
    body.ball("joint" + std::to_string(i), before == nullptr ? world(0, 0, 0) : point(*before, 0, 0),
              point(link, 0, kPi));
    before = &link;
  }
}

/// Adds a body on a damped spring from its surface to a point of the world.
void on_spring(MultiBody& body) {
  Part& part = body.add<Primitive<Ellipsoid>>("body");
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).velocity({0.5, 0, 0}, {1, 2, 0.5});
  body.spring("spring", point(part, 0.4, 0.3), world(0, 0, 1), 500, 5, 0.5);
}

/// Adds bodies in a row, each connected to the previous one by another type of joint: a hinge (to the world),
/// a slider, a plane, a line and a weld.
void row_of_joints(MultiBody& body) {
  auto at = [](Part& part, const Vec3<double>& x) {
    part.prepare();
    return point(part, part.label(part.R0().conjugate() * (x - part.c0()), part.parameters().rest()));
  };
  Part* before = nullptr;
  for (const char* type : {"hinge", "slider", "plane", "line", "weld"}) {
    const double along = 0.3 * static_cast<double>(body.parts().size());
    Part& part = body.add<Primitive<Ellipsoid>>(std::string("part on a ") + type);
    part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}});
    part.place({along, 0, 0}, Eigen::Quaterniond(1, 0.2 * along, 0.1, 0.05).normalized());
    const Vec3<double> x(along - 0.15, 0.05, 0.02);
    JointSetting setting{at(part, x), before == nullptr ? world(x[0], x[1], x[2]) : at(*before, x)};
    setting.axis = {0.3, 1, 0.2};
    body.join(type, type, setting);
    before = &part;
  }
}

/// Adds links on ball joints in a ring. A ball joint connects one corner with the world.
void ring(MultiBody& body) {
  constexpr int n = 5;
  std::vector<Part*> links;
  for (int i = 0; i < n; ++i) {
    const double angle = 2 * kPi * i / n, radius = 0.3 / std::tan(kPi / n);
    Part& link = body.add<Primitive<Ellipsoid>>("link" + std::to_string(i));
    link.rest({{"a1", 0.3}, {"a2", 0.1}, {"a3", 0.1}});
    link.place({radius * std::cos(angle), 0, radius * std::sin(angle)},
               Eigen::Quaterniond(Eigen::AngleAxisd(-angle - kPi / 2, Vec3<double>::UnitY())));
    links.push_back(&link);
  }
  for (int i = 0; i < n; ++i)
    body.ball("joint" + std::to_string(i), point(*links[static_cast<std::size_t>(i)], 0, 0),
              point(*links[static_cast<std::size_t>((i + 1) % n)], 0, kPi));
  const double top = 0.3 / std::sin(kPi / n);
  body.ball("nail", point(*links[0], 0, kPi), world(top * std::cos(-kPi / n), 0, top * std::sin(-kPi / n)));
}

/// Adds a spinning rubber shell under pressure, with an initial velocity that shears it.
void shell(MultiBody& body) {
  auto& part = body.add<Primitive<Ellipsoid>>("shell", 1.0);
  part.make_shell().rest({{"a1", 0.1}, {"a2", 0.08}, {"a3", 0.12}}).velocity({0, 0, 0}, {2, 1, -3});
  LocalSettings settings;
  settings.resolution = 1;
  settings.energies = {local_law("neo_hookean_membrane", {2e4, 0.5, 1e-3}), local_law("pressure", {20})};
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return {X[1], 3 * X[0], 0}; };
  part.deform_locally(settings);
}

const std::vector<Problem> kProblems{
    {"a free solid of many parameters", [](MultiBody& body) { test::tumbling_solid(body); }, 0.08, 16},
    {"stretching links on ball joints", soft_pendulum, 0.2, 16},
    {"a body on a spring", on_spring, 0.8, 16},
    {"bodies on a hinge, a slider, a plane, a line and a weld", row_of_joints, 0.8, 16},
    {"a ring of links", ring, 0.4, 16},
    {"a rubber shell", shell, 0.04, 16}};

/// States and joint forces at the ends of the four quarters of a run.
struct Samples {
  VecX<double> q, v, lambda;
};
/// Simulates a problem with fixed steps, or with a tolerance if it is positive.
Samples sample_run(const Problem& problem, const std::string& method, int steps, double tolerance = 0) {
  MultiBody body;
  problem.build(body);
  Simulation simulation(body, method, 1, tolerance);
  Samples samples;
  const Eigen::Index n_q = simulation.state().q.size(), n_v = simulation.state().v.size();
  samples.q.resize(4 * n_q);
  samples.v.resize(4 * n_v);
  for (int quarter = 0; quarter < 4; ++quarter) {
    if (tolerance > 0)
      simulation.step(problem.end / 4);
    else
      for (int i = 0; i < steps / 4; ++i) simulation.step(problem.end / steps);
    samples.q.segment(quarter * n_q, n_q) = simulation.state().q;
    samples.v.segment(quarter * n_v, n_v) = simulation.state().v;
    Workspace<double> work;
    const State& now = simulation.state();
    simulation.dynamics().accelerations(now.time(), now.q, now.v, now, work);
    const Eigen::Index n = work.joints.lambda.size();
    samples.lambda.conservativeResize(4 * n);
    samples.lambda.segment(quarter * n, n) = work.joints.lambda;
  }
  return samples;
}

}  // namespace

TEST_CASE("every method has its order on smooth motion, free, with joints and with springs",
          "[methods][long]") {
  for (const Problem& problem : kProblems) {
    const Samples exact = sample_run(problem, "dop853", 64 * problem.steps);
    for (const IntegratorInfo& method : all_integrators()) {
      CAPTURE(problem.name, method.name);
      const int first = method.order >= 8   ? problem.steps / 4
                        : method.order == 5 ? 2 * problem.steps
                        : method.order == 4 ? 4 * problem.steps
                                            : 8 * problem.steps;
      std::vector<double> q, v, lambda;
      for (int halving = 0; halving < 3; ++halving) {
        const Samples at = sample_run(problem, method.name, first << halving);
        q.push_back((at.q - exact.q).norm());
        v.push_back((at.v - exact.v).norm());
        if (exact.lambda.size() > 0) lambda.push_back((at.lambda - exact.lambda).norm());
      }
      const double min_order = method.order >= 8 ? method.order - 0.5 : method.order - 0.1;
      CAPTURE(q, v, lambda);
      CHECK(test::observed_order(q) > min_order);
      CHECK(test::observed_order(v) > min_order);
      // Forces show the order only at small steps, so only the last two errors are compared.
      if (!lambda.empty()) CHECK(std::log2(lambda[1] / lambda[2]) > min_order);
    }
  }
}

TEST_CASE("methods of different kinds agree at the end of a run", "[methods]") {
  for (const Problem& problem : kProblems) {
    CAPTURE(problem.name);
    const Samples exact = sample_run(problem, "dop853", 0, 1e-12);
    for (const char* method : {"dormand_prince", "esdirk"}) {
      const Samples other = sample_run(problem, method, 0, 1e-9);
      CHECK((other.q - exact.q).norm() < 1e-6);
    }
  }
}

namespace {

/// Returns the largest relative change of the energy or of the angular momentum of a tumbling free box. The
/// box is integrated by the implicit midpoint rule in steps of 0.01 s.
double drift(long steps) {
  MultiBody body;
  body.gravity.setZero();
  body.add<Primitive<Box>>("box")
      .rest({{"a1", 0.1}, {"a2", 0.2}, {"a3", 0.3}})
      .velocity({0, 0, 0}, {1, 2, 3});
  Simulation simulation(body, "implicit_midpoint");
  const Ledger start = simulation.ledger();
  const double L = start.angular_momentum.norm();
  double drift = 0;
  for (long i = 1; i <= steps; ++i) {
    simulation.step(0.01);
    if (i % 100 != 0) continue;
    const Ledger now = simulation.ledger();
    drift = std::max(
        {drift, std::abs(now.kinetic / start.kinetic - 1), std::abs(now.angular_momentum.norm() / L - 1)});
  }
  return drift;
}

}  // namespace

TEST_CASE("N17, N18: the implicit midpoint rule keeps energy and angular momentum of a free box bounded",
          "[methods]") {
  CHECK(drift(20000) < 1e-12);
}

TEST_CASE("N18: the implicit midpoint rule keeps energy and angular momentum bounded over a million steps",
          "[methods][long]") {
  CHECK(drift(1000000) < 1e-11);
}

TEST_CASE("N18: a box that spins about its middle axis flips at the times of Jacobi's elliptic functions",
          "[methods]") {
  // The time between two flips is 2 K(k) / p (Landau and Lifshitz, Mechanics, section 37).
  const Vec3<double> omega(0.01, 3, 0.02);
  auto build = [&](MultiBody& body) -> Part& {
    body.gravity.setZero();
    return body.add<Primitive<Box>>("box")
        .rest({{"a1", 0.1}, {"a2", 0.2}, {"a3", 0.3}})
        .velocity({0, 0, 0}, omega);
  };
  MultiBody model;
  Part& box = build(model);
  box.prepare();
  const Vec3<double> I = box.rest_inertia().M.diagonal().tail<3>(), L = I.cwiseProduct(omega);
  const double twice_E = L.dot(omega), M2 = L.squaredNorm();
  REQUIRE((I[0] > I[1] && I[1] > I[2]));
  const bool about_largest = M2 > twice_E * I[1];
  const double largest = about_largest ? I[0] : I[2], smallest = about_largest ? I[2] : I[0];
  const double p = std::sqrt((largest - I[1]) * (M2 - twice_E * smallest) / (I[0] * I[1] * I[2])),
               k = std::sqrt((I[1] - smallest) * (twice_E * largest - M2) /
                             ((largest - I[1]) * (M2 - twice_E * smallest)));
  const double flip_time = 2 * std::comp_ellint_1(k) / p;
  // Returns the mean time between flips, and the relative change of the energy.
  auto measure = [&](const char* method, double h, int times) {
    MultiBody body;
    build(body);
    Simulation simulation(body, method);
    const double kinetic = simulation.ledger().kinetic;
    double first = 0, last = 0, before = omega[1];
    for (int found = 0; found <= times;) {
      simulation.step(h);
      const double now = simulation.state().v[4];
      if (now * before < 0) {
        last = simulation.time() - h * now / (now - before);
        if (found == 0) first = last;
        ++found;
      }
      before = now;
    }
    return std::pair((last - first) / times, std::abs(simulation.ledger().kinetic / kinetic - 1));
  };
  CHECK(measure("dop853", 2e-3, 10).first == Approx(flip_time).epsilon(1e-7));
  const double coarse = measure("implicit_midpoint", 1e-2, 200).first / flip_time - 1,
               fine = measure("implicit_midpoint", 5e-3, 200).first / flip_time - 1;
  CAPTURE(flip_time, coarse, fine);
  CHECK(std::abs(coarse) < 1e-3);
  CHECK(std::log2(coarse / fine) == Approx(2).margin(0.1));
  CHECK(measure("implicit_midpoint", 1e-2, 200).second < 1e-12);
}

TEST_CASE("N21: implicit methods are stable for any stiffness: no growth, and the L-stable method damps",
          "[methods]") {
  for (const double stiffness : {1e4, 1e8, 1e12}) {
    for (const char* method : {"implicit_midpoint", "esdirk"}) {
      CAPTURE(stiffness, method);
      MultiBody body;
      body.gravity.setZero();
      Part& part = body.add<Primitive<Sphere>>("ball");
      part.rest({{"r", 0.2}}).stiffness({{"r", stiffness}}).initial({{"r", 0.201}});
      Simulation simulation(body, method);
      double largest = 0;
      for (int i = 0; i < 200; ++i) {
        simulation.step(0.01);
        largest = std::max(largest, std::abs(simulation.state().q[7] - 0.2));
      }
      CHECK(largest <= 1.0001e-3);
      if (stiffness >= 1e8 && std::string(method) == "esdirk")
        CHECK(std::abs(simulation.state().q[7] - 0.2) < 1e-6);
    }
  }
}

TEST_CASE("the number of steps of the stiff method does not grow with the stiffness", "[methods]") {
  // An ellipsoid that spins, or swings on a ball joint, with increasing stiffness and damped vibrations.
  struct Run {
    long steps;
    VecX<double> q;
  };
  auto run = [](double stiffness, bool jointed, double tolerance) {
    MultiBody body;
    Part& part = body.add<Primitive<Ellipsoid>>("body");
    part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}});
    part.stiffness({{"a1", stiffness}, {"a2", stiffness}, {"a3", stiffness}}).damping(0, 1e-3);
    part.velocity({0, 0, 0}, {1, 2, 3});
    if (jointed) body.ball("joint", world(0.3, 0, 0), point(part, 0, 0));
    Simulation simulation(body, "esdirk", 1, tolerance);
    while (simulation.time() < 1) simulation.step_up_to(1);
    return Run{simulation.step_counters().steps, simulation.state().q};
  };
  for (const bool jointed : {false, true}) {
    const long softest = run(1e6, jointed, 1e-5).steps;
    for (const double stiffness : {1e7, 1e8, 1e9, 1e10, 1e11, 1e12}) {
      CAPTURE(jointed, stiffness);
      const Run now = run(stiffness, jointed, 1e-5);
      CHECK(now.steps <= softest);
      if (stiffness == 1e12) CHECK((now.q - run(stiffness, jointed, 1e-7).q).norm() < 3e-5);
    }
  }
}

TEST_CASE("implicit methods integrate stiff links that rotate relative to each other", "[methods]") {
  // In the limit of infinite stiffness the links are rigid.
  auto build = [](MultiBody& body, double stiffness) {
    soft_pendulum(body);
    for (const auto& part : body.parts()) {
      if (stiffness > 0)
        part->stiffness({{"a1", stiffness}, {"a2", stiffness}, {"a3", stiffness}}).damping(0, 1e-3);
      else
        part->freeze({"a1", "a2", "a3"});
    }
  };
  MultiBody rigid;
  build(rigid, 0);
  Simulation exact(rigid, "dop853", 1, 1e-9);
  exact.step(0.2);
  for (const char* method : {"implicit_midpoint", "esdirk"})
    for (const double stiffness : {1e10, 1e12}) {
      CAPTURE(method, stiffness);
      MultiBody body;
      build(body, stiffness);
      Simulation simulation(body, method);
      test::run(simulation, 0.2, 40);
      for (const Eigen::Index q0 : {0, 10})
        CHECK((simulation.state().q.segment<7>(q0) - exact.state().q.segment<7>(q0 == 0 ? 0 : 7)).norm() <
              (std::string(method) == "esdirk" ? 2e-6 : 1e-3));
    }
}

TEST_CASE("implicit methods integrate stiff parts that a torque rotates relative to each other",
          "[methods]") {
  auto pair = [](MultiBody& body, double stiffness) {
    body.gravity.setZero();
    for (int i = 0; i < 2; ++i) {
      Part& part = body.add<Primitive<Ellipsoid>>("part" + std::to_string(i));
      part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}})
          .place({0.6 * i, 0, 0})
          .velocity({0, 1.0 * i, 0}, {1, 2, 3});
      if (stiffness > 0)
        part.stiffness({{"a1", stiffness}, {"a2", stiffness}, {"a3", stiffness}}).damping(0, 1e-3);
    }
    body.torque("motor", *body.parts()[0], {1, 2, 3}, Frame::body).against = body.parts()[1].get();
  };
  MultiBody rigid;
  pair(rigid, 0);
  Simulation exact(rigid, "dop853", 1, 1e-9);
  exact.step(0.5);
  for (const char* method : {"implicit_midpoint", "esdirk"})
    for (const double stiffness : {1e10, 1e12}) {
      CAPTURE(method, stiffness);
      MultiBody body;
      pair(body, stiffness);
      Simulation simulation(body, method);
      const Vec3<double> L = simulation.ledger().angular_momentum;
      test::run(simulation, 0.5, 100);
      for (const Eigen::Index q0 : {0, 10})
        CHECK((simulation.state().q.segment<7>(q0) - exact.state().q.segment<7>(q0 == 0 ? 0 : 7)).norm() <
              (std::string(method) == "esdirk" ? 1e-7 : 1e-4));
      CHECK((simulation.ledger().angular_momentum - L).norm() < 1e-6 * L.norm());
      CHECK(simulation.step_counters().factorisations == 100);  // one matrix in each step for both parts
    }
}

TEST_CASE("the projection of stiff links onto their joints does not change their momentum", "[methods]") {
  for (const char* method : {"implicit_midpoint", "esdirk"}) {
    MultiBody body;
    body.gravity.setZero();
    Part* links[2];
    for (int i = 0; i < 2; ++i) {
      Part& link = body.add<Primitive<Ellipsoid>>("link" + std::to_string(i));
      link.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).stiffness({{"a1", 1e8}, {"a2", 1e8}, {"a3", 1e8}});
      link.place({0.6 * i, 0, 0}).velocity({0, 1.0 + i, 0.5}, {1, 2, 3});
      links[i] = &link;
    }
    body.ball("joint", point(*links[0], 0, 0), point(*links[1], 0, kPi));
    std::vector<double> angular_change;
    for (const int steps : {20, 40}) {
      CAPTURE(method, steps);
      Simulation simulation(body, method);
      const Vec3<double> P = simulation.ledger().momentum, L = simulation.ledger().angular_momentum;
      test::run(simulation, 0.1, steps);
      CHECK((simulation.ledger().momentum - P).norm() < 1e-12 * P.norm());
      angular_change.push_back((simulation.ledger().angular_momentum - L).norm() / L.norm());
    }
    CAPTURE(method, angular_change);
    CHECK(angular_change[1] < 1e-6);
    CHECK(angular_change[1] < 0.3 * angular_change[0]);
  }
}

}  // namespace methods_test
