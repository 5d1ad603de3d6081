// Fast parts of three shapes against a thin part, a plane, a mesh and an ellipsoid: none passes through.
// N53 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cmath>

#include <pliant/contact/contact_stepping.h>
#include "draws.h"

#include "motion.h"

namespace fast_contacts_test {

using namespace pliant;
using test::Draws;

namespace {

constexpr double kStep = 1e-2;                    // s
constexpr double kSize = 0.05, kSmallest = 0.02;  // the largest and the smallest semi-axis, m

Part& add_shot(MultiBody& body, const std::string& name, const std::string& shape) {
  Part& part = body.add(make_part(name, shape, {}, 1000));
  part.rest({{"a1", kSize}, {"a2", 0.03}, {"a3", kSmallest}});
  if (shape == "superellipsoid") part.rest({{"eps1", 0.5}, {"eps2", 1.5}});
  return part;
}
Eigen::Quaterniond random_rotation(Draws& draws) {
  return Eigen::Quaterniond(draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(-1, 1),
                            draws.uniform(0.1, 1))
      .normalized();
}
/// Sets position c (m), orientation R, velocity c_dot (m/s, world) and angular velocity omega (rad/s, body)
/// of a part.
void set_motion(const Model& model, int part, const Vec3<double>& c, const Eigen::Quaterniond& R,
                const Vec3<double>& c_dot, const Vec3<double>& omega, State& state) {
  const PartModel& m = model.parts()[static_cast<std::size_t>(part)];
  state.q.segment<7>(m.q0) << c, R.w(), R.x(), R.y(), R.z();
  state.v.segment<6>(m.v0) << c_dot, omega;
}

struct ShotResults {
  /// hits: shots that touched the target. passes: shots that passed the target or never touched it.
  int hits = 0, passes = 0;
  double deepest = 0;  ///< deepest overlap after the first contact, in units of kSize
};
/// Shoots a part from above at a target `shots` times, and returns the results. at: "plane", "mesh" or
/// "plate" (a thin part), which are wide targets at z = 0, or "body" (an ellipsoid). shape: shape of the
/// part. The speeds are from 0.1 to 10 sizes (kSize) a step.
ShotResults shoot(const std::string& at, const std::string& shape, int shots, Draws& draws) {
  MultiBody body;
  body.gravity.setZero();
  body.contact.active = true;
  add_shot(body, "shot", shape);
  if (at == "plane") body.plane("target", Vec3<double>(0, 0, 0), {0, 0, 1});
  if (at == "mesh") body.plate("target", {0, 0, 0}, Eigen::Quaterniond::Identity(), 5, 5);
  if (at == "plate")
    body.add(make_part("target", "box", {}, 1000))
        .rest({{"a1", 5}, {"a2", 5}, {"a3", 0.005}})
        .place({0, 0, -0.005})
        .fix();
  const bool pair = at == "body";
  if (pair) add_shot(body, "target", "ellipsoid");
  Simulation simulation(body, "rk4");
  const State first = simulation.state();
  ContactFinder finder(simulation.model());
  ShotResults results;
  for (int i = 0; i < shots; ++i) {
    State state = first;
    const double sizes_per_step = std::exp(draws.uniform(std::log(0.1), std::log(10.0))),
                 speed = sizes_per_step * kSize / kStep;
    const Vec3<double> along =
        Vec3<double>(draws.uniform(-0.5, 0.5), draws.uniform(-0.5, 0.5), -1).normalized();
    // The distance is random, so that the contact occurs at any fraction of a step.
    const double distance = draws.uniform(2.2, 2.2 + std::clamp(2 * sizes_per_step, 0.5, 9.8)) * kSize;
    // The offset from the middle of the other part is at most half the smallest semi-axis.
    const Vec3<double> aim = pair ? draws.vector(0.5 * kSmallest / std::sqrt(3.0)) : Vec3<double>::Zero();
    set_motion(simulation.model(), 0, aim - distance * along, random_rotation(draws), speed * along,
               draws.vector(9), state);
    if (pair)
      set_motion(simulation.model(), 1, Vec3<double>::Zero(), random_rotation(draws), Vec3<double>::Zero(),
                 draws.vector(9), state);
    simulation.set_state(state);
    const int steps = static_cast<int>(distance / (speed * kStep)) + 2;
    bool hit = false;
    for (int k = 0; k < steps && !hit; ++k) {
      simulation.step(kStep);
      hit = !simulation.contact()->contacts().empty();
    }
    const Vec3<double> x = simulation.state().q.head<3>();
    bool passed = x[2] < 0;
    if (pair && hit) {
      // A deflected part may overtake the other part in the rest of the step, but only beside it. The normal
      // of the first contact must oppose the motion.
      const Contact& first_contact = simulation.contact()->contacts().front();
      const double approach = (first_contact.a.part == 0 ? -1 : 1) * first_contact.normal.dot(along);
      const Vec3<double> d = x - simulation.state().q.segment<3>(7);
      const double ahead = d.dot(along);
      passed = !(approach > 0) || (ahead > 0 && (d - ahead * along).norm() < 2 * kSmallest);
    }
    results.hits += hit;
    results.passes += passed || !hit;
    for (const Contact& contact : finder.find(simulation.state(), simulation.time(), 0))
      results.deepest = std::max(results.deepest, -contact.gap / kSize);
  }
  return results;
}
/// Shoots parts of all shapes at all targets. fast_shots: number of shots for a shape and a target whose
/// contacts have closed forms or few sample points. slow_shots: number of shots for any other shape and
/// target.
void shoot_all(int fast_shots, int slow_shots) {
  Draws draws(11);
  for (const std::string at : {"plane", "mesh", "body", "plate"})
    for (const std::string shape : {"ellipsoid", "box", "superellipsoid"}) {
      const bool flat = at == "plane" || at == "mesh";
      const bool is_fast = shape == "ellipsoid" ? at != "plate" : flat && shape == "box";
      const ShotResults results = shoot(at, shape, is_fast ? fast_shots : slow_shots, draws);
      CAPTURE(at, shape, results.hits);
      CHECK(results.passes == 0);
      // An impact may start a rotation, by which the other end of the part overlaps the target: 4e-3 sizes
      // have been observed.
      CHECK(results.deepest < 1e-2);
    }
}

}  // namespace

TEST_CASE("N53: hundreds of fast parts, none passes through", "[contact]") {
  shoot_all(100, 3);
}

TEST_CASE("N53: a hundred thousand fast parts, none passes through", "[contact][long]") {
  shoot_all(19000, 720);  // 100 040 in all
}

}  // namespace fast_contacts_test
