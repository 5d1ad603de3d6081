// Contacts of pairs in which a part is not convex. The least gap is the least distance of densely sampled
// surfaces. At the contact both surfaces have the contact normal. Contacts depend neither on the order of the
// parts nor on earlier searches. Contacts of parts that lie on each other are the corners or ends of their
// common face or edge.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/collision/find_contacts.h>
#include <pliant/part/mesh/surface.h>
#include <pliant/part/registry.h>

#include "draws.h"
#include "solid_kind.h"
#include "worst.h"

namespace feature_pairs_test {

using namespace pliant;
using test::Draws;
using test::random_rotation;
using test::Worst;
using Kind = test::SolidKind;

namespace {

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"torus", "supertoroid", {}, {{"a1", 0.02}, {"a2", 0.02}, {"a3", 0.02}, {"a4", 3}}, true},
      {"oval torus", "supertoroid", {}, {{"a1", 0.02}, {"a2", 0.03}, {"a3", 0.025}, {"a4", 3}}, true},
      {"supertoroid",
       "supertoroid",
       {},
       {{"a1", 0.02}, {"a2", 0.02}, {"a3", 0.03}, {"a4", 3}, {"eps1", 0.8}, {"eps2", 1.2}},
       true},
      {"bent capsule", "capsule", {"bend"}, {{"r", 0.05}, {"l", 0.08}, {"bend.angle", 0.5}}, true},
      {"banana", "ellipsoid", {"bend"}, {{"a1", 0.04}, {"a2", 0.04}, {"a3", 0.2}, {"bend.angle", 1.2}}, true},
      {"twisted ellipsoid",
       "ellipsoid",
       {"twist"},
       {{"a1", 0.1}, {"a2", 0.04}, {"a3", 0.2}, {"twist.angle", 1.2}},
       true},
      {"twisted box", "box", {"twist"}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.08}, {"twist.angle", 0.5}}},
      {"bent cylinder",
       "cylinder",
       {"bend"},
       {{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.1}, {"bend.angle", 0.7}}}};
  return all;
}

/// Two solids that may touch. The tests search for contacts only; nothing moves.
struct Pair {
  Pair(const Kind& a, const Kind& b)
      : part_a(body.add(make_part("a", a.shape, a.chain, 1000)).rest(a.rest)),
        part_b(body.add(make_part("b", b.shape, b.chain, 1000)).rest(b.rest)) {
    body.contact.between_parts = true;
  }
  MultiBody body;
  Part &part_a, &part_b;
};

Eigen::Matrix3Xd surface_points(const Part& part) {
  return part.s(Surface(part, 8).material(), part.parameters().rest());
}

/// The least distance between sample points of two surfaces a and b, m, and the vector from the nearest point
/// of a to the nearest point of b, m.
struct Nearest {
  double distance = std::numeric_limits<double>::infinity();
  Vec3<double> difference = Vec3<double>::Zero();
};
Nearest nearest(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  Nearest best;
  for (Eigen::Index i = 0; i < a.cols(); ++i) {
    Eigen::Index j = 0;
    const double square = (b.colwise() - a.col(i)).colwise().squaredNorm().minCoeff(&j);
    if (square < best.distance * best.distance) best = {std::sqrt(square), b.col(j) - a.col(i)};
  }
  return best;
}

/// Places the parts at random so that the nearest sample points of their surfaces are about `apart` (m)
/// apart. Returns the distance of these two points.
double place_near(Pair& pair, Draws& draws, double apart) {
  const Eigen::Quaterniond R_a = random_rotation(draws), R_b = random_rotation(draws);
  const Eigen::Matrix3Xd a = R_a.toRotationMatrix() * surface_points(pair.part_a),
                         b = R_b.toRotationMatrix() * surface_points(pair.part_b);
  Vec3<double> c = 0.6 * draws.vector(1).normalized();
  for (int k = 0; k < 6; ++k) {
    const Nearest now = nearest(a, b.colwise() + c);
    c -= (now.distance - apart) * now.difference.normalized();
  }
  pair.part_a.place({0, 0, 0}, R_a);
  pair.part_b.place(c, R_b);
  return nearest(a, b.colwise() + c).distance;
}

