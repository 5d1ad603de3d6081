// Accelerations, their directional derivatives, the ledger and the hash of a state, and models that are
// refused.
// N61 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <Eigen/LU>

#include <pliant/body/actuation/named_signal.h>
#include <pliant/part/local/local_laws.h>

#include "differences.h"
#include "draws.h"
#include "motion.h"
#include "worst.h"

namespace dynamics_test {

using namespace pliant;
using test::Draws;

namespace {

/// Adds two deforming parts and a fixed part, with all kinds of loads.
void busy_scene(MultiBody& body) {
  Part& a = test::tumbling_solid(body, "a");
  body.gravity = {0.3, -1, -9.81};
  a.damping(0.4, 0.02, 0.1);
  a.rest("twist.angle", test::wave(0.3, 0.2, 5));
  Part& b = test::add(body, "b", "box", {"taper"}, 800);
  b.rest({{"a1", 0.2}, {"a2", 0.3}, {"a3", 0.4}}).stiffness({{"a1", 3e4}, {"taper.tx", 100}});
  b.stiffness({"a2", "a3"}, (MatX<double>(2, 2) << 3e4, 4e3, 4e3, 2e4).finished()).damping(0, 0.03);
  b.place({1.5, 0.3, 0.2}, Eigen::Quaterniond(0.5, 0.5, -0.1, 0.6)).velocity({0, 0.4, 0}, {-1, 0.5, 2});
  Part& fixed = test::add(body, "post", "cylinder", {}, 1000);
  fixed.place({-1, 0, 0}).fix();
  body.spring("tie", point(a, 0.5, 0.3), point(b, -0.4, 1, 0.7), 800, 12, 0.6);
  body.spring("link", point(a, -0.2, 2), point(fixed, 0, 0), 500, 5);
  body.spring("hand", world({test::wave(0.5, 0.3, 4), 0.2, test::wave(0.1, 0.2, 3, 1)}), point(b, 1.2, -2),
              600, 8, 0.3);
  body.force("push", point(b, 0.3, 0.3), TimeVector(test::wave(10, 20, 6), 5, 0));
  body.force("jet", point(a, -0.7, 1), TimeVector(3, test::wave(0, 30, 5), 8), Frame::body);
  body.force("own", point(a, 0.9, -1), [](double t, const Vec3<double>& x, const Vec3<double>& v) {
    return Vec3<double>(std::sin(3 * t) - x[0], -0.4 * v[1], 2 * x[2]);
  });
  const auto& on_surface = quantities_at_points(DistributedForce::Domain::surface);
  auto formula = [&](const char* text) { return state_formula(body, text, {}, on_surface); };
  body.surface_force("wind", a,
                     {formula("3 * (1 - vx) * abs(nz)"), formula("b.z - y"), formula("40 * X * x")},
                     formula("200 * smoothstep(-2, 2, z) + 5 * b.vx"))
      .resolution = 2;
  body.body_force("field", b, {formula("-4 * x * y"), formula("2 * vz"), StateFunction(0.3)});
  body.torque("turn", b, TimeVector(1, test::wave(2, 3, 4), 0));
  body.torque("spin", a, TimeVector(0, 2, test::wave(0, 4, 5)), Frame::body);
  body.torque("muscle", b, TimeVector(1, 0, test::wave(3, 2, 4)), Frame::body).against = &a;
  body.torque("motor", a, TimeVector(test::wave(0, 5, 2), 1, 0)).against = &fixed;
}

}  // namespace

TEST_CASE("directional derivatives of the accelerations agree with finite differences, and are linear",
          "[dynamics]") {
  MultiBody body;
  busy_scene(body);
  // The directional derivative (Dynamics::jvp) treats user-defined forces as constant.
  MultiBody without;
  busy_scene(without);
  for (const auto& force : without.forces())
    if (force->custom)
      force->custom = [](double, const Vec3<double>&, const Vec3<double>&) { return Vec3<double>(1, 2, 3); };
  const Simulation simulation(without, "rk4");
  const Dynamics& dynamics = simulation.dynamics();
  const State& state = simulation.state();
  Draws draws(1);
  Workspace<double> work, scratch;
  Workspace<Dual<1>> dual;
  const double t = 0.3;
  dynamics.accelerations(t, state.q, state.v, state, work);
  auto random = [&](Eigen::Index n, double size) {
    VecX<double> x(n);
    for (Eigen::Index i = 0; i < n; ++i) x[i] = draws.uniform(-size, size);
    return x;
  };
  for (int trial = 0; trial < 10; ++trial) {
    const VecX<double> dq = random(state.q.size(), 0.1), dv = random(state.v.size(), 1);
    const VecX<double> derivative = dynamics.jvp(t, state.q, state.v, {dq, dv}, work, dual);
    const VecX<double> expected =
        test::first_derivative(
            [&](long double e) {
              const double k = static_cast<double>(e);
              dynamics.accelerations(t, state.q + k * dq, state.v + k * dv, state, scratch);
              return VecX<long double>(scratch.v_dot.cast<long double>());
            },
            1e-3L)
            .cast<double>();
    CHECK((derivative - expected).norm() <= 1e-6 * expected.norm());
    const VecX<double> dq2 = random(state.q.size(), 0.1), dv2 = random(state.v.size(), 1);
    const VecX<double> sum =
        dynamics.jvp(t, state.q, state.v, {2 * dq - 3 * dq2, 2 * dv - 3 * dv2}, work, dual);
    const VecX<double> parts = 2 * derivative - 3 * dynamics.jvp(t, state.q, state.v, {dq2, dv2}, work, dual);
    CHECK((sum - parts).norm() <= 1e-12 * (parts.norm() + derivative.norm()));
  }
}

TEST_CASE("coordinate rates rotate quaternions with the angular velocity in the body frame", "[dynamics]") {
  MultiBody body;
  busy_scene(body);
  const Simulation simulation(body, "rk4");
  VecX<double> q_dot;
  simulation.dynamics().coordinate_rates(simulation.state().q, simulation.state().v, q_dot);
  const VecX<double>& q = simulation.state().q;
  const Eigen::Quaterniond R(q[3], q[4], q[5], q[6]);
  const Vec3<double> omega = simulation.state().v.segment<3>(3);
  const Eigen::Quaterniond rate = R * Eigen::Quaterniond(0, omega[0] / 2, omega[1] / 2, omega[2] / 2);
  CHECK((q_dot.segment<4>(3) - Vec<double, 4>(rate.w(), rate.x(), rate.y(), rate.z())).norm() <= 1e-15);
  CHECK(q_dot.segment<3>(0) == simulation.state().v.segment<3>(0));
}

TEST_CASE("free fall: the frame of a part has the acceleration of gravity, and no other velocity changes",
          "[dynamics]") {
  MultiBody body;
  Part& part = test::add(body, "part", "ellipsoid", {"taper", "bend"}, 1000);
  part.rest({{"a1", 0.3}, {"a2", 0.3}, {"bend.angle", 0.8}, {"taper.tx", 0.4}});
  part.make_dynamic({"a1", "a3", "taper.tx", "bend.angle"});
  part.place({0, 0, 5}, Eigen::Quaterniond(0.6, 0.3, -0.4, 0.2));
  Simulation simulation(body, "rk4");
  Workspace<double> work;
  simulation.dynamics().accelerations(0, simulation.state().q, simulation.state().v, simulation.state(),
                                      work);
  CHECK((work.v_dot.head<3>() - Vec3<double>(0, 0, -9.81)).norm() <= 1e-12);
  CHECK(work.v_dot.tail(work.v_dot.size() - 3).norm() <= 1e-11);
}

TEST_CASE("point forces: F = m a of the centre of mass, and the torque about it changes the angular momentum",
          "[dynamics]") {
  MultiBody body;
  body.gravity.setZero();
  Part& part = test::add(body, "part", "cone", {}, 1000);
  part.rest({{"a1", 0.3}, {"a2", 0.4}, {"a3", 0.7}})
      .place({0, 0, 0}, Eigen::Quaterniond(0.6, 0.3, -0.4, 0.2));
  const Vec3<double> F(3, -2, 5);
  const Material<double> where = material_at(0.4, 1.1);
  body.force("F", point(part, where), TimeVector(F));
  Simulation simulation(body);
  Workspace<double> work;
  simulation.dynamics().accelerations(0, simulation.state().q, simulation.state().v, simulation.state(),
                                      work);
  const Mat3<double> R = part.R0().toRotationMatrix();
  const Inertia<double>& I = part.rest_inertia();
  const Vec3<double> centre = I.moment / I.mass, alpha = work.v_dot.tail<3>();
  const Vec3<double> a_centre = work.v_dot.head<3>() + R * alpha.cross(centre);
  CHECK((a_centre - F / I.mass).norm() <= 1e-12 * F.norm() / I.mass);
  const Mat3<double> about_centre =
      Mat3<double>(I.M.bottomRightCorner<3, 3>()) -
      I.mass * (centre.squaredNorm() * Mat3<double>::Identity() - centre * centre.transpose());
  const Vec3<double> p = part.s({where}, part.parameters().rest()).col(0);
  const Vec3<double> torque = (p - centre).cross(R.transpose() * F);
  CHECK((about_centre * alpha - torque).norm() <= 1e-12 * torque.norm());
}

TEST_CASE("a torque between two parts conserves their momenta, and its power is the sum over both parts",
          "[dynamics]") {
  const TimeVector torque(20, test::wave(10, 20, 3), 30);
  for (const bool rigid : {false, true})
    for (const Frame frame : {Frame::world, Frame::body}) {
      CAPTURE(rigid, frame == Frame::world);
      MultiBody body;
      body.gravity.setZero();
      Part& a = test::add(body, "a", "ellipsoid", {}, 1000);
      a.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.25}}).velocity({0.2, 0.3, 0.1}, {0, 0, 0});
      Part& b = test::add(body, "b", "ellipsoid", {}, 1000);
      b.rest({{"a1", 0.2}, {"a2", 0.3}, {"a3", 0.4}}).place({0.5, 0, 0}).velocity({0.2, 0.3, 0.1}, {0, 0, 0});
      if (rigid) {
        // A ball joint makes these parts a rigid island, which has a specialised evaluation.
        body.ball("hold", point(a, 0, 0), point(b, 0, kPi));
      } else {
        a.stiffness({{"a1", 1e5}});
        body.hinge("hold", point(a, 0, 0), point(b, 0, kPi), {0, 0.6, 0.8});
      }
      Torque& muscle = body.torque("muscle", a, torque, frame);
      auto change = [&](const Part* against) {
        muscle.against = against;
        Simulation simulation(body, "dop853");
        CHECK(simulation.model().rigid_islands().size() == (rigid ? 1 : 0));
        const Ledger start = simulation.ledger();
        test::run(simulation, 0.5, 500);
        const Ledger end = simulation.ledger();
        CHECK((end.momentum - start.momentum).norm() <= 1e-12 * start.momentum.norm());
        CHECK(std::abs(end.work[static_cast<int>(Work::forces)]) > 1e-2 * start.kinetic);
        CHECK(std::abs(end.balance) <= 1e-11 * start.kinetic);

        const State& state = simulation.state();
        Workspace<double> work;
        simulation.dynamics().accelerations(simulation.time(), state.q, state.v, state, work);
        auto omega = [&](int i) {
          const int v0 = simulation.model().parts()[static_cast<std::size_t>(i)].v0;
          return Vec3<double>(simulation.model().orientation(state, i) * state.v.segment<3>(v0 + 3));
        };
        Vec3<double> in_world = torque.value(simulation.time());
        if (frame == Frame::body) in_world = simulation.model().orientation(state, 0) * in_world;
        const double power = in_world.dot(omega(0) - (against == nullptr ? Vec3<double>(0, 0, 0) : omega(1)));
        CHECK(work.power[static_cast<int>(Work::forces)] == Approx(power).epsilon(1e-12));
        return (end.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm();
      };
      CHECK(change(&b) <= 1e-12);
      CHECK(change(nullptr) > 1e-1);
    }
}

