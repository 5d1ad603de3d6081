// Contacts of tapered, twisted and bent solids. Over a plane the lowest contact point is the lowest point of
// the surface, and smooth solids have the normal of the plane there. The gap of convex pairs is the largest
// separation over all normals.
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

namespace curved_solids_test {

using namespace pliant;
using test::Draws;
using test::random_rotation;
using test::Worst;
using Kind = test::SolidKind;

namespace {

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"tapered ellipsoid",
       "ellipsoid",
       {"taper"},
       {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}, {"taper.tx", 0.5}, {"taper.ty", -0.3}},
       true},
      {"twisted ellipsoid",
       "ellipsoid",
       {"twist"},
       {{"a1", 0.1}, {"a2", 0.04}, {"a3", 0.2}, {"twist.angle", 1.2}},
       true},
      {"banana", "ellipsoid", {"bend"}, {{"a1", 0.04}, {"a2", 0.04}, {"a3", 0.2}, {"bend.angle", 1.2}}, true},
      {"tapered, sheared and bent superellipsoid",
       "superellipsoid",
       {"taper", "shear", "bend"},
       {{"a1", 0.1},
        {"a2", 0.07},
        {"a3", 0.15},
        {"eps1", 1.3},
        {"eps2", 1.2},
        {"taper.tx", 0.3},
        {"shear.sx", 0.2},
        {"bend.angle", 0.5}},
       true},
      {"bent capsule", "capsule", {"bend"}, {{"r", 0.04}, {"l", 0.2}, {"bend.angle", 0.8}}, true},
      {"bent rod", "capsule", {"bend"}, {{"r", 0.002}, {"l", 1}, {"bend.angle", 1}}, true},
      {"tapered cylinder",
       "cylinder",
       {"taper"},
       {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}, {"taper.tx", 0.4}}},
      {"bent cylinder",
       "cylinder",
       {"bend"},
       {{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.15}, {"bend.angle", 0.7}}},
      {"tapered cone",
       "cone",
       {"taper"},
       {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}, {"t", -0.5}, {"taper.tx", 0.3}}},
      {"tapered box", "box", {"taper"}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}, {"taper.tx", -0.4}}},
      {"twisted box", "box", {"twist"}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.15}, {"twist.angle", 0.5}}},
      {"much twisted box", "box", {"twist"}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.4}, {"twist.angle", 3}}},
      {"much twisted ellipsoid",
       "ellipsoid",
       {"twist"},
       {{"a1", 0.1}, {"a2", 0.04}, {"a3", 0.4}, {"twist.angle", 5}},
       true},
      {"slender tapered ellipsoid",
       "ellipsoid",
       {"taper"},
       {{"a1", 0.004}, {"a2", 0.004}, {"a3", 0.2}, {"taper.tx", 0.9}, {"taper.ty", 0.9}},
       true},
      {"bent and twisted box",
       "box",
       {"bend", "twist"},
       {{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.2}, {"bend.angle", 1.2}, {"twist.angle", 1.2}}},
      {"bent box", "box", {"bend"}, {{"a1", 0.05}, {"a2", 0.05}, {"a3", 0.2}, {"bend.angle", 1}}}};
  return all;
}

/// Adds a part of a kind. dynamic: whether its sizes and the parameters of its chain are degrees of freedom.
Part& add(MultiBody& body, const Kind& kind, bool dynamic) {
  Part& part = body.add(make_part("a", kind.shape, kind.chain, 1000));
  part.rest(kind.rest);
  if (dynamic) {
    Part::Named stiffness;
    for (const auto& [name, value] : kind.rest)
      if (name.rfind("eps", 0) != 0 && name != "t") stiffness.push_back({name, 1000});
    part.stiffness(stiffness);
  }
  return part;
}

}  // namespace

