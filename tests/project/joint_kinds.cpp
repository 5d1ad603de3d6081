// Motions that each kind of joint leaves free, on rigid and on deforming parts; joints at special points and
// within one part; joints that switch on and off.
// N45 and N48 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <algorithm>

#include <Eigen/Geometry>

#include <pliant/body/joints/line.h>
#include <pliant/body/joints/rod.h>
#include <pliant/body/joints/string.h>

#include "motion.h"

namespace joint_kinds_test {

using namespace pliant;

namespace {

Part& ellipsoid(MultiBody& body, const std::string& name, const Vec3<double>& c,
                const Eigen::Quaterniond& R = Eigen::Quaterniond::Identity()) {
  Part& part = test::add(body, name, "ellipsoid", {}, 1000);
  part.rest({{"a1", 0.1}, {"a2", 0.2}, {"a3", 0.3}}).place(c, R.normalized());
  return part;
}
Eigen::Quaterniond turn(const Vec3<double>& axis, double angle) {
  return Eigen::Quaterniond(Eigen::AngleAxisd(angle, axis.normalized()));
}
double gap(const Simulation& simulation, int joint = 0) {
  return simulation.model().gap(simulation.state(), joint);
}

}  // namespace

TEST_CASE("hinge: a door swings as the pendulum of its moment of inertia about the pin", "[joints]") {
  // The part is rotated relative to its pin; on a ball joint the part would wobble.
  const Vec3<double> pin = Vec3<double>(0.2, 1, 0).normalized(), g(0, 0, -9.81);
  MultiBody body;
  const Eigen::Quaterniond R = turn({1, 0.4, -0.3}, 0.9);
  const Vec3<double> down = (g - pin * pin.dot(g)).normalized(), side = pin.cross(down);
  const double theta = 60 * kPi / 180, r = 0.08;
  const Vec3<double> c = r * (std::cos(theta) * down + std::sin(theta) * side);
  Part& door = ellipsoid(body, "door", c, R);
  const Vec3<double> at = R.conjugate() * Vec3<double>(-c);
  door.prepare();
  const Material<double> place = door.label(at, door.parameters().rest());
  body.hinge("hinge", point(door, place), world(0, 0, 0), pin);
  Simulation simulation(body, "rk4");

  const Inertia<double>& rest = door.rest_inertia();
  const double m = rest.mass;
  const Mat3<double> I = rest.M.bottomRightCorner<3, 3>();
  const Vec3<double> pin_body = R.conjugate() * pin;
  const double about_pin = pin_body.dot(I * pin_body) + m * r * r;
  const double pull = m * r * (g - pin * pin.dot(g)).norm();
  const double period = 4 * std::sqrt(about_pin / pull) * test::elliptic_K(theta);
  test::run(simulation, period, 2000);
  CHECK((simulation.state().q.head<3>() - c).norm() <= 1e-8);
  CHECK(gap(simulation) <= 1e-12);
  // The pin keeps its direction: omega has no other component.
  CHECK(std::abs((simulation.model().orientation(simulation.state(), 0) * pin_body - pin).norm()) <= 1e-12);
}

TEST_CASE("the force and the torque of a hinge follow from the motion, with no torque about its pin",
          "[joints]") {
  const Vec3<double> pin = Vec3<double>(0.2, 1, 0.5).normalized();
  MultiBody body;
  const Eigen::Quaterniond R = turn({1, 0.4, -0.3}, 0.9);
  Part& door = ellipsoid(body, "door", {0.07, -0.02, 0.03}, R);
  door.prepare();
  const Vec3<double> at = R.conjugate() * -door.c0();
  body.hinge("hinge", point(door, door.label(at, door.parameters().rest())), world(0, 0, 0), pin);
  Simulation simulation(body, "rk4");
  test::run(simulation, 0.3, 300);
  const State& state = simulation.state();
  Workspace<double> work;
  simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
  const Wrench wrench = simulation.dynamics().joint_wrench(state.time(), 0, work);

  const double m = door.total_mass();
  const Mat3<double> I = door.rest_inertia().M.bottomRightCorner<3, 3>();
  const Vec3<double> c = state.q.head<3>(), omega = state.v.segment<3>(3);
  const Vec3<double> force = m * (work.v_dot.head<3>() - body.gravity);
  const Vec3<double> spin_torque = I * work.v_dot.segment<3>(3) + omega.cross(I * omega);  // body frame
  const Vec3<double> torque = simulation.model().orientation(state, 0) * spin_torque + c.cross(force);
  CHECK((wrench.force - force).norm() <= 1e-11 * force.norm());
  CHECK((wrench.torque - torque).norm() <= 1e-11 * force.norm() * c.norm());
  CHECK(wrench.torque.norm() >= 1e-2 * force.norm() * c.norm());
  CHECK(std::abs(wrench.torque.dot(pin)) <= 1e-11 * force.norm() * c.norm());
}

TEST_CASE("weld: two parts tumble as one composite part", "[joints]") {
  MultiBody two;
  two.gravity.setZero();
  Part& a = ellipsoid(two, "a", {0, 0, 0});
  Part& b = ellipsoid(two, "b", {0.05, 0.1, -0.1}, turn({1, 2, 3}, 1));
  const Vec3<double> spin(1, -2, 3);
  a.velocity({0, 0, 0}, spin);
  b.velocity(spin.cross(Vec3<double>(0.05, 0.1, -0.1)), b.R0().conjugate() * spin);
  a.prepare();
  two.weld("weld", point(a, a.label(Vec3<double>(0.05, 0.1, -0.1), a.parameters().rest())),
           point(b, 0, 0, 0));
  Simulation simulation(two, "rk4");

  MultiBody one;
  one.gravity.setZero();
  Part& composite = ellipsoid(one, "whole", {0, 0, 0});
  const double m = a.rest_inertia().mass;
  const Mat3<double> I = a.rest_inertia().M.bottomRightCorner<3, 3>(), R = b.R0().toRotationMatrix();
  const Vec3<double> d(0.05, 0.1, -0.1);
  const Mat3<double> moved =
      R * I * R.transpose() + m * (d.squaredNorm() * Mat3<double>::Identity() - d * d.transpose());
  composite.inertia(2 * m, I + moved, d / 2).velocity({0, 0, 0}, spin);
  Simulation reference(one, "rk4");

  test::run(simulation, 3, 3000);
  test::run(reference, 3, 3000);
  CHECK(gap(simulation) <= 1e-12);
  CHECK((simulation.state().q.head<7>() - reference.state().q.head<7>()).norm() <= 1e-9);
  CHECK((simulation.state().v.head<6>() - reference.state().v.head<6>()).norm() <= 1e-9);
}

TEST_CASE("slider, line and plane: a part falls freely along the free directions", "[joints]") {
  const Vec3<double> d = Vec3<double>(1, 0.5, -1).normalized(), g(0, 0, -9.81);
  for (const char* type : {"slider", "line", "plane"})
    for (const char* method : {"rk4", "semi_implicit_euler"}) {
      MultiBody body;
      Part& block = ellipsoid(body, "block", {0.2, 0.3, 0.4}, turn({1, 2, 0}, 0.5));
      // A line or a plane joint at the centre exerts no torque. A slider may act at any point.
      JointSetting setting{point(block, 0.3, 0.2, type == std::string("slider") ? 1 : 0), {}};
      Vec3<double> x0(0.2, 0.3, 0.4);
      block.prepare();
      if (type == std::string("slider"))
        x0 += block.R0() * Vec3<double>(block.s({material_at(0.3, 0.2)}, block.parameters().rest()).col(0));
      setting.to = world(x0[0], x0[1], x0[2]);
      setting.axis = d;
      body.join(type, "joint", setting);
      Simulation simulation(body, method);
      test::run(simulation, 1, 1000);
      const Vec3<double> a =
          type == std::string("plane") ? Vec3<double>(g - d * d.dot(g)) : Vec3<double>(d * d.dot(g));
      INFO(type << " " << method);
      const double order_one = method == std::string("rk4") ? 0 : 0.5e-3;
      const Vec3<double> expected = Vec3<double>(0.2, 0.3, 0.4) + (0.5 + order_one) * a;
      CHECK((simulation.state().q.head<3>() - expected).norm() <= 1e-11);
      CHECK(simulation.state().v.segment<3>(3).norm() <= 1e-10);
      CHECK(gap(simulation) <= 1e-12);
    }
}

TEST_CASE(
    "lines, planes, hinges, sliders and welds between free parts conserve momenta and energy, deforming or "
    "not",
    "[joints][long]") {
  for (const bool deforming : {false, true})
    for (const char* type : {"line", "plane", "hinge", "slider", "weld"}) {
      std::vector<double> errors;
      INFO(type << (deforming ? " deforming" : " rigid"));
      for (const int steps : {400, 800}) {
        MultiBody body;
        Part& a = test::tumbling_solid(body, "a");
        // The directions of the joint are defined on the rest shape. The rest values equal the initial
        // values, so that the directions are the same at time 0.
        a.rest({{"a1", 0.32}, {"twist.angle", 0.6}, {"bend.angle", 0.6}, {"bend.direction", 0.3}});
        if (!deforming) {
          std::vector<std::string> names;
          for (const int k : a.parameters().dynamic()) names.push_back(a.parameters()[k].name);
          a.freeze(names);
        }
        Part& b = ellipsoid(body, "b", {0.6, 0.1, 0.4}, turn({1, 1, 0}, 0.4));
        b.velocity({0.3, 0, -0.2}, {0.5, 1, -1});
        a.prepare();
        b.prepare();
        // The joints start closed: part b is placed so that its point coincides with the point of part a.
        JointSetting setting{point(a, 0.3, 0.2), {}};
        ParameterValues<double> values = a.parameters().rest();
        for (const int k : a.parameters().dynamic())
          values.b[static_cast<std::size_t>(k)] = a.parameters()[k].initial;
        const Vec3<double> x = a.c0() + a.R0() * Vec3<double>(a.s({setting.from.material}, values).col(0));
        const Vec3<double> of_b = b.R0().conjugate() * Vec3<double>(0.2 * Vec3<double>(0.1, 0.2, 0.3));
        setting.to = point(b, b.label(of_b, b.parameters().rest()));
        b.place(x - b.R0() * of_b, b.R0());
        setting.axis = {0.3, 1, 0.2};
        body.join(type, "joint", setting);
        Simulation simulation(body, "rk4");
        const Ledger before = simulation.ledger();
        test::run(simulation, 0.5, steps);
        const Ledger after = simulation.ledger();
        errors.push_back(std::abs(after.balance) / before.energy());
        CHECK((after.momentum - before.momentum).norm() <= 1e-6 * before.momentum.norm());
        CHECK((after.angular_momentum - before.angular_momentum).norm() <=
              1e-5 * before.angular_momentum.norm());
        CHECK(gap(simulation) <= 1e-11);
      }
      CHECK(errors[1] <= 1e-7);
      CHECK((errors[1] <= 1e-12 || std::log2(errors[0] / errors[1]) >= 3.5));
    }
}

TEST_CASE("hinges and welds close from any rotation, half turns included", "[joints][long]") {
  for (const char* type : {"hinge", "weld"})
    for (const double angle : {0.5, kPi / 2, kPi / 2 + 1e-12, kPi / 2 + 1e-7, 2.0, 3.0, kPi}) {
      MultiBody body;
      body.gravity.setZero();
      Part& a = ellipsoid(body, "a", {0, 0, 0});
      Part& b = ellipsoid(body, "b", {1, 0.3, 0}, turn({1, 0, 0}, angle));
      JointSetting setting{point(a, kPi / 2, 0), point(b, -kPi / 2, 0)};
      setting.from_axis = Vec3<double>(0, 0, 1);
      setting.rotation = Eigen::Quaterniond::Identity();
      body.join(type, "joint", setting);
      a.damping(0, 0, 3);
      b.damping(0, 0, 3);
      Simulation simulation(body, "rk4");
      INFO(type << " from " << angle);
      CHECK(gap(simulation) >= 0.3 * angle);
      double fastest = 0;
      for (int i = 0; i < 3000; ++i) {
        simulation.step(1e-3);
        fastest = std::max(fastest, simulation.state().v.lpNorm<Eigen::Infinity>());
      }
      CHECK(simulation.state().joints[0] == JointMode::closed);
      CHECK(gap(simulation) <= 1e-12);
      CHECK(fastest <= 60);
    }
}

TEST_CASE("the size of the moving part scales the orientation error of a weld to a small fixed part",
          "[joints]") {
  MultiBody body;
  body.gravity.setZero();
  Part& peg = test::add(body, "peg", "sphere", {}, 1000);
  peg.rest({{"r", 5e-4}}).fix();
  Part& part = ellipsoid(body, "part", {0, 0, 0}, turn({0, 0, 1}, 0.8));
  JointSetting setting{point(part, 0, 0, 0), point(peg, 0, 0, 0)};
  setting.rotation = Eigen::Quaterniond::Identity();
  body.join("weld", "weld", setting);
  const Simulation simulation(body, "rk4");
  CHECK(simulation.state().joints[0] == JointMode::closing);
  CHECK(gap(simulation) == Approx(0.8 * part.size()).epsilon(1e-12));
}

TEST_CASE("N45: joints work at poles, sharp corners, taper tips and the centre", "[joints][long]") {
  struct Where {
    const char* shape;
    std::vector<std::pair<std::string, double>> rest;
    std::vector<std::string> chain;
    Material<double> at;
  };
  const std::vector<Where> places{
      {"sphere", {}, {}, material_at(kPi / 2, 0)},
      {"superellipsoid", {{"eps1", 0.1}, {"eps2", 0.1}}, {}, material_at(kPi / 4, kPi / 4)},
      {"superellipsoid", {{"eps1", 2}, {"eps2", 2}}, {}, material_at(0, 0)},
      {"cylinder", {{"taper.tx", -0.99}, {"taper.ty", -0.99}}, {"taper"}, material_at(kPi / 2, 0)},
      {"ellipsoid", {}, {"bend"}, material_at(0.3, 1, 0)}};
  for (const Where& where : places)
    for (const char* type : {"ball", "hinge", "weld"})
      for (const bool dynamic : {false, true}) {
        MultiBody body;
        Part& part = test::add(body, "part", where.shape, where.chain, 1000);
        for (const auto& [name, value] : where.rest) part.rest({{name, value}});
        if (dynamic) part.stiffness({{where.shape == std::string("sphere") ? "r" : "a3", 1e5}});
        part.prepare();
        const Vec3<double> x = part.s({where.at}, part.parameters().rest()).col(0);
        body.join(type, "joint",
                  {point(part, where.at), world(x[0], x[1], x[2]), 0, Vec3<double>(0, 1, 0), {}, {}});
        Simulation simulation(body, "rk4");
        const double h = 2e-4;
        for (int i = 0; i < 500; ++i) simulation.step(h);
        INFO(where.shape << " " << type << (dynamic ? " dynamic" : " rigid"));
        CHECK(gap(simulation) <= 1e-12);
        CHECK(simulation.state().q.allFinite());
        CHECK(std::abs(simulation.ledger().balance) <= 1e-6 * std::abs(simulation.ledger().kinetic + 1));
        Workspace<double> work;
        const State& state = simulation.state();
        simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
        CHECK(simulation.dynamics().joint_wrench(state.time(), 0, work).force.norm() > 0);
      }
}

TEST_CASE("N48: joints switch on and off at their times, also between steps", "[joints][long]") {
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    std::vector<double> errors;
    for (const int steps : {100, 200, 400}) {
      MultiBody body;
      Part& bob = ellipsoid(body, "bob", {0.8, 0, 0});
      const double off = 0.5437;  // between steps
      body.ball("joint", point(bob, 0, 0, 0), world(0, 0, 0)).during(0, off);
      bob.place({0, 0, 0});
      Part& pendulum = ellipsoid(body, "swung", {0.1, 0, 0});
      body.ball("pivot", point(pendulum, 0, kPi), world(0, 0, 0)).during(0, off);
      Simulation simulation(body, method);
      // Reference: a pendulum until its release, then free flight from the state at the release.
      MultiBody reference_body;
      Part& other = ellipsoid(reference_body, "swung", {0.1, 0, 0});
      reference_body.ball("pivot", point(other, 0, kPi), world(0, 0, 0));
      Simulation reference(reference_body, "rk4");
      test::run(reference, off, 4000);
      const double rest = 1 - off;
      const Vec3<double> c = reference.state().q.head<3>(), c_dot = reference.state().v.head<3>();
      const Vec3<double> end = c + rest * c_dot + rest * rest / 2 * Vec3<double>(0, 0, -9.81);
      test::run(simulation, 1, steps);
      CHECK(simulation.state().joints[1] == JointMode::off);
      CHECK(simulation.time() == Approx(1).epsilon(1e-14));
      errors.push_back((simulation.state().q.segment<3>(7) - end).norm());
      // The bob hangs at rest and falls after its release.
      if (method == std::string("rk4"))
        CHECK(simulation.state().q[2] == Approx(-9.81 / 2 * rest * rest).epsilon(1e-12));
      CHECK(simulation.state().work.norm() <= 1e-12);
    }
    INFO(method << ": " << errors[0] << " " << errors[1] << " " << errors[2]);
    CHECK(test::observed_order(errors) >= (method == std::string("rk4") ? 3.8 : 0.8));
  }
  SECTION("a joint that switches on stops the relative motion, and the ledger records the loss") {
    MultiBody body;
    body.gravity.setZero();
    Part &a = ellipsoid(body, "a", {0, 0, 0}), &b = ellipsoid(body, "b", {0, 0, 0});
    a.velocity({1, 0, 0}, {0, 0, 0});
    b.place({0.3, 0, 0});
    const double m = 1000 * 4. / 3 * kPi * 0.1 * 0.2 * 0.3;
    body.ball("catch", point(a, 0, 0, 0), point(b, 0, 0, 0)).during(0.3);  // at 0.3 s a passes b
    Simulation simulation(body, "rk4");
    test::run(simulation, 1, 70);
    CHECK(simulation.state().joints[0] == JointMode::closed);
    CHECK(gap(simulation) <= 1e-13);
    CHECK(simulation.state().v[0] == Approx(0.5).epsilon(1e-12));
    CHECK(simulation.state().v[6] == Approx(0.5).epsilon(1e-12));
    CHECK(simulation.state().work[static_cast<int>(Work::projection)] == Approx(-m / 4).epsilon(1e-12));
    CHECK(std::abs(simulation.ledger().balance) <= 1e-12 * m);
    REQUIRE(simulation.engage_impulses().size() == 1);
    const ImpulseOnEngage& engaged = simulation.engage_impulses().front();
    CHECK(engaged.time == Approx(0.3).epsilon(1e-14));
    CHECK(engaged.joint == 0);
    CHECK((engaged.impulse.force - Vec3<double>(-m / 2, 0, 0)).norm() <= 1e-12 * m);
  }
  SECTION("a joint that switches on away from the centres of mass: its impulse and its work") {
    // Two spheres translate and rotate; at 0.3 s a point of the first sphere meets a point of the second.
    const double r = 0.2, on = 0.3, m[] = {1, 0.4};
    const Vec3<double> meet(0.1, 0.2, -0.3), v[] = {{1, 0.2, 0}, {-0.3, 0, 0.1}},
                                             w[] = {{0, 0, 2}, {1, 0, 0}};
    const double points[2][2] = {{0.3, 1}, {-0.5, 2}};  // u, v
    MultiBody body;
    body.gravity.setZero();
    Vec3<double> arm[2];
    for (const int i : {0, 1}) {
      const double u = points[i][0], along = points[i][1];
      arm[i] =
          turn(w[i], on * w[i].norm()) *
          Vec3<double>(r * std::cos(u) * std::cos(along), r * std::cos(u) * std::sin(along), r * std::sin(u));
      Part& part = test::add(body, i == 0 ? "a" : "b", "sphere", {}, 1000);
      part.rest({{"r", r}}).mass(m[i]).place(meet - arm[i] - on * v[i]).velocity(v[i], w[i]);
    }
    body.ball("catch", point(*body.find("a"), points[0][0], points[0][1]),
              point(*body.find("b"), points[1][0], points[1][1]))
        .during(on);
    Simulation simulation(body, "rk4");
    for (int i = 0; i < 700; ++i) simulation.step(on / 700);
    simulation.step(1e-12);
    REQUIRE(simulation.state().joints[0] == JointMode::closed);
    // The impulse J on part a satisfies W J = -C_dot, with the inverse effective mass W of the joint and the
    // relative velocity C_dot of its points before the impulse.
    auto cross = [](const Vec3<double>& x) {
      Mat3<double> X;
      X << 0, -x[2], x[1], x[2], 0, -x[0], -x[1], x[0], 0;
      return X;
    };
    Mat3<double> W = Mat3<double>::Zero();
    for (const int i : {0, 1})
      W += Mat3<double>::Identity() / m[i] - cross(arm[i]) * cross(arm[i]) / (0.4 * m[i] * r * r);
    const Vec3<double> C_dot = v[0] + w[0].cross(arm[0]) - v[1] - w[1].cross(arm[1]);
    const Vec3<double> J = -W.inverse() * C_dot;
    REQUIRE(simulation.engage_impulses().size() == 1);
    CHECK((simulation.engage_impulses().front().impulse.force - J).norm() <= 1e-11 * J.norm());
    const State& s = simulation.state();
    for (const int i : {0, 1}) {
      const Vec3<double> push = i == 0 ? J : Vec3<double>(-J);
      const auto theta = s.q.segment<4>(7 * i + 3);
      const Eigen::Quaterniond R(theta[0], theta[1], theta[2], theta[3]);
      CHECK((m[i] * (s.v.segment<3>(6 * i) - v[i]) - push).norm() <= 1e-11 * J.norm());
      CHECK((0.4 * m[i] * r * r * (R * Vec3<double>(s.v.segment<3>(6 * i + 3)) - w[i]) - arm[i].cross(push))
                .norm() <= 1e-11 * r * J.norm());
    }
    CHECK(s.work[static_cast<int>(Work::projection)] == Approx(J.dot(C_dot) / 2).epsilon(1e-12));
    CHECK(std::abs(simulation.ledger().balance) <= 1e-14);
  }
  SECTION("a run resumed from a state before the switch gives identical bits") {
    auto make = [](MultiBody& body) {
      Part& bob = ellipsoid(body, "bob", {0.1, 0, 0});
      body.ball("joint", point(bob, 0, kPi), world(0, 0, 0)).during(0.1, 0.3);
    };
    MultiBody one, two;
    make(one);
    make(two);
    Simulation unbroken(one, "rk4"), resumed(two, "rk4");
    State saved;
    for (int i = 0; i < 70; ++i) {
      unbroken.step(7e-3);
      if (i == 20) saved = unbroken.state();
    }
    resumed.set_state(saved);
    for (int i = 21; i < 70; ++i) resumed.step(7e-3);
    CHECK(hash(unbroken.state()) == hash(resumed.state()));
  }
  SECTION("switches at almost equal times, and directly after the start, are not missed") {
    MultiBody body;
    Part& bob = ellipsoid(body, "bob", {0, 0, 0});
    body.ball("first", point(bob, 0, 0), world(0.1, 0, 0)).during(0, 0.0599999);
    body.ball("second", point(bob, 0, kPi), world(-0.1, 0, 0)).during(0, 0.06 + 5e-12);
    body.ball("third", point(bob, kPi / 2, 0), world(0, 0, 0.3)).during(0, 1e-12);
    Simulation simulation(body, "rk4");
    simulation.step(0.01);
    CHECK(simulation.state().joints[2] == JointMode::off);
    for (int i = 0; i < 9; ++i) simulation.step(0.01);
    CHECK(simulation.state().joints[0] == JointMode::off);
    CHECK(simulation.state().joints[1] == JointMode::off);
    CHECK(simulation.time() == Approx(0.1).epsilon(1e-14));
  }
  SECTION("times are refused unless on < off") {
    MultiBody body;
    Part& bob = ellipsoid(body, "bob", {0, 0, 0});
    CHECK_THROWS_AS(body.ball("joint", point(bob, 0, 0), world(0, 0, 0)).during(2, 1), std::invalid_argument);
  }
}