TEST_CASE(
    "a torque with its reaction on a fixed part is an external torque; a reaction on the same part is "
    "refused",
    "[dynamics]") {
  for (const Frame frame : {Frame::world, Frame::body}) {
    MultiBody body;
    Part& part = test::add(body, "part", "box", {}, 1000);
    part.rest({{"a1", 0.2}, {"a2", 0.3}, {"a3", 0.4}}).velocity({0, 0, 0}, {1, 2, 3});
    Part& post = test::add(body, "post", "cylinder", {}, 1000);
    post.place({1, 0, 0}, Eigen::Quaterniond(0.5, 0.5, -0.1, 0.6)).fix();
    Torque& torque = body.torque("turn", part, TimeVector(1, 2, 3), frame);
    auto end = [&] {
      Simulation simulation(body, "rk4");
      test::run(simulation, 0.1, 10);
      CHECK(std::abs(simulation.ledger().balance) < 1e-6);
      return hash(simulation.state());
    };
    const auto external = end();
    torque.against = &post;
    CHECK(end() == external);
    // Now the opposite torque acts on the fixed part, and its reaction on the moving part. With Frame::body
    // the components of the torque are along the axes of the fixed part.
    torque.part = &post;
    torque.against = &part;
    torque.torque = TimeVector(Vec3<double>(-1, -2, -3));
    if (frame == Frame::world) CHECK(end() == external);
    torque.against = &post;
    CHECK_THROWS_WITH(Model(body), "torque 'turn' acts on part 'post' against itself");
  }
}