TEST_CASE("the lowest contact point of a curved solid over a plane is the lowest point of its surface",
          "[contact][long]") {
  Draws draws(3);
  for (const Kind& kind : kinds()) {
    MultiBody only;
    const Part& sampled_part = add(only, kind, false);
    const Surface surface(sampled_part, 40);
    const Eigen::Matrix3Xd points = sampled_part.s(surface.material(), sampled_part.parameters().rest());
    for (const bool dynamic : {false, true}) {
      CAPTURE(kind.name, dynamic);
      Worst above, below, off_surface, turned;
      MultiBody body;
      body.contact.active = true;
      body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
      const Part& part = add(body, kind, dynamic).place({0.1, 0.2, 0.3});
      const Model model(body);
      const ContactFinder finder(model);
      State state = model.initial_state();
      for (int trial = 0; trial < 40; ++trial) {
        const Eigen::Quaterniond R = random_rotation(draws);
        state.q.segment<4>(3) << R.w(), R.x(), R.y(), R.z();
        const std::vector<Contact> found = finder.find(state, 0, 1);
        REQUIRE(!found.empty());
        const ParameterValues<double> values = part.parameters().rest();
        double lowest = std::numeric_limits<double>::infinity();
        for (const Contact& contact : found) lowest = std::min(lowest, contact.gap);
        for (const Contact& contact : found) {
          const Vec3<double> p = R.inverse() * (contact.x - Vec3<double>(0.1, 0.2, 0.3));
          off_surface.note((part.s({contact.a.material}, values).col(0) - p).norm());
          if (contact.gap > lowest) continue;
          off_surface.note(std::abs(part.inside_outside(p, values)));
          if (kind.is_smooth)
            turned.note((R * part.normal(contact.a.material, values) + Vec3<double>::UnitZ()).norm());
        }
        const double sampled = 0.3 + (R.toRotationMatrix().row(2) * points).minCoeff();
        above.note(lowest - sampled);
        below.note(sampled - lowest);
      }
      CHECK(above < 1e-12);
      CHECK(below < 5e-4);
      CHECK(off_surface < 1e-9);
      CHECK(turned < 1e-7);
    }
  }
}

namespace {

/// Returns the largest value of f(angle) by sampling and golden sections.
template <class F>
double largest_on_circle(const F& f) {
  constexpr int kSamples = 64;
  int best = 0;
  for (int k = 1; k < kSamples; ++k)
    if (f(2 * kPi * k / kSamples) > f(2 * kPi * best / kSamples)) best = k;
  double from = 2 * kPi * (best - 1) / kSamples, to = 2 * kPi * (best + 1) / kSamples;
  while (to - from > 1e-9) {
    const double one = from + 0.382 * (to - from), other = from + 0.618 * (to - from);
    (f(one) > f(other) ? to : from) = f(one) > f(other) ? other : one;
  }
  return f(0.5 * (from + to));
}

/// Returns the largest value of m . x over the points x of a part, m, without derivatives of the support
/// function. The candidates are the corners of a box, the rims of a cylinder, and for other shapes the
/// results of a pattern search on the surface from the best sample point.
double support(const Part& part, const Vec3<double>& m) {
  const ParameterValues<double> values = part.parameters().rest();
  auto height_of = [&](const Material<double>& material) { return m.dot(part.s({material}, values).col(0)); };
  auto height_at = [&](const Vec3<double>& e) { return height_of(part.shape().label(e, values.b.data())); };
  const std::string shape = part.shape().name();
  if (shape == "box") {
    double best = -1;
    for (int corner = 0; corner < 8; ++corner)
      best = std::max(best, height_at(part.shape().support(m, values.b.data(), corner)));
    return best;
  }
  if (shape == "cylinder") {
    auto on_rim = [&](int piece) {
      return largest_on_circle([&](double angle) {
        const Vec3<double> out(std::cos(angle), std::sin(angle), 0);
        return height_at(part.shape().support(out, values.b.data(), piece));
      });
    };
    return std::max(on_rim(0), on_rim(1));
  }
  const Surface surface(part, 6);
  const Eigen::VectorXd heights = part.s(surface.material(), values).transpose() * m;
  Eigen::Index first = 0;
  double best = heights.maxCoeff(&first);
  Vec3<double> direction = surface.places()[static_cast<std::size_t>(first)].normalized();
  for (double width = 0.1; width > 1e-9; width *= 0.5) {
    bool better = true;
    while (better) {
      better = false;
      const Vec3<double> e1 = direction.unitOrthogonal(), e2 = direction.cross(e1);
      for (int k = 0; k < 8; ++k) {
        const double angle = 2 * kPi * k / 8;
        const Vec3<double> next =
            (direction + width * (std::cos(angle) * e1 + std::sin(angle) * e2)).normalized();
        if (const double h = height_of(part.shape().mesh_label(next, values.b.data())); h > best) {
          best = h;
          direction = next;
          better = true;
        }
      }
    }
  }
  return best;
}

}  // namespace

