// The contact cache: contact forces of the previous step, stored in the state, warm-start the contact solver.
// A step without stored forces starts cold: all start values are zero. After ten warm-started steps, one step
// starts cold too.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>

#include "motion.h"

namespace contact_cache_test {

using namespace pliant;

namespace {

constexpr double kHalf = 0.1, kStep = 5e-3;  // m, s

/// Adds a floor and rows of boxes; each row has one box fewer than the row below. Above the lowest row, each
/// box rests on two boxes.
void pyramid(MultiBody& body, int rows) {
  for (int row = 0; row < rows; ++row)
    for (int k = 0; k < rows - row; ++k) {
      Part& part =
          body.add(make_part("box" + std::to_string(row) + "_" + std::to_string(k), "box", {}, 1000));
      part.rest({{"a1", kHalf}, {"a2", kHalf}, {"a3", kHalf}});
      part.place({kHalf * (2.1 * k + 1.05 * row), 0, kHalf * (2 * row + 1)});
    }
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}
/// Returns the weight of all parts, N.
double weight(const MultiBody& body) {
  double mass = 0;
  for (const auto& part : body.parts()) mass += part->total_mass();
  return mass * body.gravity_at(0).norm();
}
/// Returns the sum of the cached forces of the floor on the parts, N, world.
Vec3<double> cached_floor_force(const State& state) {
  Vec3<double> force = Vec3<double>::Zero();
  for (const CachedContact& cached : state.contact_cache)
    if (cached.between[2] == 0) force += cached.force;
  return force;
}
void clear_cache(State& state) {
  state.contact_cache.clear();
}
/// Performs `steps` steps of h (s) and modifies the state by `change` before each step. Returns the number of
/// sweeps (iterations of the contact solver over all contacts).
template <class F>
long sweeps(Simulation& simulation, int steps, F&& change, double h = kStep) {
  const long before = simulation.step_counters().contact_sweeps;
  for (int i = 0; i < steps; ++i) {
    State state = simulation.state();
    change(state);
    simulation.set_state(state);
    simulation.step(h);
  }
  return simulation.step_counters().contact_sweeps - before;
}

}  // namespace

TEST_CASE("a standing pile needs few iterations with the contact cache, and stands as without the cache",
          "[contact]") {
  MultiBody body;
  pyramid(body, GENERATE(2, 8));  // 16 contacts, 256 contacts
  Simulation warm(body, "rk4"), cold(body, "rk4");
  const VecX<double> start = warm.state().q;
  for (int i = 0; i < 20; ++i) warm.step(kStep);
  cold.set_state(warm.state());
  const long warm_sweeps = sweeps(warm, 40, [](State&) {}), cold_sweeps = sweeps(cold, 40, clear_cache);
  CAPTURE(warm_sweeps, cold_sweeps);
  CHECK(cold_sweeps >= 40);
  CHECK(4 * warm_sweeps < cold_sweeps);
  for (const Simulation* simulation : {&warm, &cold}) {
    CHECK((simulation->state().q - start).lpNorm<Eigen::Infinity>() < 1e-11);
    CHECK(simulation->state().v.norm() < 1e-11);
    CHECK((cached_floor_force(simulation->state()) - Vec3<double>(0, 0, weight(body))).norm() <
          1e-9 * weight(body));
  }
}

TEST_CASE("a heavy part on light ones needs iterations only in cold steps with the contact cache",
          "[contact]") {
  MultiBody body;
  for (int i = 0; i < 3; ++i)
    body.add(make_part("box" + std::to_string(i), "box", {}, i == 2 ? 1e6 : 1e3))
        .rest({{"a1", kHalf}, {"a2", kHalf}, {"a3", kHalf}})
        .place({0.01 * i, 0, kHalf * (2 * i + 1)});
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  Simulation warm(body, "rk4"), cold(body, "rk4");
  const long warm_sweeps = sweeps(warm, 44, [](State&) {}), cold_sweeps = sweeps(cold, 44, clear_cache);
  CAPTURE(warm_sweeps, cold_sweeps);
  CHECK(cold_sweeps <= 44 * 20);  // on average at most 20 sweeps in a step
  CHECK(warm_sweeps <= 6 * 20);
  CHECK(warm.step_counters().contact_residual < 1e-11);
  CHECK(warm.state().v.norm() < 1e-11);
}

TEST_CASE("the cache stores forces, so that steps of other lengths also start warm", "[contact]") {
  MultiBody body;
  pyramid(body, 4);
  Simulation simulation(body, "rk4");
  for (int i = 0; i < 20; ++i) simulation.step(kStep);
  int searches = 0;
  for (const double h : {2e-3, 1e-2, 1e-3, 5e-3}) {
    const long before = simulation.step_counters().contact_sweeps;
    simulation.step(h);
    searches += simulation.step_counters().contact_sweeps > before;
    CHECK(cached_floor_force(simulation.state()).z() == Approx(weight(body)).epsilon(1e-9));
  }
  CHECK(searches <= 1);  // one of these steps may start cold
}

TEST_CASE("the contact cache moves with sliding parts and with a part that carries others", "[contact]") {
  MultiBody sliding, carried;
  pyramid(sliding, 4);
  sliding.contact.friction = 0;
  for (const auto& part : sliding.parts()) part->velocity({3, 1, 0}, {0, 0, 0});
  carried.contact.active = true;
  PrescribedMotion motion;  // motion of the table
  motion.position = TimeVector(TimeFunction::formula("3 * t"), 0, -0.1);
  for (int i = 0; i < 3; ++i)
    carried.add(make_part("box" + std::to_string(i), "box", {}, 1000))
        .rest({{"a1", kHalf}, {"a2", kHalf}, {"a3", kHalf}})
        .place({0, 0, kHalf * (2 * i + 1)})
        .velocity({3, 0, 0}, {0, 0, 0});
  carried.add(make_part("table", "box", {}, 1000))
      .rest({{"a1", 1}, {"a2", 1}, {"a3", 0.1}})
      .prescribe(motion);
  for (MultiBody* body : {&sliding, &carried}) {
    CAPTURE(body->parts().size());
    Simulation simulation(*body, "rk4");
    const long warm_sweeps = sweeps(simulation, 40, [](State&) {}),
               cold_sweeps = sweeps(simulation, 40, clear_cache);
    CAPTURE(warm_sweeps, cold_sweeps);
    CHECK(cold_sweeps >= 40);
    CHECK(4 * warm_sweeps < cold_sweeps);
  }
}

TEST_CASE("wrong cached forces do not change the solution", "[contact]") {
  MultiBody body;
  pyramid(body, 4);
  Simulation simulation(body, "rk4");
  const VecX<double> start = simulation.state().q;
  for (const double factor : {0.0, -1.0, 1e3, 1e12, 1e300}) {
    CAPTURE(factor);
    sweeps(simulation, 10, [&](State& state) {
      for (CachedContact& cached : state.contact_cache)
        cached.force = factor * cached.force + Vec3<double>(factor, 1, 0);
    });
    CHECK((simulation.state().q - start).lpNorm<Eigen::Infinity>() < 1e-11);
    CHECK(simulation.state().v.norm() < 1e-11);
    CHECK(cached_floor_force(simulation.state()).z() == Approx(weight(body)).epsilon(1e-9));
  }
  CHECK(simulation.step_counters().contact_fallbacks == 0);
}

TEST_CASE("an isolated contact does not start from the contact cache, whatever its force", "[contact]") {
  MultiBody body;
  body.add(make_part("ball", "sphere", {}, 1000)).rest({{"r", kHalf}}).place({0, 0, kHalf});
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  Simulation simulation(body, "rk4");
  for (const double force : {1e3, 1e12, 1e300}) {
    State state = simulation.state();
    state.contact_cache = {{{0, -1, 0, -1}, {0, 0, -kHalf}, {0, 0, force}}};
    simulation.set_state(state);
    simulation.step(kStep);
    CHECK(simulation.state().v.norm() < 1e-12);
    REQUIRE(simulation.state().contact_cache.size() == 1);  // stored to predict its impulse
    CHECK(simulation.state().contact_cache[0].force.z() == Approx(weight(body)).epsilon(1e-9));
  }
}

TEST_CASE("the cache stores the mean force of a step, also if the step is divided", "[contact]") {
  // Two boxes are at rest while a ball bounces beside them.
  MultiBody body;
  body.contact.restitution = 0.8;
  for (int i = 0; i < 2; ++i)
    body.add(make_part("box" + std::to_string(i), "box", {}, 1000))
        .rest({{"a1", kHalf}, {"a2", kHalf}, {"a3", kHalf}})
        .place({0.03 * i, 0, kHalf * (2 * i + 1)});
  Part& ball = body.add(make_part("ball", "sphere", {}, 1000));
  ball.rest({{"r", 0.05}}).place({1, 0, 0.3}).velocity({0, 0, -1}, {});
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  const double tolerance = GENERATE(0.0, 1e-5);
  Simulation simulation(body, tolerance > 0 ? "dormand_prince" : "rk4", 1, tolerance);
  const double expected_force = weight(body) - ball.total_mass() * body.gravity_at(0).norm();
  int cached_steps = 0, steps = 0;
  for (; simulation.time() < 1; ++steps) {
    if (tolerance > 0)
      simulation.step_up_to(1);
    else
      simulation.step(kStep);
    const State& state = simulation.state();
    if (state.contact_cache.empty()) continue;  // a step that ends at once, at an impact, stores no forces
    ++cached_steps;
    CHECK(state.contact_cache.size() == 8);
    CHECK(cached_floor_force(state).z() == Approx(expected_force).epsilon(1e-9));
  }
  CHECK(4 * cached_steps >= 3 * steps);
  CHECK(simulation.step_counters().impacts >= 3);
}

TEST_CASE("invalid contact caches are refused", "[contact]") {
  MultiBody body;
  pyramid(body, 2);
  Simulation simulation(body, "rk4");
  simulation.step(kStep);
  const State good = simulation.state();
  REQUIRE(good.contact_cache.size() > 1);
  auto refuses = [&](const std::string& words, auto&& change) {
    State bad = good;
    change(bad.contact_cache);
    CHECK_THROWS_WITH(simulation.set_state(bad), test::has_text(words));
    CHECK(hash(simulation.state()) == hash(good));
  };
  using Cache = std::vector<CachedContact>;
  refuses("not finite", [](Cache& all) { all[1].force[2] = std::nan(""); });
  refuses("not finite", [](Cache& all) { all[0].x[0] = HUGE_VAL; });
  refuses("another model", [](Cache& all) { all[0].between[0] = 3; });
  refuses("another model", [](Cache& all) { all[0].between[2] = -2; });
  refuses("not sorted", [](Cache& all) { std::swap(all.front(), all.back()); });
  State old = good;
  old.contact_cache_age = -1;
  CHECK_THROWS_WITH(simulation.set_state(old), test::has_text("negative age"));
  State none = good;
  none.contact_cache.clear();
  none.contact_cache_age = 7;
  simulation.set_state(none);
  CHECK(simulation.state().contact_cache_age == 0);
}

TEST_CASE("cached forces that overflow are not used", "[contact]") {
  MultiBody body;
  for (int i = 0; i < 2; ++i)
    body.add(make_part("box" + std::to_string(i), "box", {}, 1e-3))
        .rest({{"a1", kHalf}, {"a2", kHalf}, {"a3", kHalf}})
        .place({0, 0, kHalf * (2 * i + 1)});
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  Simulation simulation(body, "rk4");
  simulation.step(kStep);
  State overflowing = simulation.state();
  for (CachedContact& cached : overflowing.contact_cache) cached.force.setConstant(1e308);
  simulation.set_state(overflowing);
  simulation.step(kStep);
  CHECK(simulation.state().v.norm() < 1e-11);
  CHECK(cached_floor_force(simulation.state()).z() == Approx(weight(body)).epsilon(1e-9));
}

/// Adds a floor, a soft solid on the floor, and a box on the solid, near equilibrium.
void cushion(MultiBody& body) {
  auto& part = body.add<Primitive<Superellipsoid>>("cushion", 200.0);
  part.rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.1}, {"eps1", 0.5}, {"eps2", 0.5}}).place({0, 0, 0.1});
  LocalSettings settings;
  settings.resolution = 2;
  settings.alpha = 20;
  settings.beta = 0.01;
  settings.energies = {local_law("neo_hookean", {1e5, 0.4})};
  part.deform_locally(settings);
  body.add<Primitive<Box>>("box", 300.0).rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.05}}).place({0, 0, 0.2502});
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}

