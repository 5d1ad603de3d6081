// Coulomb's law at one contact: its conditions for random matrices W, sticking and sliding.
#include "catch.h"

#include <cmath>

#include <pliant/solve/coulomb.h>

#include "draws.h"

namespace coulomb_test {

using namespace pliant;
using test::Draws;

TEST_CASE("the impulse of a contact obeys Coulomb's law", "[coulomb]") {
  Draws draws(3);
  int lifted = 0, stuck = 0, slid = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    Mat3<double> J;
    for (double& entry : J.reshaped()) entry = draws.uniform(-1, 1);
    const double heavy = std::pow(10, draws.uniform(-3, 3));
    Mat3<double> W = heavy * (J * J.transpose() + 1e-3 * Mat3<double>::Identity());
    const Vec3<double> b = draws.vector(1);
    const double mu = trial % 5 == 0 ? 0 : draws.uniform(0, 1.5);
    const Vec3<double> p = solve_coulomb(W, b, mu), u = W * p + b;
    const Eigen::Vector2d pull = p.tail<2>(), slip = u.tail<2>();
    // Rounding errors of u, and of the position of the impulse on its cone.
    const double tiny = 1e-13 * (b.norm() + W.norm() * p.norm()), small = 1e-12 * p.norm();
    REQUIRE(p[0] >= 0);
    REQUIRE(u[0] >= -tiny);
    REQUIRE(std::abs(p[0] * u[0]) <= tiny * p.norm());
    REQUIRE(pull.norm() <= mu * p[0] + small);
    if (p[0] == 0) {
      ++lifted;
    } else if (slip.norm() > 1e-9) {
      ++slid;
      REQUIRE(pull.norm() == Approx(mu * p[0]).margin(small));
      REQUIRE(pull.dot(slip) <= -(1 - 1e-9) * pull.norm() * slip.norm() + tiny * p.norm());
    } else {
      ++stuck;
      REQUIRE(slip.norm() <= tiny);
    }
  }
  CHECK(lifted > 5000);
  CHECK(stuck > 1000);
  CHECK(slid > 1000);
}

TEST_CASE("a contact sticks if an impulse inside its cone stops it, also if W is nearly singular",
          "[coulomb]") {
  Draws draws(5);
  for (int trial = 0; trial < 2000; ++trial) {
    const Vec3<double> r = draws.vector(1);
    const double floor = std::pow(10, draws.uniform(-12, -6)) * r.squaredNorm();
    const Mat3<double> W = r * r.transpose() + floor * Mat3<double>::Identity();
    const Vec3<double> inside(1, draws.uniform(-0.5, 0.5), draws.uniform(-0.5, 0.5)), b = -W * inside;
    if (!(b[0] < 0)) continue;
    const Vec3<double> p = solve_coulomb(W, b, 2);
    CAPTURE(trial, floor, p.transpose(), inside.transpose());
    REQUIRE((W * p + b).norm() <= 1e-15 * W.norm() * (p.norm() + inside.norm()));
    REQUIRE((p - inside).norm() <= 10 * 1e-15 * r.squaredNorm() / floor * inside.norm());
  }
  const Vec3<double> along_normal = solve_coulomb(Vec3<double>(1, 0, 0).asDiagonal(), {-1, 0, 0}, 1);
  CHECK(along_normal == Vec3<double>(1, 0, 0));
}

TEST_CASE(
    "a point mass that hits a plane sticks if its tangential velocity is at most mu times its normal "
    "velocity, else it slides",
    "[coulomb]") {
  const Mat3<double> W = Mat3<double>::Identity() / 2;  // of a point mass of 2 kg
  for (const double along : {0.3, 0.7}) {
    const Vec3<double> p = solve_coulomb(W, {-1, along, 0}, 0.5);
    CHECK(p[0] == Approx(2).epsilon(1e-15));
    CHECK(p[1] == Approx(-2 * std::min(along, 0.5)).epsilon(1e-14));
    CHECK(p[2] == 0);
  }
  CHECK(solve_coulomb(W, {1, 3, 0}, 0.5) == Vec3<double>::Zero());
}

}  // namespace coulomb_test