TEST_CASE("the gap of convex pairs of tapered and bent solids is the largest separation over all normals",
          "[contact][long]") {
  const Part::Named axes{{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.05}};
  auto with = [](Part::Named rest, const char* name, double value) {
    rest.emplace_back(name, value);
    return rest;
  };
  const std::vector<Kind> convex{
      {"tapered ellipsoid", "ellipsoid", {"taper"}, with(axes, "taper.tx", 0.3), true},
      {"bent ellipsoid", "ellipsoid", {"bend"}, with(axes, "bend.angle", 0.2), true},
      {"tapered capsule",
       "capsule",
       {"taper"},
       {{"r", 0.05}, {"l", 0.1}, {"taper.tx", 0.2}, {"taper.ty", 0.2}}},
      {"tapered cylinder", "cylinder", {"taper"}, with(with(axes, "taper.tx", 0.4), "taper.ty", 0.4)},
      {"tapered box", "box", {"taper"}, with(axes, "taper.tx", -0.4)}};
  const std::vector<Kind> others{{"ball", "sphere", {}, {{"r", 0.05}}}, {"box", "box", {}, axes}};
  Draws draws(9);
  for (const Kind& a : convex)
    for (const Kind* b : {&others[0], &others[1], &convex[0], &a}) {
      CAPTURE(a.name, b->name);
      Worst value, better;
      for (int trial = 0; trial < 4; ++trial) {
        const Eigen::Quaterniond R_a = random_rotation(draws), R_b = random_rotation(draws);
        // The parts are separate, or overlap a little.
        Vec3<double> to_b = draws.vector(1).normalized();
        MultiBody body;
        body.contact.between_parts = true;
        Part& part_a = add(body, a, trial == 0 && a.is_smooth).place({0, 0, 0}, R_a);
        Part& part_b = body.add(make_part("b", b->shape, b->chain, 1000)).rest(b->rest);
        const double touching =
            support(part_a, R_a.inverse() * to_b) + support(part_b, R_b.inverse() * Vec3<double>(-to_b));
        to_b *= touching * draws.uniform(0.98, 1.2);
        part_b.place(to_b, R_b);
        auto s = [&](const Vec3<double>& n) {
          return -n.dot(to_b) - support(part_a, R_a.inverse() * Vec3<double>(-n)) -
                 support(part_b, R_b.inverse() * n);
        };
        const Model model(body);
        const std::vector<Contact> found = ContactFinder(model).find(model.initial_state(), 0, 1);
        REQUIRE(!found.empty());
        double gap = 1;
        for (const Contact& contact : found) gap = std::min(gap, contact.gap);
        const Vec3<double> normal = found[0].normal;
        value.note(std::abs(gap - s(normal)));
        for (int i = 0; i < 50; ++i) better.note(s(draws.vector(1).normalized()) - gap);
        for (double width = 0.3; width > 1e-6; width *= 0.3)
          better.note(s((normal + draws.vector(width)).normalized()) - gap);
      }
      CHECK(value < 1e-10);
      CHECK(better < 1e-7);
    }
}