TEST_CASE("the contact cache works for a part on a soft part with an implicit method", "[contact][long]") {
  MultiBody body;
  cushion(body);
  Simulation warm(body, "linearly_implicit"), cold(body, "linearly_implicit");
  for (int i = 0; i < 300; ++i) warm.step(1e-3);
  CHECK(warm.contact()->contacts().size() > 15);
  CHECK(warm.step_counters().contact_fallbacks == 0);
  cold.set_state(warm.state());
  const long warm_sweeps = sweeps(
                 warm, 22, [](State&) {}, 1e-3),
             cold_sweeps = sweeps(cold, 22, clear_cache, 1e-3);
  CAPTURE(warm_sweeps, cold_sweeps);
  CHECK(cold_sweeps >= 22);
  // A step with soft contact is computed as a whole step and as two halves. The second half starts from the
  // cache of the first half even if the cache of the state is cleared.
  CHECK(3 * warm_sweeps < 2 * cold_sweeps);
  CHECK((warm.state().q - cold.state().q).lpNorm<Eigen::Infinity>() < 1e-9);
  CHECK(cached_floor_force(warm.state()).z() == Approx(weight(body)).epsilon(1e-2));
  Simulation other(body, "linearly_implicit");
  other.set_state(warm.state());
  for (int i = 0; i < 5; ++i) {
    warm.step(1e-3);
    other.step(1e-3);
    REQUIRE(hash(warm.state()) == hash(other.state()));
  }
}