TEST_CASE("N48: closed joints receive their impulses when a string, or a rod in its place, becomes active",
          "[joints]") {
  for (const bool string : {false, true}) {
    CAPTURE(string);
    MultiBody body;
    body.gravity.setZero();
    Part& bar = body.add(make_part("bar", "ellipsoid", {}, 1000));
    bar.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.5}}).place({0, 0, -0.5}).velocity({1, 0, 0}, {0, -2, 0});
    body.ball("pivot", point(bar, kPi / 2, 0), world(0, 0, 0));
    // The rope (string or rod) is as long as the distance from its anchor to the end of the bar at 0.2 s.
    const double turned = 2 * 0.2;
    const double length =
        (Vec3<double>(std::sin(turned), 0, -std::cos(turned)) - Vec3<double>(-0.5, 0, -1)).norm();
    const std::vector<Point> ends{point(bar, -kPi / 2, 0), world(-0.5, 0, -1)};
    if (string)
      body.join("rope", String{length}, ends).during(0.2);
    else
      body.join("rope", Rod{length}, ends).during(0.2);
    Simulation simulation(body, "rk4");
    const double last = 1e-7;
    test::run(simulation, 0.2 - last, 200);
    const Vec3<double> before = simulation.ledger().momentum;
    // The bar turns freely on its pivot until 0.2 s, and the rope engages at the end of this step.
    simulation.step(last);
    const Vec3<double> gain = simulation.ledger().momentum - before;
    REQUIRE(gain.norm() > 1);
    REQUIRE(simulation.engage_impulses().size() == 2);
    Vec3<double> impulse = Vec3<double>::Zero();
    for (const ImpulseOnEngage& engaged : simulation.engage_impulses()) {
      CHECK(engaged.impulse.force.norm() > 1);
      impulse += engaged.impulse.force;
    }
    CHECK((impulse - gain).norm() <= 1e-6 * gain.norm());
  }
}