TEST_CASE("a bent box on its back or its belly touches a plane with its lowest points", "[contact]") {
  for (const double bend : {0.5, 1.0, 1.6, 2.2, 2.8})
    for (const double turn : {-0.5 * kPi, 0.5 * kPi}) {
      CAPTURE(bend, turn);
      const Kind box{
          "bent box", "box", {"bend"}, {{"a1", 0.02}, {"a2", 0.02}, {"a3", 0.2}, {"bend.angle", bend}}};
      MultiBody body;
      body.contact.active = true;
      body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
      const Eigen::Quaterniond R(Eigen::AngleAxisd(turn, Vec3<double>::UnitY()));
      const Part& part = add(body, box, false).place({0, 0, 0}, R);
      const Model model(body);
      const std::vector<Contact> found = ContactFinder(model).find(model.initial_state(), 0, 1);
      double lowest = 1;
      for (const Contact& contact : found) lowest = std::min(lowest, contact.gap);
      const Surface surface(part, 40);
      const Eigen::Matrix3Xd points = part.s(surface.material(), part.parameters().rest());
      CHECK(std::abs(lowest - (R.toRotationMatrix().row(2) * points).minCoeff()) < 1e-4);
    }
}

TEST_CASE("a tapered or twisted cylinder stands on its end face at four points or more", "[contact]") {
  for (const char* link : {"taper", "twist"}) {
    const Kind can{"can",
                   "cylinder",
                   {link},
                   {{"a1", 0.1},
                    {"a2", 0.08},
                    {"a3", 0.1},
                    {link == std::string("taper") ? "taper.tx" : "twist.angle", 0.3}}};
    MultiBody body;
    body.contact.active = true;
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    add(body, can, false).place({0, 0, 0.1});
    const Model model(body);
    const std::vector<Contact> found = ContactFinder(model).find(model.initial_state(), 0, 1e-9);
    CAPTURE(link);
    CHECK(found.size() >= 4);
  }
}

TEST_CASE("a ball that touches a curved solid, also where it is hollow, has no gap", "[contact]") {
  const std::vector<Kind> solids{
      {"hollow side", "cylinder", {"taper"}, {{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}, {"taper.tx", 0.4}}},
      {"hollow side of a capsule", "capsule", {"taper"}, {{"r", 0.1}, {"l", 0.2}, {"taper.tx", 0.4}}},
      {"slender and tapered",
       "ellipsoid",
       {"taper"},
       {{"a1", 0.02}, {"a2", 0.02}, {"a3", 0.2}, {"taper.tx", 0.8}, {"taper.ty", 0.8}}},
      {"bent rod", "capsule", {"bend"}, {{"r", 0.01}, {"l", 0.2}, {"bend.angle", 0.8}}}};
  Draws draws(4);
  for (const Kind& kind : solids) {
    CAPTURE(kind.name);
    Worst gap;
    for (int trial = 0; trial < 40; ++trial) {
      constexpr double kRadius = 0.001;
      MultiBody body;
      body.contact.between_parts = true;
      Part& part = add(body, kind, false).place({0, 0, 0});
      part.prepare();
      const ParameterValues<double> values = part.parameters().rest();
      // A point of the side, not near its rims and poles.
      const double angle = draws.uniform(0, 2 * kPi);
      const Vec3<double> direction(std::cos(angle), std::sin(angle), draws.uniform(-0.4, 0.4));
      const Material<double> material = part.shape().mesh_label(direction, values.b.data());
      const Vec3<double> x = part.s({material}, values).col(0);
      body.add(make_part("ball", "sphere", {}, 1000))
          .rest({{"r", kRadius}})
          .place(x + kRadius * part.normal(material, values));
      const Model model(body);
      const std::vector<Contact> found = ContactFinder(model).find(model.initial_state(), 0, 0.01);
      REQUIRE(!found.empty());
      double least = 1;
      for (const Contact& contact : found) least = std::min(least, contact.gap);
      gap.note(std::abs(least));
    }
    CHECK(gap < 1e-7);
  }
}

}  // namespace curved_solids_test