TEST_CASE("the ledger of a state: energies and momenta agree with their definitions", "[dynamics]") {
  MultiBody body;
  busy_scene(body);
  Simulation simulation(body);
  const Ledger ledger = simulation.ledger();
  const State& state = simulation.state();
  // Sums over the mass points, in the world frame.
  double kinetic = 0, gravity = 0;
  Vec3<double> P = Vec3<double>::Zero(), L = Vec3<double>::Zero();
  for (int i = 0; i < 2; ++i) {
    const PartModel& m = simulation.model().parts()[static_cast<std::size_t>(i)];
    const Vec3<double> c = simulation.model().position(state, i), c_dot = state.v.segment<3>(m.v0);
    const Mat3<double> R = simulation.model().orientation(state, i).toRotationMatrix();
    const Vec3<double> omega = state.v.segment<3>(m.v0 + 3);
    const MassPoints& points = m.part->mass_points();
    for (std::size_t k = 0; k < points.at.size(); ++k)
      for (int lane = 0; lane < Pack::kLanes; ++lane) {
        auto take = [lane](const Trig<Pack>& t) {
          return Trig<double>{t.x[lane], t.sign[lane], t.log_abs[lane]};
        };
        const Material<Pack>& four = points.at[k];
        std::vector<PointJet<double>> jet;
        Counters counters;
        m.part->points({{take(four.cu), take(four.su), take(four.cv), take(four.sv), four.w[lane]}},
                       state.q.segment(m.q0 + 7, m.n_s), state.v.segment(m.v0 + 6, m.n_s), jet, counters);
        const double mass = points.mass[k][lane];
        const Vec3<double> x = c + R * jet[0].p, v = c_dot + R * (omega.cross(jet[0].p) + jet[0].p1);
        kinetic += 0.5 * mass * v.squaredNorm();
        gravity -= mass * body.gravity.dot(x);
        P += mass * v;
        L += mass * x.cross(v);
      }
  }
  CHECK(ledger.kinetic == Approx(kinetic).epsilon(1e-12));
  CHECK(ledger.gravity == Approx(gravity).epsilon(1e-12));
  CHECK((ledger.momentum - P).norm() <= 1e-12 * P.norm());
  CHECK((ledger.angular_momentum - L).norm() <= 1e-12 * L.norm());
  CHECK(ledger.balance == 0);
}