TEST_CASE("contacts that act on nodes are not cached", "[contact]") {
  MultiBody body;
  cushion(body);
  body.parts()[1]->place({0, 0, 0.245});
  Simulation simulation(body, "semi_implicit_euler");
  for (int i = 0; i < 5; ++i) {
    simulation.step(1e-4);
    const std::vector<Contact>& contacts = simulation.contact()->contacts();
    CHECK(std::count_if(contacts.begin(), contacts.end(),
                        [](const Contact& contact) { return contact.b.part == 1; }) > 1);
    CHECK(simulation.state().contact_cache.empty());
  }
}

TEST_CASE("cached forces without a load disappear", "[contact]") {
  // A box fits between two walls. The cache contains forces with which the walls pressed on the box.
  MultiBody body;
  body.contact.friction = 0.5;
  body.add(make_part("box", "box", {}, 1000)).rest({{"a1", kHalf}, {"a2", kHalf}, {"a3", kHalf}});
  body.plane("left", Vec3<double>(-kHalf, 0, 0), {1, 0, 0});
  body.plane("right", Vec3<double>(kHalf, 0, 0), {-1, 0, 0});
  Simulation simulation(body, "rk4");
  State state = simulation.state();
  for (const int plane : {0, 1})
    for (const double y : {-kHalf, kHalf})
      for (const double z : {-kHalf, kHalf})
        state.contact_cache.push_back({{0, -1, plane, -1},
                                       Vec3<double>((plane == 0 ? -1 : 1) * kHalf, y, z),
                                       Vec3<double>((plane == 0 ? 1 : -1) * 1000, 0, weight(body) / 8)});
  simulation.set_state(state);
  for (int i = 0; i < 200; ++i) simulation.step(kStep);
  const double fall_time = 200 * kStep - 12 * kStep;  // the first steps start warm and are not counted
  CHECK(simulation.state().q[2] < -0.5 * body.gravity_at(0).norm() * fall_time * fall_time);
}

