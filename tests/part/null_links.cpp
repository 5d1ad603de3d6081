// A deformation that is frozen as the identity has no effect: the part has the same mass points and gives the
// same bits as a part without the deformation.
#include "catch.h"

#include <pliant/deform/all_deforms.h>
#include <pliant/part/primitive.h>
#include <pliant/shape/all_shapes.h>

#include "random_state.h"

namespace null_links_test {

using namespace pliant;
using test::Draws;

namespace {

/// Makes all parameters of the shape dynamic except its exponents.
void make_shape_dynamic(Part& part) {
  std::vector<std::string> names;
  for (int i = 0; i < part.parameters().n_shape(); ++i)
    if (part.parameters()[i].name.substr(0, 3) != "eps") names.push_back(part.parameters()[i].name);
  part.make_dynamic(names);
}

/// Checks that two parts, one of them with links that are frozen as the identity, give the same bits.
void check_equal_without_links(Part& with_null_links, Part& without_links) {
  Draws draws(1);
  make_shape_dynamic(with_null_links);
  make_shape_dynamic(without_links);
  with_null_links.prepare();
  without_links.prepare();
  CHECK(with_null_links.mass_points().rule == without_links.mass_points().rule);
  REQUIRE(with_null_links.mass_points().n_points == without_links.mass_points().n_points);
  CHECK(with_null_links.rest_inertia().M == without_links.rest_inertia().M);
  for (int trial = 0; trial < 3; ++trial) {
    const test::RandomState state = test::draw_state(draws, without_links);
    Inertia<double> a, b;
    Counters a_counters, b_counters;
    with_null_links.evaluate_inertia(state.q_s, state.q_s_dot, state.omega, a, a_counters);
    without_links.evaluate_inertia(state.q_s, state.q_s_dot, state.omega, b, b_counters);
    CHECK(a.M == b.M);
    CHECK(a.g_q == b.g_q);
    CHECK(a_counters.jacobian_points == b_counters.jacobian_points);
    const VecMax<Dual<1>> q_s = state.q_s.cast<Dual<1>>(), q_s_dot = state.q_s_dot.cast<Dual<1>>();
    Inertia<Dual<1>> da, db;
    with_null_links.evaluate_inertia(q_s, q_s_dot, state.omega.cast<Dual<1>>(), da, a_counters);
    without_links.evaluate_inertia(q_s, q_s_dot, state.omega.cast<Dual<1>>(), db, b_counters);
    for (Eigen::Index i = 0; i < da.M.size(); ++i) REQUIRE(da.M.data()[i].v == db.M.data()[i].v);

    const ParameterValues<double> null_values = test::values_of(with_null_links, state),
                                  bare_values = test::values_of(without_links, state);
    const Material<double> m = draws.material(without_links.shape().mesh());
    const Vec3<double> p = without_links.s({m}, bare_values).col(0);
    CHECK(with_null_links.s({m}, null_values).col(0) == p);
    CHECK(with_null_links.inside_outside(p, null_values) == without_links.inside_outside(p, bare_values));
    CHECK(with_null_links.inside_outside_gradient(p, null_values) ==
          without_links.inside_outside_gradient(p, bare_values));
    CHECK(with_null_links.normal(m, null_values) == without_links.normal(m, bare_values));
  }
}

}  // namespace

TEST_CASE("a shape with all deformations frozen as the identity is bit-identical to the shape alone",
          "[part]") {
  for (const auto& face : all_shapes()) {
    INFO(face->name());
    const std::unique_ptr<Part> with_null_links =
        make_part("part", face->name(), {"twist", "taper", "shear", "bend", "bend_offset"}, 1000);
    // The parameters of the direction and the position of a zero bend have no effect.
    with_null_links->rest({{"bend.direction", 0.3}, {"bend_offset.b2", 0.4}, {"bend_offset.b3", 0.5}});
    const std::unique_ptr<Part> without_links = make_part("part", face->name(), {}, 1000);
    CHECK(with_null_links->parameters().links().empty());
    CHECK(with_null_links->parameters().all_links().size() == 5);
    CHECK(with_null_links->parameters().find("bend.direction") >= 0);
    check_equal_without_links(*with_null_links, *without_links);
  }
}

TEST_CASE("a typed chain also skips links that are frozen as the identity", "[part]") {
  Primitive<Ellipsoid, Chain<Taper, Bend>> with_null_links("part", 1000);
  Primitive<Ellipsoid> without_links("part", 1000);
  check_equal_without_links(with_null_links, without_links);
  CHECK(with_null_links.mass_points().rule == "affine");
  CHECK(with_null_links.mass_points().n_points == 4);
}

TEST_CASE("links act again once a parameter is dynamic or differs from its default", "[part]") {
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

TEST_CASE("an evaluation uses the given parameter values, not the rest values", "[part]") {
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
