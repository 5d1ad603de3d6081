// If few parts have moved, the search for resting contacts is repeated only near these parts. The result
// equals that of a search of all parts, bit for bit and in the same order.
#include "catch.h"

#include <pliant/contact/resting_contacts.h>
#include <pliant/part/registry.h>

#include "draws.h"

namespace resting_contacts_test {

using namespace pliant;
using test::Draws;

namespace {

bool equal(const Contact& one, const Contact& other) {
  return one.a.part == other.a.part && one.b.part == other.b.part && one.plane == other.plane &&
         one.obstacle == other.obstacle && one.x == other.x && one.normal == other.normal &&
         one.gap == other.gap && one.a.material.su.x == other.a.material.su.x &&
         one.b.material.cv.x == other.b.material.cv.x;
}

/// Adds 60 overlapping parts of three shapes, two planes, and an obstacle of one triangle.
void overlapping_bodies(MultiBody& body, Draws& draws) {
  for (int i = 0; i < 60; ++i) {
    const char* shape = i % 3 == 0 ? "ellipsoid" : i % 3 == 1 ? "box" : "capsule";
    Part& part = body.add(make_part("part" + std::to_string(i), shape, {}, 1000));
    if (i % 3 == 2)
      part.rest({{"r", 0.07}, {"l", 0.1}});
    else
      part.rest({{"a1", 0.1}, {"a2", 0.08}, {"a3", 0.06}});
    if (i % 9 == 0) part.stiffness({{"a1", 1e4}});
    part.place(
        {draws.uniform(-0.4, 0.4), draws.uniform(-0.4, 0.4), draws.uniform(0, 0.4)},
        Eigen::Quaterniond(1, draws.uniform(-1, 1), draws.uniform(-1, 1), draws.uniform(-1, 1)).normalized());
  }
  body.contact.active = body.contact.between_parts = true;
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  body.plane("wall", Vec3<double>(-0.4, 0, 0), {1, 0, 0});
  ContactObstacle step;
  step.name = "step";
  step.vertices.resize(3, 3);
  step.vertices << 0, 1, 0, 0, 0, 1, 0.1, 0.1, 0.1;
  step.triangles.resize(3, 1);
  step.triangles << 0, 1, 2;
  body.contact.obstacles.push_back(step);
}

}  // namespace

TEST_CASE("an incremental search for resting contacts agrees with a full search", "[contact]") {
  Draws draws(5);
  MultiBody body;
  overlapping_bodies(body, draws);
  const Model model(body);
  const ContactFinder finder(model);
  RestingContacts resting(model, finder);
  State state = model.initial_state();
  std::size_t max_contacts = 0;
  for (const int moving : {0, 1, 2, 5, 20, 41, 43, 60, 1}) {
    for (int k = 0; k < moving; ++k) {
      const PartModel& m = model.parts()[static_cast<std::size_t>((7 * k + moving) % 60)];
      if (k % 2 == 0)
        for (int axis = 0; axis < 3; ++axis) state.q[m.q0 + axis] += draws.uniform(-0.03, 0.03);
      else
        state.q.segment<4>(m.q0 + 3) =
            Eigen::Quaterniond(1, draws.uniform(-1, 1), draws.uniform(-1, 1), 0).normalized().coeffs();
      if (m.n_s > 0) state.q[m.q0 + 7] = draws.uniform(0.08, 0.12);
    }
    if (moving == 20) finder.find(state, 0.5, 0.3);  // a search with a wider gap than later searches
    const std::vector<Contact> before = resting.near(state, 0.5),
                               all = ContactFinder(model).find(state, 0.5, resting.gap());
    REQUIRE(before.size() == all.size());
    for (std::size_t i = 0; i < all.size(); ++i) CHECK(equal(before[i], all[i]));
    max_contacts = std::max(max_contacts, all.size());
  }
  CHECK(max_contacts > 100);
}

}  // namespace resting_contacts_test