std::vector<Contact> contacts_of(Pair& pair, double max_gap) {
  const Model model(pair.body);
  return ContactFinder(model).find(model.initial_state(), 0, max_gap);
}

double least_gap(const std::vector<Contact>& found) {
  double gap = 1;
  for (const Contact& contact : found) gap = std::min(gap, contact.gap);
  return gap;
}

}  // namespace

TEST_CASE("the least gap of two solids that are not convex is the least distance of their surfaces",
          "[contact][long]") {
  constexpr double kApart = 0.01;
  Draws draws(5);
  for (const Kind& a : kinds())
    for (const Kind& b : kinds()) {
      CAPTURE(a.name, b.name);
      Worst above, below;
      for (int trial = 0; trial < 3; ++trial) {
        Pair pair(a, b);
        const double sampled = place_near(pair, draws, kApart);
        const double gap = least_gap(contacts_of(pair, 2 * kApart));
        above.note(gap - sampled);
        below.note(sampled - gap);
      }
      CHECK(above < 1e-12);
      CHECK(below < 2.5e-3);  // neighbouring samples of one surface are about 1 cm apart
    }
}

TEST_CASE(
    "smooth solids that are not convex, moved together by their gap, have a contact with gap 0 and opposite "
    "normals",
    "[contact][long]") {
  Draws draws(6);
  for (const Kind& a : kinds())
    for (const Kind& b : kinds()) {
      if (!a.is_smooth || !b.is_smooth) continue;
      CAPTURE(a.name, b.name);
      Worst gaps, turned;
      for (int trial = 0; trial < 5; ++trial) {
        Pair pair(a, b);
        place_near(pair, draws, 0.005);
        const std::vector<Contact> apart = contacts_of(pair, 0.01);
        REQUIRE(!apart.empty());
        const Contact& first =
            *std::min_element(apart.begin(), apart.end(),
                              [](const Contact& one, const Contact& other) { return one.gap < other.gap; });
        pair.part_a.place(pair.part_a.c0() - first.gap * first.normal, pair.part_a.R0());
        const std::vector<Contact> found = contacts_of(pair, 1e-3);
        double closed = 1;
        for (const Contact& contact : found) closed = std::min(closed, std::abs(contact.gap));
        gaps.note(closed);
        for (const Contact& contact : found) {
          if (std::abs(contact.gap) > 1e-9) continue;
          const ParameterValues<double> of_a = pair.part_a.parameters().rest(),
                                        of_b = pair.part_b.parameters().rest();
          turned.note(
              (pair.part_a.R0() * pair.part_a.normal(contact.a.material, of_a) + contact.normal).norm());
          turned.note(
              (pair.part_b.R0() * pair.part_b.normal(contact.b.material, of_b) - contact.normal).norm());
        }
      }
      CHECK(gaps < 1e-11);
      CHECK(turned < 1e-6);
    }
}

TEST_CASE("contacts of two solids that are not convex do not depend on the order of the parts",
          "[contact][long]") {
  Draws draws(7);
  for (const Kind& a : kinds())
    for (const Kind& b : kinds()) {
      CAPTURE(a.name, b.name);
      Worst difference;
      for (int trial = 0; trial < 2; ++trial) {
        Pair pair(a, b), exchanged(b, a);
        place_near(pair, draws, 0.004);
        exchanged.part_a.place(pair.part_b.c0(), pair.part_b.R0());
        exchanged.part_b.place(pair.part_a.c0(), pair.part_a.R0());
        const std::vector<Contact> found = contacts_of(pair, 0.006), other = contacts_of(exchanged, 0.006);
        REQUIRE(found.size() == other.size());
        for (const Contact& one : found) {
          double least = 1;
          for (const Contact& two : other)
            least = std::min(least, std::abs(one.gap - two.gap) + (one.normal + two.normal).norm());
          difference.note(least);
        }
      }
      CHECK(difference < 1e-7);
    }
}