TEST_CASE("N61: a spring of zero length exerts a finite force", "[dynamics]") {
  for (double rest_length : {0.0, 0.5}) {
    MultiBody body;
    body.gravity.setZero();
    auto& part = body.add<Primitive<Sphere>>("ball", 1000);
    body.spring("spring", point(part, 0, 0, 0), world(0, 0, 0), 100, 3, rest_length);
    Simulation simulation(body, "rk4");
    test::run(simulation, 0.1, 10);
    CHECK(simulation.state().q.head<3>().norm() == 0);
  }
}

TEST_CASE("names of coordinates and velocities", "[dynamics]") {
  MultiBody body;
  busy_scene(body);
  const Model model(body);
  CHECK(model.coordinate_name(0) == "a.c.x");
  CHECK(model.coordinate_name(3) == "a.quat.w");
  CHECK(model.coordinate_name(10) == "a.taper.tx");
  CHECK(model.velocity_name(5) == "a.omega.z");
  CHECK(model.velocity_name(9) == "a.taper.tx_dot");
  CHECK(model.coordinate_name(17) == "b.c.x");
  CHECK_THROWS_AS(model.coordinate_name(model.n_q()), std::out_of_range);
}

TEST_CASE("invalid models are refused, and the message names the part or load", "[dynamics]") {
  using test::has_text;
  MultiBody body;
  Part& part = test::add(body, "p", "box", {}, 1000);
  CHECK_THROWS_WITH(test::add(body, "p", "box", {}, 1000), has_text("two parts called 'p'"));
  CHECK_THROWS_WITH(test::add(body, "", "box", {}, 1000), has_text("needs a name"));
  CHECK_THROWS_WITH(body.spring("s", point(part, 0, 0), world(0, 0, 0), -1), has_text("spring 's'"));
  const std::unique_ptr<Part> stranger = make_part("stranger", "box", {}, 1000);
  body.spring("s", point(*stranger, 0, 0), world(0, 0, 0), 1);
  CHECK_THROWS_WITH(Model(body), has_text("'stranger'"));
  MultiBody loose;
  loose.spring("s", world(1, 0, 0), world(0, 0, 0), 1);
  CHECK_THROWS_WITH(Model(loose), has_text("spring 's' ties the world to itself"));
}

