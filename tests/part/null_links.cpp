// A deformation frozen as the identity is there by name only (design section 2): the part has the mass points
// and the bits of the part without it.
#include "catch.h"

#include <pliant/deform/all_deforms.h>
#include <pliant/part/primitive.h>
#include <pliant/shape/all_shapes.h>

#include "random_state.h"

namespace null_links_test {

using namespace pliant;
using test::Draws;

namespace {

/// Both parts with the parameters of the shape dynamic, except its exponents.
void free_shape(Part& part) {
  std::vector<std::string> names;
  for (int i = 0; i < part.parameters().n_shape(); ++i)
    if (part.parameters()[i].name.substr(0, 3) != "eps") names.push_back(part.parameters()[i].name);
  part.make_dynamic(names);
}

void same_as_without(Part& null, Part& bare) {
  Draws draws(1);
  free_shape(null);
  free_shape(bare);
  null.prepare();
  bare.prepare();
  CHECK(null.mass_points().rule == bare.mass_points().rule);
  REQUIRE(null.mass_points().n_points == bare.mass_points().n_points);
  CHECK(null.rest_inertia().M == bare.rest_inertia().M);
  for (int trial = 0; trial < 3; ++trial) {
    const test::RandomState state = test::draw_state(draws, bare);
    Inertia<double> a, b;
    Counters a_counters, b_counters;
    null.evaluate_inertia(state.q_s, state.q_s_dot, state.omega, a, a_counters);
    bare.evaluate_inertia(state.q_s, state.q_s_dot, state.omega, b, b_counters);
    CHECK(a.M == b.M);
    CHECK(a.g_q == b.g_q);
    CHECK(a_counters.jacobian_points == b_counters.jacobian_points);
    const VecMax<Dual<1>> q_s = state.q_s.cast<Dual<1>>(), q_s_dot = state.q_s_dot.cast<Dual<1>>();
    Inertia<Dual<1>> da, db;
    null.evaluate_inertia(q_s, q_s_dot, state.omega.cast<Dual<1>>(), da, a_counters);
    bare.evaluate_inertia(q_s, q_s_dot, state.omega.cast<Dual<1>>(), db, b_counters);
    for (Eigen::Index i = 0; i < da.M.size(); ++i) REQUIRE(da.M.data()[i].v == db.M.data()[i].v);

    const ParameterValues<double> null_values = test::values_of(null, state),
                                  bare_values = test::values_of(bare, state);
    const Material<double> m = draws.material(bare.shape().mesh());
    const Vec3<double> p = bare.s({m}, bare_values).col(0);
    CHECK(null.s({m}, null_values).col(0) == p);
    CHECK(null.inside_outside(p, null_values) == bare.inside_outside(p, bare_values));
    CHECK(null.inside_outside_gradient(p, null_values) == bare.inside_outside_gradient(p, bare_values));
    CHECK(null.normal(m, null_values) == bare.normal(m, bare_values));
  }
}

}  // namespace

TEST_CASE("every shape with every deformation frozen at nothing is the shape alone", "[part]") {
  for (const auto& face : all_shapes()) {
    INFO(face->name());
    const std::unique_ptr<Part> null =
        make_part("part", face->name(), {"twist", "taper", "shear", "bend", "bend_offset"}, 1000);
    // Where a bend that is none would go does not matter.
    null->rest({{"bend.direction", 0.3}, {"bend_offset.b2", 0.4}, {"bend_offset.b3", 0.5}});
    const std::unique_ptr<Part> bare = make_part("part", face->name(), {}, 1000);
    CHECK(null->parameters().links().empty());
    CHECK(null->parameters().all_links().size() == 5);
    CHECK(null->parameters().find("bend.direction") >= 0);
    same_as_without(*null, *bare);
  }
}

TEST_CASE("a typed chain passes by what is frozen at nothing too", "[part]") {
  Primitive<Ellipsoid, Chain<Taper, Bend>> null("part", 1000);
  Primitive<Ellipsoid> bare("part", 1000);
  same_as_without(null, bare);
  CHECK(null.mass_points().rule == "affine");
  CHECK(null.mass_points().n_points == 4);
}

TEST_CASE("links act again once a parameter moves or leaves its default", "[part]") {
  const std::unique_ptr<Part> part = make_part("part", "ellipsoid", {"taper", "bend", "twist"}, 1000);
  CHECK(part->parameters().links().empty());
  part->rest({{"twist.angle", 0.2}});
  REQUIRE(part->parameters().links().size() == 1);
  CHECK(part->parameters().links()[0].type == std::string("twist"));
  part->make_dynamic({"bend.direction"});
  CHECK(part->parameters().links().size() == 2);
  part->freeze({"bend.direction"}).rest({{"twist.angle", 0}, {"taper.ty", 0.1}});
  REQUIRE(part->parameters().links().size() == 1);
  CHECK(part->parameters().links()[0].type == std::string("taper"));
}

TEST_CASE("values given for an evaluation count, not those a part rests at", "[part]") {
  const std::unique_ptr<Part> part = make_part("part", "cylinder", {"twist"}, 1000);
  ParameterValues<double> values = part->parameters().rest();
  const Material<double> m = material_at(0.5, 0.2);
  const Vec3<double> before = part->s({m}, values).col(0);
  values.b[3] = 0.5;
  const Vec3<double> after = part->s({m}, values).col(0);
  CHECK((after - before).norm() > 0.1);
  CHECK(std::abs(part->inside_outside(after, values)) <= 1e-14);
}

}  // namespace null_links_test
