// A chain assembled at run time gives the bits of the chain that is a template argument (typed): positions,
// Jacobians, rates, masses and inertial forces.
#include "catch.h"

#include <pliant/deform/all_deforms.h>
#include <pliant/part/primitive.h>
#include <pliant/shape/all_shapes.h>

#include "random_state.h"

namespace typed_chains_test {

using namespace pliant;
using test::Draws;

namespace {

template <class Shape, class... Links>
void check_identical_bits() {
  Draws draws(1);
  Primitive<Shape, Chain<Links...>> typed("part", 1000);
  const std::unique_ptr<Part> run_time = make_part("part", Shape::name, {Links::name...}, 1000);
  INFO(test::describe(Shape::name, {Links::name...}));
  REQUIRE(typed.parameters().names() == run_time->parameters().names());
  // Exponents stay frozen, so that the mass points are few.
  for (Part* part : {static_cast<Part*>(&typed), run_time.get()}) {
    test::make_all_dynamic(*part, {"eps1", "eps2"});
    part->rest({{part->parameters()[0].name, part->parameters()[0].rest_value() * 0.7}});
    part->prepare();
  }
  REQUIRE(typed.mass_points().n_points == run_time->mass_points().n_points);
  for (int trial = 0; trial < 3; ++trial) {
    const test::RandomState state = test::draw_state(draws, typed);
    Inertia<double> a, b;
    Counters counters;
    typed.evaluate_inertia(state.q_s, state.q_s_dot, state.omega, a, counters);
    run_time->evaluate_inertia(state.q_s, state.q_s_dot, state.omega, b, counters);
    CHECK(a.M == b.M);
    CHECK(a.g_q == b.g_q);
    CHECK(a.moment == b.moment);

    const VecMax<Dual<1>> q_s = state.q_s.cast<Dual<1>>(), q_s_dot = state.q_s_dot.cast<Dual<1>>();
    VecMax<Dual<1>> moving = q_s;
    for (Eigen::Index i = 0; i < q_s.size(); ++i) moving[i].d[0] = state.q_s_dot[i];
    Inertia<Dual<1>> da, db;
    typed.evaluate_inertia(moving, q_s_dot, state.omega.cast<Dual<1>>(), da, counters);
    run_time->evaluate_inertia(moving, q_s_dot, state.omega.cast<Dual<1>>(), db, counters);
    bool same = true;
    for (Eigen::Index i = 0; i < da.M.size(); ++i)
      same = same && da.M.data()[i].v == db.M.data()[i].v && da.M.data()[i].d[0] == db.M.data()[i].d[0];
    for (Eigen::Index i = 0; i < da.g_q.size(); ++i) same = same && da.g_q[i].d[0] == db.g_q[i].d[0];
    CHECK(same);

    std::vector<Material<double>> at = test::special_points(Shape::mesh);
    for (int i = 0; i < 7; ++i) at.push_back(draws.material(Shape::mesh));
    std::vector<PointJet<double>> ja, jb;
    typed.points(at, state.q_s, state.q_s_dot, ja, counters);
    run_time->points(at, state.q_s, state.q_s_dot, jb, counters);
    for (std::size_t i = 0; i < at.size(); ++i) {
      CHECK(ja[i].p == jb[i].p);
      CHECK(ja[i].p1 == jb[i].p1);
      CHECK(ja[i].p2 == jb[i].p2);
      CHECK(ja[i].J == jb[i].J);
    }
    const ParameterValues<double> values = test::values_of(typed, state);
    const Vec3<double> p = ja.back().p;
    CHECK(typed.inside_outside(p, values) == run_time->inside_outside(p, values));
    CHECK(typed.inside_outside_gradient(p, values) == run_time->inside_outside_gradient(p, values));
    CHECK(typed.normal(at.back(), values) == run_time->normal(at.back(), values));
  }
}

}  // namespace

TEMPLATE_LIST_TEST_CASE("every shape with a taper: run-time and typed chains are bit-identical", "[part]",
                        AllShapes) {
  check_identical_bits<TestType, Taper>();
}

TEMPLATE_LIST_TEST_CASE("every deformation: run-time and typed chains are bit-identical", "[part]",
                        AllDeforms) {
  check_identical_bits<Cylinder, TestType>();
}

TEST_CASE("longer and empty chains: run-time and typed chains are bit-identical", "[part]") {
  check_identical_bits<Superellipsoid>();
  check_identical_bits<Superellipsoid, Taper, Twist, Taper, Shear>();
  check_identical_bits<Ellipsoid, Twist, BendOffset, Bend>();
}

}  // namespace typed_chains_test