TEST_CASE("a part cannot be changed during a simulation, but can be changed afterwards", "[dynamics]") {
  MultiBody body;
  Part& part = body.add(make_part("ball", "sphere", {}, 1000));
  {
    const Simulation simulation(body, "rk4");
    CHECK_THROWS_WITH(part.make_dynamic({"r"}), test::has_text("'ball' is in a simulation"));
    CHECK_THROWS_AS(part.place({0, 0, 1}), std::logic_error);
    CHECK_THROWS_AS(part.damping(1, 0), std::logic_error);
  }
  part.make_dynamic({"r"});
  CHECK(Simulation(body, "rk4").model().n_v() == 7);
}

TEST_CASE("points outside the solid are refused", "[dynamics]") {
  for (const double w : {-0.1, 1.1, std::nan("")}) {
    MultiBody body;
    Part& part = body.add(make_part("ball", "sphere", {}, 1000));
    body.force("push", point(part, 0, 0, w), TimeVector(1, 0, 0));
    CHECK_THROWS_WITH(Model(body), test::has_text("force 'push': its point on part 'ball' needs"));
  }
  MultiBody body;
  Part& part = body.add(make_part("ball", "sphere", {}, 1000));
  body.force("push", point(part, std::nan(""), 0), TimeVector(1, 0, 0));
  CHECK_THROWS_AS(Model(body), std::invalid_argument);
}

TEST_CASE("states of identical bits have the same hash", "[dynamics]") {
  MultiBody body;
  busy_scene(body);
  Simulation simulation(body, "rk4");
  const State start = simulation.state();
  simulation.step(1e-3);
  const State copy = simulation.state();
  CHECK(hash(copy) == hash(simulation.state()));
  CHECK(hash(copy) != hash(start));
  auto changed = [&](auto&& change) {
    State other = copy;
    change(other);
    return hash(other) != hash(copy);
  };
  CHECK(changed([](State& s) { s.v[3] = std::nextafter(s.v[3], 10.0); }));
  CHECK(changed([](State& s) { s.q[9] = std::nextafter(s.q[9], 10.0); }));
  CHECK(changed([](State& s) { s.work[2] += 1; }));
  CHECK(changed([](State& s) { s.at_limit.back() = 1; }));
  CHECK(changed([](State& s) { s.start += 1; }));
  CHECK(changed([](State& s) { s.h *= 2; }));
  CHECK(changed([](State& s) { ++s.step; }));
}

TEST_CASE("the energy of an inverted element is refused with the name of its part", "[dynamics]") {
  MultiBody body;
  LocalSettings settings;
  settings.resolution = 1;
  settings.energies = {local_law("corotated", {1e4, 0.3})};
  settings.displacement = [](const Vec3<double>& X) { return Vec3<double>(-2 * X[0], 0, 0); };
  body.add(make_part("jelly", "ellipsoid", {}, 1000)).rest({{"a1", 0.3}}).deform_locally(settings);
  const Model model(body);
  const Dynamics dynamics(model);
  Workspace<double> work;
  const State state = model.initial_state();
  CHECK_THROWS_WITH(dynamics.energy(0, state.q, state.v, {0}, work),
                    test::has_text("part 'jelly': an element of corotated material is inverted"));
}

}  // namespace dynamics_test
