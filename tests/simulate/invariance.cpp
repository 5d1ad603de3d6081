// Changes that must not affect a motion: other units, rotations and reflections of the scene, the order of
// parts, unrelated parts, the number of threads, queries, a resumed run, features with zero effect.
// N30 and N62 to N67 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <cmath>

#include "motion.h"
#include "worst.h"

namespace invariance_test {

using namespace pliant;

namespace {

const char* const kMethods[] = {"rk4", "semi_implicit_euler"};

/// Units of a scene. The scene is defined in metres, kilograms and seconds; the members convert its numbers
/// to other units.
struct Units {
  double length = 1, mass = 1, time = 1;
  double force() const { return mass * length / (time * time); }
  double stiffness() const { return mass / (time * time); }
  double density() const { return mass / (length * length * length); }
  double energy() const { return force() * length; }
};

/// Coordinates and velocities at the end of a run.
struct Result {
  VecX<double> q, v;
};
/// Runs a scene of two parts in the given units. offset: distance of the scene from the origin along x, in
/// metres.
Result run_in(const Units& u, const char* method, double offset = 0) {
  MultiBody body;
  body.gravity = Vec3<double>(0.5, -1, -9.8) * (u.length / (u.time * u.time));
  Part& a = test::add(body, "a", "superellipsoid", {"taper", "twist", "bend"}, 1000 * u.density());
  a.rest({{"a1", 0.3 * u.length},
          {"a2", 0.25 * u.length},
          {"a3", 0.6 * u.length},
          {"eps1", 0.5},
          {"taper.tx", 0.2}});
  a.stiffness({{"a1", 4e4 * u.stiffness()},
               {"a3", 2e4 * u.stiffness()},
               {"taper.ty", 250 * u.energy()},
               {"twist.angle", 200 * u.energy()},
               {"bend.angle", 300 * u.energy()}});
  a.initial({{"twist.angle", 0.5}})
      .initial_rate({{"a1", 0.5 * u.length / u.time}, {"bend.angle", 2 / u.time}});
  a.limits("bend.angle", {-0.25, 0.25}).damping(0.3 / u.time, 0.001 * u.time, 0.2 / u.time);
  a.place(Vec3<double>(0.1 + offset, 0.2, 0.3) * u.length, Eigen::Quaterniond(0.8, 0.1, -0.5, 0.2));
  a.velocity(Vec3<double>(0.3, 0, 1) * (u.length / u.time), Vec3<double>(1, -2, 1.5) / u.time);
  Part& b = test::add(body, "b", "box", {}, 700 * u.density());
  b.rest({{"a1", 0.2 * u.length}, {"a2", 0.3 * u.length}, {"a3", 0.1 * u.length}});
  b.place(Vec3<double>(1.2 + offset, 0, 0) * u.length);
  body.spring("tie", point(a, 0.4, 0.5), point(b, 0.2, -2), 900 * u.stiffness(), 10 * u.stiffness() * u.time,
              0.4 * u.length);
  body.spring("hold", point(b, 0, 0, 0), world((1 + offset) * u.length, 0, u.length), 500 * u.stiffness());
  body.torque("turn", b, TimeVector(Vec3<double>(0, 3, 1) * u.energy()), Frame::body);
  Simulation simulation(body, method);
  for (int i = 0; i < 200; ++i) simulation.step(u.time * 0x1p-9);
  return {simulation.state().q, simulation.state().v};
}

}  // namespace

TEST_CASE("N62: units that differ by powers of two give identical bits after scaling", "[invariance][long]") {
  for (const char* method : kMethods) {
    const Result plain = run_in({}, method);
    for (const Units& u : {Units{0x1p20, 1, 1}, Units{0x1p-20, 1, 1}, Units{1, 0x1p40, 1},
                           Units{1, 0x1p-40, 1}, Units{1, 1, 0x1p10}, Units{1, 1, 0x1p-10},
                           Units{0x1p-7, 0x1p13, 0x1p5}, Units{0x1p11, 0x1p-9, 0x1p-3}}) {
      const Result scaled = run_in(u, method);
      INFO(method << " " << u.length << " " << u.mass << " " << u.time);
      bool same = true;
      for (Eigen::Index i = 0; i < plain.q.size(); ++i) {
        // q has, for part a, c, the quaternion, the lengths a1 and a3, then taper.ty, twist and bend; for
        // part b, c and the quaternion.
        const bool length = i < 3 || i == 7 || i == 8 || (i >= 12 && i < 15);
        same = same && scaled.q[i] == plain.q[i] * (length ? u.length : 1.0);
      }
      for (Eigen::Index i = 0; i < plain.v.size(); ++i) {
        const bool length = i < 3 || i == 6 || i == 7 || (i >= 11 && i < 14);
        same = same && scaled.v[i] == plain.v[i] * (length ? u.length : 1.0) / u.time;
      }
      CHECK(same);
    }
  }
}

namespace {

/// Runs a scene with a deformable part a, a box b and springs; `rotation` rotates the whole scene. Returns q
/// and v of a and b. reversed: whether the parts are added in reverse order. others: whether a third part c
/// is added, which nothing connects to a and b.
Result run_rotated(const Eigen::Quaterniond& rotation, const char* method, bool reversed = false,
                   bool others = false) {
  MultiBody body;
  body.gravity = rotation * Vec3<double>(0, -1, -9);
  auto make_a = [&] {
    Part& a = test::add(body, "a", "ellipsoid", {"taper", "twist"}, 1000);
    a.rest({{"a1", 0.3}, {"a2", 0.25}, {"a3", 0.6}});
    a.stiffness({{"a1", 4e4}, {"a3", 2e4}, {"taper.ty", 250}, {"twist.angle", 200}})
        .initial({{"twist.angle", 0.5}});
    a.place(rotation * Vec3<double>(0.1, 0.2, 0.3),
            rotation * Eigen::Quaterniond(0.8, 0.1, -0.5, 0.2).normalized());
    a.velocity(rotation * Vec3<double>(0.3, 0, 1), {1, -2, 1.5});
  };
  auto make_b = [&] {
    Part& b = test::add(body, "b", "box", {}, 700);
    b.rest({{"a1", 0.2}, {"a2", 0.3}, {"a3", 0.1}}).place(rotation * Vec3<double>(1.2, 0, 0), rotation);
  };
  auto make_c = [&] {
    Part& c = test::add(body, "c", "cylinder", {"bend"}, 500);
    c.rest({{"a1", 0.2}, {"a2", 0.3}})
        .stiffness({{"bend.angle", 50}, {"a3", 1e4}})
        .limits("bend.angle", {-0.1, 0.1});
    c.initial_rate({{"bend.angle", 3}}).place({9, 9, 9}).velocity({0, 0, 0}, {1, 1, 1});
  };
  if (others && reversed) make_c();
  if (reversed) make_b();
  make_a();
  if (!reversed) make_b();
  if (others && !reversed) make_c();
  Part &a = *body.find("a"), &b = *body.find("b");
  body.spring("tie", point(a, 0.4, 0.5), point(b, 0.2, -2), 900, 10, 0.4);
  body.spring("hold", point(b, 0, 0, 0), world(TimeVector(Vec3<double>(rotation * Vec3<double>(1, 0, 1)))),
              500);
  body.torque("turn", b, TimeVector(Vec3<double>(rotation * Vec3<double>(0, 3, 1))));
  Simulation simulation(body, method);
  for (int i = 0; i < 200; ++i) simulation.step(2e-3);
  Result ends{VecX<double>(18), VecX<double>(16)};
  int q = 0, v = 0;
  for (const Part* part : {&a, &b}) {
    const PartModel& m = simulation.model().parts()[static_cast<std::size_t>(body.index(*part))];
    ends.q.segment(q, 7 + m.n_s) = simulation.state().q.segment(m.q0, 7 + m.n_s);
    ends.v.segment(v, 6 + m.n_s) = simulation.state().v.segment(m.v0, 6 + m.n_s);
    q += 7 + m.n_s;
    v += 6 + m.n_s;
  }
  return ends;
}

}  // namespace

TEST_CASE("N64: a rotated scene gives the rotated motion", "[invariance]") {
  for (const char* method : kMethods) {
    const Result plain = run_rotated(Eigen::Quaterniond::Identity(), method);
    const Eigen::Quaterniond rotation = Eigen::Quaterniond(0.3, -0.7, 0.5, 0.4).normalized();
    const Result rotated = run_rotated(rotation, method);
    INFO(method);
    for (int at : {0, 11}) {
      CHECK((rotated.q.segment<3>(at) - rotation * Vec3<double>(plain.q.segment<3>(at))).norm() <= 1e-11);
      const auto theta = plain.q.segment<4>(at + 3), now = rotated.q.segment<4>(at + 3);
      const Eigen::Quaterniond expected =
          rotation * Eigen::Quaterniond(theta[0], theta[1], theta[2], theta[3]);
      CHECK(std::abs(std::abs(expected.dot(Eigen::Quaterniond(now[0], now[1], now[2], now[3]))) - 1) <=
            1e-11);
    }
    CHECK((rotated.q.segment<4>(7) - plain.q.segment<4>(7)).norm() <= 1e-11);
    CHECK((rotated.v.segment<7>(3) - plain.v.segment<7>(3)).norm() <= 1e-9);
  }
}

TEST_CASE("N64: the order of parts and unrelated parts do not change the motion", "[invariance][long]") {
  for (const char* method : kMethods) {
    const Result plain = run_rotated(Eigen::Quaterniond::Identity(), method);
    const Result reversed = run_rotated(Eigen::Quaterniond::Identity(), method, true);
    CHECK((plain.q - reversed.q).norm() <= 1e-11);
    CHECK((plain.v - reversed.v).norm() <= 1e-10);
    for (bool order : {false, true}) {
      const Result alone = run_rotated(Eigen::Quaterniond::Identity(), method, order);
      const Result with_others = run_rotated(Eigen::Quaterniond::Identity(), method, order, true);
      CHECK(alone.q == with_others.q);
      CHECK(alone.v == with_others.v);
    }
  }
}

TEST_CASE("N64: a mirrored scene moves as the mirror image", "[invariance][long]") {
  // The reflection x -> -x changes the signs of c.x, the twist, the shear along x, two components of omega
  // and two components of the quaternion. The direction phi of the bend becomes pi - phi.
  for (const char* method : kMethods) {
    Result results[2];
    for (int mirrored = 0; mirrored < 2; ++mirrored) {
      const double s = mirrored != 0 ? -1 : 1;
      MultiBody body;
      body.gravity = {s * 1.0, -2, -9};
      Part& a = test::add(body, "a", "ellipsoid", {"taper", "twist", "shear", "bend"}, 1000);
      a.rest({{"a1", 0.2},
              {"a2", 0.25},
              {"a3", 0.6},
              {"twist.angle", s * 0.3},
              {"bend.direction", mirrored != 0 ? kPi - 0.4 : 0.4}});
      a.stiffness(
          {{"a1", 4e4}, {"taper.tx", 250}, {"twist.angle", 200}, {"shear.sx", 400}, {"bend.angle", 300}});
      a.initial({{"bend.angle", 0.3}}).initial_rate({{"twist.angle", s * 2}, {"shear.sx", s * 0.5}});
      a.place({s * 0.1, 0.2, 0.3}, Eigen::Quaterniond(0.8, 0.1, -0.5 * s, 0.2 * s));
      a.velocity({s * 0.3, 0, 1}, {1, -2 * s, 1.5 * s});
      body.spring("hold", point(a, 0.4, mirrored != 0 ? kPi - 0.5 : 0.5), world(s * 0.4, 0, 1), 500, 3, 0.2);
      Simulation simulation(body, method);
      for (int i = 0; i < 200; ++i) simulation.step(2e-3);
      results[mirrored] = {simulation.state().q, simulation.state().v};
    }
    VecX<double> sign = VecX<double>::Ones(results[0].q.size());
    for (int i : {0, 5, 6, 9, 10}) sign[i] = -1;  // c.x, quat.y, quat.z, twist, shear.sx
    CHECK((results[0].q.cwiseProduct(sign) - results[1].q).norm() <= 1e-11);
  }
}

TEST_CASE("N63: a scene far from the origin agrees within 64 ulp of the offset for each step",
          "[invariance][long]") {
  const Result near = run_in({}, "rk4"), far = run_in({}, "rk4", 0x1p20);
  VecX<double> offset = VecX<double>::Zero(near.q.size());
  offset[0] = offset[12] = 0x1p20;
  CHECK((far.q - near.q - offset).norm() <= 64 * 200 * 0x1p20 * 2.2e-16);
}

TEST_CASE("N65: features with zero effect do not change the motion", "[invariance]") {
  auto run = [](const char* method, const std::vector<std::string>& chain, bool null_forces) {
    MultiBody body;
    Part& a = test::add(body, "a", "ellipsoid", chain, 1000);
    a.rest({{"a1", 0.3}, {"a2", 0.25}, {"a3", 0.6}})
        .stiffness({{"a1", 4e4}, {"taper.ty", 250}})
        .initial({{"taper.ty", 0.5}});
    a.velocity({0.3, 0, 1}, {1, -2, 1.5});
    body.spring("hold", point(a, 0.3, 1), world(0, 0, 1), 400, 2);
    if (null_forces) {
      body.spring("nothing", point(a, 0.8, 1), world(3, 0, 1), 0);
      body.force("nothing", point(a, 0.8, 2), TimeVector(0, 0, 0));
      body.torque("nothing", a, TimeVector(0, 0, 0));
      a.damping(0, 0, 0);
    }
    Simulation simulation(body, method);
    for (int i = 0; i < 200; ++i) simulation.step(2e-3);
    return simulation.state().q;
  };
  for (const char* method : kMethods) {
    const VecX<double> plain = run(method, {"taper"}, false);
    CHECK((run(method, {"taper"}, true) - plain).norm() <= 1e-13);
    CHECK((run(method, {"taper", "twist"}, false) - plain).norm() <= 1e-12);
    CHECK((run(method, {"shear", "taper", "bend"}, false) - plain).norm() <= 1e-12);
    CHECK((run(method, {"bend_offset", "taper"}, false) - plain).norm() <= 1e-12);
  }
}

TEST_CASE("N66: any number of threads gives identical bits", "[invariance][long]") {
  for (const char* method : kMethods) {
    std::uint64_t one_thread = 0;
    for (const int threads : {1, 2, 3, 7, 16, 64}) {
      MultiBody body;
      std::vector<Part*> parts;
      for (int i = 0; i < 20; ++i) {
        Part& part = test::tumbling_solid(body, "part" + std::to_string(i));
        part.place({1.0 * i, 0.1 * i * i, 0}).damping(0.1, 0.001, 0.05);
        if (i > 0)
          body.spring("tie" + std::to_string(i), point(*parts.back(), 0.3, 1), point(part, 0.3, -1), 300, 4,
                      0.2);
        parts.push_back(&part);
      }
      Simulation simulation(body, method, threads);
      for (int i = 0; i < 10; ++i) simulation.step(1e-3);
      if (threads == 1) one_thread = hash(simulation.state());
      INFO(method << " on " << threads);
      CHECK(hash(simulation.state()) == one_thread);
    }
  }
}

TEST_CASE("N30: queries of a simulation do not change its motion", "[invariance][long]") {
  for (const char* method : kMethods) {
    VecX<double> q[2];
    for (int query = 0; query < 2; ++query) {
      MultiBody body;
      Part& part = test::tumbling_solid(body);
      part.limits("bend.angle", {-0.6, 0.65});
      Simulation simulation(body, method);
      for (int i = 0; i < 100; ++i) {
        simulation.step(1e-3);
        if (query == 1) {
          simulation.ledger();
          largest_stable_step(simulation);
        }
      }
      q[query] = simulation.state().q;
    }
    CHECK(q[0] == q[1]);
  }
}

TEST_CASE("N67: a run resumed from a copied state gives identical bits", "[invariance]") {
  for (const char* method : kMethods) {
    MultiBody body;
    Part& part = test::tumbling_solid(body);
    part.limits("bend.angle", {-0.6, 0.65}).rest("a1", test::wave(0.3, 0.05, 20));
    Simulation unbroken(body, method);
    for (int i = 0; i < 50; ++i) unbroken.step(1e-3);
    Simulation resumed(body, method);
    resumed.set_state(unbroken.state());
    resumed.set_start_energy(unbroken.start_energy());
    for (int i = 0; i < 50; ++i) {
      unbroken.step(1e-3);
      resumed.step(1e-3);
    }
    CHECK(unbroken.state().q == resumed.state().q);
    CHECK(unbroken.state().work == resumed.state().work);
    CHECK(unbroken.ledger().balance == resumed.ledger().balance);
    CHECK(unbroken.time() == resumed.time());
  }
}

}  // namespace invariance_test
