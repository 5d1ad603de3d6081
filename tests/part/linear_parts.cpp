// Parts whose material points are linear in the dynamic parameters: precomputed moments replace the sums over
// mass points, and J is not evaluated.
#include "catch.h"

#include <string>
#include <vector>

#include <pliant/part/registry.h>
#include <pliant/part/sum_inertia.h>

#include "random_state.h"

namespace linear_parts_test {

using namespace pliant;
using test::Draws;

namespace {

/// Returns an unprepared part in which all lengths of the shape, or only the last length, are dynamic.
std::unique_ptr<Part> make_with_dynamic_lengths(const std::string& shape, bool all,
                                                const std::vector<std::string>& links = {}) {
  auto part = make_part("part", shape, links, 700);
  std::vector<std::string> lengths;
  for (int i = 0; i < part->parameters().n_shape(); ++i)
    if (part->parameters()[i].spec->quantity == Quantity::length)
      lengths.push_back(part->parameters()[i].name);
  if (!all) lengths.erase(lengths.begin(), lengths.end() - 1);
  part->make_dynamic(lengths);
  return part;
}
bool nearly_equal(const MatX<double>& a, const MatX<double>& b) {
  return (a - b).lpNorm<Eigen::Infinity>() <= 1e-13 * b.lpNorm<Eigen::Infinity>();
}

}  // namespace

TEST_CASE(
    "the inertia of parts with dynamic lengths agrees with that of their mass points, and J is not "
    "evaluated") {
  Draws draws(5);
  for (const std::string shape : {"sphere", "ellipsoid", "box", "cylinder", "cone", "capsule",
                                  "superellipsoid", "superellipsoid_radial", "supertoroid"})
    for (const bool all : {true, false}) {
      CAPTURE(shape, all);
      auto part = make_with_dynamic_lengths(shape, all);
      REQUIRE(part->linear());
      part->prepare();
      for (int trial = 0; trial < 4; ++trial) {
        test::RandomState state = test::draw_state(draws, *part);
        if (trial == 1) state.q_s_dot.setZero();
        if (trial == 2) state.omega.setZero();
        Inertia<double> moments, sums;
        Counters counters, unused;
        part->evaluate_inertia(state.q_s, state.q_s_dot, state.omega, moments, counters);
        sum_inertia(*part, part->mass_points(), state.q_s, state.q_s_dot, state.omega, sums, unused);
        CHECK(nearly_equal(moments.M, sums.M));
        CHECK(moments.M == moments.M.transpose());
        CHECK(nearly_equal(moments.g_q, sums.g_q));
        CHECK((moments.moment - sums.moment).norm() < 1e-13 * sums.mass);
        CHECK(moments.mass == Approx(sums.mass).epsilon(1e-13));
        CHECK(counters.mass_matrices == 1);
        CHECK(counters.inertial_forces == 1);
        CHECK(counters.jacobian_points == 0);
        CHECK(counters.rate_points == 0);
        // Derivatives with respect to q_s, against finite differences.
        VecMax<Dual<1>> q_s = state.q_s.cast<Dual<1>>();
        for (Eigen::Index k = 0; k < q_s.size(); ++k) q_s[k].d[0] = 1;
        Inertia<Dual<1>> dual;
        part->evaluate_inertia(q_s, VecMax<Dual<1>>(state.q_s_dot.cast<Dual<1>>()),
                               state.omega.cast<Dual<1>>(), dual, counters);
        const double step = 1e-5;
        Inertia<double> above, below;
        part->evaluate_inertia(state.q_s.array() + step, state.q_s_dot, state.omega, above, unused);
        part->evaluate_inertia(state.q_s.array() - step, state.q_s_dot, state.omega, below, unused);
        for (Eigen::Index i = 0; i < dual.M.size(); ++i) {
          REQUIRE(dual.M.data()[i].v == moments.M.data()[i]);
          REQUIRE(dual.M.data()[i].d[0] == Approx((above.M.data()[i] - below.M.data()[i]) / (2 * step))
                                               .epsilon(1e-6)
                                               .margin(1e-6 * sums.mass));
        }
        for (Eigen::Index i = 0; i < dual.g_q.size(); ++i)
          REQUIRE(dual.g_q[i].d[0] == Approx((above.g_q[i] - below.g_q[i]) / (2 * step))
                                          .epsilon(1e-6)
                                          .margin(1e-5 * sums.g_q.lpNorm<Eigen::Infinity>()));
      }
    }
}

TEST_CASE("active links and dynamic exponents or ratios make a part nonlinear, identity links do not") {
  CHECK(make_with_dynamic_lengths("ellipsoid", true, {"taper"})->linear());
  auto bends = make_with_dynamic_lengths("box", true, {"bend"});
  bends->rest({{"bend.angle", 0.3}});
  CHECK_FALSE(bends->linear());
  auto squares = make_with_dynamic_lengths("superellipsoid", true);
  squares->make_dynamic({"eps1"});
  CHECK_FALSE(squares->linear());
  auto ring = make_with_dynamic_lengths("supertoroid", true);
  ring->make_dynamic({"a4"});
  CHECK_FALSE(ring->linear());
  CHECK_FALSE(make_part("rigid", "box", {}, 1000)->linear());
}

}  // namespace linear_parts_test