TEST_CASE("isolated contacts are cached only if impulses are predicted, and lost contacts are removed",
          "[contact]") {
  const bool predicts = GENERATE(false, true);  // impulses are predicted with fixed steps only
  MultiBody body;
  for (int i = 0; i < 3; ++i) {
    Part& part = body.add(make_part("ball" + std::to_string(i), "sphere", {}, 1000));
    part.rest({{"r", 0.1}}).place({1.0 * i, 0, 0.1});
  }
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  Part& box = body.add(make_part("box", "box", {}, 1000));
  box.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}}).place({0, 3, 0.1});
  Simulation simulation(body, predicts ? "rk4" : "dop853", 1, predicts ? 0 : 1e-3);
  for (int i = 0; i < 5; ++i) simulation.step(kStep);
  CHECK(simulation.contact()->contacts().size() > 3);
  const std::size_t balls = predicts ? 3 : 0;
  const std::vector<CachedContact>& cache = simulation.state().contact_cache;
  REQUIRE(cache.size() > balls + 1);  // contacts at the corners of the box
  for (std::size_t i = 0; i < cache.size(); ++i) {
    CHECK(cache[i].between[0] == (i < balls ? static_cast<int>(i) : 3));
    CHECK(cache[i].lasting == predicts);
  }
  State up = simulation.state();
  up.q[simulation.model().parts()[3].q0 + 2] += 1;
  simulation.set_state(up);
  simulation.step(kStep);
  CHECK(simulation.state().contact_cache.size() == balls);
}

TEST_CASE("a run resumed from a state with its contact cache gives identical bits", "[contact]") {
  MultiBody body;
  pyramid(body, 4);
  Simulation one(body, "rk4"), other(body, "rk4");
  for (int i = 0; i < 20; ++i) one.step(kStep);
  other.set_state(one.state());
  for (int i = 0; i < 10; ++i) {
    one.step(kStep);
    other.step(kStep);
    REQUIRE(hash(one.state()) == hash(other.state()));
  }
  State shortened = one.state();
  shortened.contact_cache.pop_back();
  CHECK(hash(shortened) != hash(one.state()));
}

}  // namespace contact_cache_test