TEST_CASE("contacts of solids that are not convex do not depend on earlier searches", "[contact]") {
  Draws draws(8);
  for (const Kind& kind : kinds()) {
    CAPTURE(kind.name);
    Pair pair(kind, kinds().front());
    place_near(pair, draws, 0.004);
    const Model model(pair.body);
    const State state = model.initial_state();
    const ContactFinder finder(model), fresh(model);
    State moved = state;
    for (int k = 0; k < 20; ++k) {  // small motions, for which candidates of the search are kept
      moved.q.head<3>() += draws.vector(1e-3);
      finder.find(moved, 0, 0.006);
    }
    const std::vector<Contact> found = finder.find(state, 0, 0.006), expected = fresh.find(state, 0, 0.006);
    REQUIRE(found.size() == expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      CHECK(found[k].gap == expected[k].gap);
      CHECK(found[k].x == expected[k].x);
      CHECK(found[k].normal == expected[k].normal);
    }
  }
}

TEST_CASE("solids that are not convex lie on each other on several points around the middle", "[contact]") {
  const Kind torus = kinds()[0], twisted_box = kinds()[6];
  const Kind box{"box", "box", {}, {{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.1}}};
  struct Stack {
    const Kind &lower, &upper;
    double height;  ///< height of the origin of the upper part above the origin of the lower part, m
  };
  for (const Stack& stack : {Stack{twisted_box, twisted_box, 0.16}, Stack{torus, torus, 0.04},
                             Stack{box, torus, 0.12}, Stack{box, twisted_box, 0.18}}) {
    CAPTURE(stack.lower.name, stack.upper.name);
    Pair pair(stack.lower, stack.upper);
    pair.part_a.place({0, 0, 0});
    pair.part_b.place({0, 0, stack.height});
    const std::vector<Contact> found = contacts_of(pair, 1e-9);
    CHECK(found.size() >= 4);
    CHECK(found.size() <= 8);
    Vec3<double> least = Vec3<double>::Zero(), most = least;
    for (const Contact& contact : found) {
      CHECK(std::abs(contact.gap) < 1e-12);
      CHECK((contact.normal + Vec3<double>::UnitZ()).norm() < 1e-9);
      least = least.cwiseMin(contact.x);
      most = most.cwiseMax(contact.x);
    }
    CHECK((-least).head<2>().minCoeff() > 0.04);
    CHECK(most.head<2>().minCoeff() > 0.04);
  }
}

TEST_CASE("no contact of edges is found between separate solids", "[contact][long]") {
  // Two tapered and twisted boxes, about 2 cm apart. The gap along a common normal of two of their edges can
  // be negative although the solids are separate.
  const Kind wedge{"wedge",
                   "box",
                   {"taper", "twist"},
                   {{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}, {"taper.tx", -0.9}, {"twist.angle", 0.3}}};
  Draws draws(9);
  int apart = 0;
  for (int trial = 0; trial < 40; ++trial) {
    Pair pair(wedge, wedge);
    if (place_near(pair, draws, 0.02) < 0.015) continue;
    ++apart;
    CHECK(least_gap(contacts_of(pair, 1e-3)) == 1);
  }
  CHECK(apart > 10);
}