TEST_CASE("joints within a part constrain its deformation, and have no effect on rigid motion", "[joints]") {
  for (const auto solver : {JointSolver::Choice::blocks, JointSolver::Choice::augmented})
    for (const char* moving : {"a1", "a2"}) {
      INFO(moving);
      MultiBody body;
      body.gravity.setZero();
      body.joint_solver.choice = solver;
      Part& part = test::add(body, "part", "ellipsoid", {}, 1000);
      part.rest({{"a1", 0.3}, {"a2", 0.1}, {"a3", 0.1}}).velocity({0.1, 0.2, 0}, {1, 2, 3});
      part.stiffness({{moving, 1e4}});
      part.prepare();
      body.join("rod", Rod{0.6}, {point(part, 0, 0), point(part, 0, kPi)});
      body.join("line", "slider", {point(part, 0, 0), point(part, 0, kPi), 0, {1, 0, 0}});
      Simulation simulation(body, "rk4");
      const double energy = simulation.ledger().energy();
      test::run(simulation, 2, 1000);
      CHECK(std::abs(simulation.ledger().energy() - energy) <= 1e-6 * energy);
      for (const int joint : {0, 1}) CHECK(gap(simulation, joint) <= 1e-13);
      if (moving == std::string("a1")) CHECK(simulation.state().q[7] == Approx(0.3).epsilon(1e-12));
    }
}

}  // namespace joint_kinds_test