TEST_CASE("the least gap of two supertoroids is not larger than the sampled distance of their surfaces",
          "[contact][long]") {
  // For exponents up to 1.4, common normals find the contacts; above 1.4, a search on both surfaces does.
  Draws draws(11);
  for (const double exponent : {0.65, 1.3, 1.5, 1.8}) {
    CAPTURE(exponent);
    const Kind ring{
        "ring",
        "supertoroid",
        {},
        {{"a1", 0.02}, {"a2", 0.02}, {"a3", 0.03}, {"a4", 3}, {"eps1", exponent}, {"eps2", exponent}}};
    Worst above;
    for (int trial = 0; trial < 12; ++trial) {
      Pair pair(ring, ring);
      const double sampled = place_near(pair, draws, 0.004);
      above.note(least_gap(contacts_of(pair, 0.01)) - sampled);
    }
    CHECK(above < (exponent > 1.4 ? 2e-3 : 1e-12));
  }
}

TEST_CASE("solids with a full taper touch another part", "[contact][long]") {
  const Part::Named taper{{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}, {"taper.tx", -1}, {"taper.ty", -1}};
  const Kind pyramid{"pyramid", "box", {"taper"}, taper}, drop{"drop", "ellipsoid", {"taper"}, taper};
  for (const Kind* kind : {&pyramid, &drop})
    for (const Kind* other : {&kinds()[0], &kinds()[6]}) {
      CAPTURE(kind->name, other->name);
      Draws draws(12);
      Worst above, below;
      for (int trial = 0; trial < 8; ++trial) {
        Pair pair(*kind, *other);
        const double sampled = place_near(pair, draws, 0.004), gap = least_gap(contacts_of(pair, 0.02));
        above.note(gap - sampled);
        below.note(sampled - gap);
      }
      CHECK(above < 2e-3);
      CHECK(below < 4e-3);
    }
}

TEST_CASE("two tori that overlap by less or more than half their thickness touch", "[contact]") {
  const Kind& torus = kinds()[0];  // a tube of radius 0.02 m
  for (const double overlap : {0.4, 0.7}) {
    CAPTURE(overlap);
    Pair on_top(torus, torus);
    on_top.part_b.place({0, 0, 0.04 * (1 - overlap)});
    CHECK(least_gap(contacts_of(on_top, 1e-3)) < 0);
    Pair beside(torus, torus);
    beside.part_b.place({0.16 - 0.04 * overlap, 0, 0});
    CHECK(least_gap(contacts_of(beside, 1e-3)) < 0);
    Pair crossed(torus, torus);  // the rings cross at two points
    crossed.part_b.place({0.06, 0, 0.04 * (1 - overlap)});
    CHECK(least_gap(contacts_of(crossed, 1e-3)) < 0);
  }
}

TEST_CASE("a vertex touches a hollow face only within the radius of curvature of the face", "[contact]") {
  // The hole of a ring is a hollow face, and its radius of curvature is 0.04 m. A small box is in the hole,
  // and one of its corners points across the hole. Among the points of the inner circle ahead of the corner,
  // the point straight ahead has the largest distance from the corner, not the least.
  const Kind cube{"cube", "box", {}, {{"a1", 0.004}, {"a2", 0.004}, {"a3", 0.004}}};
  Pair pair(cube, kinds()[0]);
  pair.part_a.place({-0.02, 0, 0},
                    Eigen::Quaterniond::FromTwoVectors(Vec3<double>(1, 1, 1), Vec3<double>::UnitX()));
  const std::vector<Contact> found = contacts_of(pair, 0.06);
  CHECK(least_gap(found) < 0.02);
  for (const Contact& contact : found) CHECK(contact.gap < 0.04);
}

TEST_CASE("all overlapping contacts of two tori are kept, but at most eight contacts without overlap",
          "[contact]") {
  Pair pair(kinds()[0], kinds()[0]);
  for (const double overlap : {0.0, 1e-3}) {
    pair.part_b.place({0, 0, 0.04 - overlap});
    const std::size_t count = contacts_of(pair, 1e-9).size();
    CAPTURE(overlap, count);
    CHECK((count > 8) == (overlap > 0));
  }
}

}  // namespace feature_pairs_test
