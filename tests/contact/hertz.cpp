// Elastic balls with local deformation on a plane: the static approach under their weight, and the bounce, by
// Hertz's theory with the compliance of the whole ball.
#include "catch.h"

#include <cmath>

#include <Eigen/LU>

#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>

#include "motion.h"

namespace hertz_test {

using namespace pliant;

namespace {

constexpr double kNu = 0.3, kRadius = 0.1, kDensity = 1000, kG = 9.81;  // 1, m, kg/m^3, m/s^2

/// E* of the ball against a rigid body, in units of Young's modulus E.
constexpr double kStiff = 1 / (1 - kNu * kNu);

/// A ball of E = 1 and R = 1 that a body force presses onto a smooth rigid plane, in linear elasticity. `sag`
/// is the distance by which its centre of mass approaches the plane. For small forces the solution tends to
/// that of Hertz's half space: F = 4/3 E* sqrt(R) sag^(3/2), a^2 = R sag with the contact radius a. Here
/// pressures on rings about the pole balance the body force. The displacements are sums over Legendre
/// polynomials P_n(cos theta) (Lur'e, Three-dimensional Problems of the Theory of Elasticity, 1964). At r = 1
/// the terms of order n are, with constants A and B and Poisson's ratio nu,
///   u_r = [A (n+1)(n-2+4 nu) + B n] P_n,   u_theta = [A (n+5-4 nu) + B] dP_n/dtheta.
struct PressedBall {
  double sag = 0, contact = 0;  ///< the approach, and the radius of the contact

  /// Presses the ball by the force that Hertz's theory gives for the contact radius a. terms: number of
  /// Legendre polynomials. rings: number of rings; they extend to the polar angle 2 a.
  explicit PressedBall(double a, int terms = 1500, int rings = 60) {
    const double G = 0.5 / (1 + kNu), K = 1 / (3 * (1 - 2 * kNu)), lambda = K - 2 * G / 3;
    using Array = Eigen::ArrayXd;
    const Array edge = Array::LinSpaced(rings + 1, 0, 2 * a).cos(),
                theta = (Array::LinSpaced(rings, 0, rings - 1) + 0.5) * 2 * a / rings, x = theta.cos(),
                y = theta.sin();
    // P_(n-1) and P_n at the edges of the rings (before, at) and at their midpoints (before_x, at_x).
    Array before = Array::Ones(rings + 1), at = edge, before_x = Array::Ones(rings), at_x = x;
    auto next = [](int n, const Array& z, Array& P_before, Array& P) {
      const Array P_next = ((2 * n + 1) * z * P - n * P_before) / (n + 1);
      P_before = P;
      P = P_next;
    };
    MatX<double> u =
        -1 / (3 * K) * x.matrix() * (0.5 * (edge.head(rings) - edge.tail(rings))).matrix().transpose();
    for (int n = 1; n <= terms; ++n) {
      const Array slope = n * (x * at_x - before_x) / y;  // dP_n/dtheta
      Array along;  // u_z under a pressure P_n, minus the displacement of the centre of mass
      if (n == 1) {
        const double s = -1 / (6 * lambda + 4 * G);
        along = s * (x * x - y * y) + s / 5;
      } else {
        Eigen::Matrix2d stress;
        stress << (n + 1.0) * (n * n - n - 2 - 2 * kNu), n * (n - 1.0), n * n + 2.0 * n - 1 + 2 * kNu,
            n - 1.0;
        const Eigen::Vector2d c = stress.inverse() * Eigen::Vector2d(-0.5 / G, 0);
        along = (c[0] * (n + 1) * (n - 2 + 4 * kNu) + c[1] * n) * at_x * x -
                (c[0] * (n + 5 - 4 * kNu) + c[1]) * slope * y;
      }
      const Array two_before = before;
      next(n, edge, before, at);
      next(n, x, before_x, at_x);
      // (2 n + 1) / 2 times the integral of P_n from -1 to the edge
      const Array rest = 0.5 * (at - two_before);
      u += along.matrix() * (rest.head(rings) - rest.tail(rings)).matrix().transpose();
    }
    const Array weight = 2 * kPi * (edge.head(rings) - edge.tail(rings)) * x;
    const double force = 4.0 / 3 * kStiff * a * a * a;
    // The k inner rings are in contact: their pressures p satisfy x + u p = 1 - sag. k decreases until the
    // pressure of the outermost ring is not negative.
    for (int k = rings;; --k) {
      MatX<double> A = MatX<double>::Zero(k + 1, k + 1);
      VecX<double> b(k + 1);
      A.topLeftCorner(k, k) = u.topLeftCorner(k, k);
      A.col(k).head(k).setOnes();
      A.row(k).head(k) = weight.head(k).matrix().transpose();
      b.head(k) = 1 - x.head(k);
      b[k] = force;
      const VecX<double> p = A.partialPivLu().solve(b);
      sag = p[k];
      contact = std::sin(2 * a * k / rings);
      if (p[k - 1] >= 0) return;
    }
  }
};

/// Adds an elastic ball of Young's modulus E (Pa), `above` (m) above the plane z = 0.
Part& elastic_ball_above(MultiBody& body, double E, int resolution, double above) {
  body.contact.friction = 0;
  auto& part = body.add<Primitive<Sphere>>("ball", kDensity);
  part.rest({{"r", kRadius}}).place({0, 0, kRadius + above});
  LocalSettings settings;
  settings.resolution = resolution;
  settings.energies = {local_law("elastic", {E, kNu})};
  part.deform_locally(settings);
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  return part;
}

}  // namespace

TEST_CASE("a pressed ball agrees with Hertz's half space for small contacts", "[contact]") {
  const PressedBall small(0.1), large(0.2);
  const double small_ratio = small.sag / (0.1 * 0.1), large_ratio = large.sag / (0.2 * 0.2);
  // The correction of the ratio is of the order of the contact radius, in radii of the ball.
  CHECK(small_ratio < 0.96);
  CHECK(2 * small_ratio - large_ratio == Approx(1).margin(0.01));
  CHECK(small.contact == Approx(0.1).epsilon(0.04));  // the tolerance is about the width of a ring
  CHECK(large.contact == Approx(0.2).epsilon(0.04));
}

TEST_CASE("an elastic ball on a plane sags by Hertz's law", "[contact][long]") {
  std::vector<double> errors;
  for (const int resolution : {2, 4, 8}) {
    double squares = 0;
    for (const double a : {0.25, 0.3, 0.35, 0.4, 0.45}) {  // contact radii in radii of the ball
      const double weight = kDensity * 4 / 3 * kPi * std::pow(kRadius, 3) * kG,
                   E = 0.75 * weight / (kStiff * kRadius * kRadius * a * a * a);
      MultiBody body;
      Part& ball = elastic_ball_above(body, E, resolution, 0);
      const double omega = std::sqrt(2 * E * kStiff * a * kRadius * kG / weight);
      ball.damping(0, 0, 1.4 * omega);
      Simulation simulation(body, "semi_implicit_euler");
      const double h = 0.7 * largest_stable_step(simulation), end = 12 / omega;
      test::run(simulation, end, static_cast<int>(end / h));
      double contact_force = 0;
      for (const Vec3<double>& p : simulation.contact()->impulses()) contact_force += p[2];
      CAPTURE(resolution, a);
      CHECK(contact_force / simulation.state().h == Approx(weight).epsilon(2e-3));
      const double sag = (kRadius - simulation.state().q[2]) / kRadius, expected = PressedBall(a).sag;
      squares += std::pow(sag / expected - 1, 2) / 5;
    }
    errors.push_back(std::sqrt(squares));
  }
  CAPTURE(errors);
  CHECK(test::observed_order(errors) > 1);
  CHECK(errors.back() < 0.03);
}

TEST_CASE("an elastic ball bounces off a plane in Hertz's time and keeps its energy", "[contact][long]") {
  // The force F = k (sag + C F / (E R))^(3/2), with the compliance C of the whole ball, stops the ball at the
  // largest sag. The contact lasts for twice the integral of d(sag) / v up to this sag.
  const double a = 0.25, E = 1e5, mass = kDensity * 4 / 3 * kPi * std::pow(kRadius, 3),
               k = 4.0 / 3 * E * kStiff * std::sqrt(kRadius), max_force = k * std::pow(a * a * kRadius, 1.5),
               C = (a * a - PressedBall(a).sag) * E * kRadius * kRadius / max_force;
  auto sag = [&](double F) { return std::pow(F / k, 2.0 / 3) - C * F / (E * kRadius); };
  auto work = [&](double F) { return 0.4 * F * std::pow(F / k, 2.0 / 3) - 0.5 * C * F * F / (E * kRadius); };
  const double speed = std::sqrt(2 * work(max_force) / mass);
  double time = 0;
  const int n = 2000;
  for (int i = 0; i < n; ++i) {
    auto force = [&](double share) { return max_force * std::pow(std::sin(0.5 * kPi * share / n), 3); };
    const double v = std::sqrt(speed * speed - 2 * work(force(i + 0.5)) / mass);
    time += 2 * (sag(force(i + 1)) - sag(force(i))) / v;
  }
  CHECK(
      time ==
      Approx(2.868 * std::pow(mass * mass / (std::pow(E * kStiff, 2) * kRadius * speed), 0.2)).epsilon(0.1));
  std::vector<double> losses;
  for (const int resolution : {4, 8}) {
    MultiBody body;
    body.gravity.setZero();
    elastic_ball_above(body, E, resolution, 1e-5 * kRadius).velocity({0, 0, -speed}, {0, 0, 0});
    Simulation simulation(body, "semi_implicit_euler");
    const double h = 0.5 * largest_stable_step(simulation), start = simulation.ledger().energy();
    double first = 0, last = 0, deepest = 0;
    while (simulation.time() < 1.5 * time) {
      simulation.step(h);
      deepest = std::max(deepest, kRadius - simulation.state().q[2]);
      double push = 0;
      for (const Vec3<double>& p : simulation.contact()->impulses()) push += p[2];
      if (!(push > 0)) continue;
      if (first == 0) first = simulation.time();
      last = simulation.time();
    }
    losses.push_back(1 - simulation.ledger().energy() / start);
    const double error = resolution == 4 ? 0.1 : 0.05;
    CAPTURE(resolution, losses.back());
    CHECK(last - first == Approx(time).epsilon(error));
    CHECK(deepest == Approx(sag(max_force)).epsilon(error));
    CHECK(simulation.ledger().momentum[2] > 0.98 * mass * speed);
  }
  CHECK(losses[0] > 0);
  CHECK(losses[1] > 0);
  CHECK(losses[1] < 0.5 * losses[0]);
  CHECK(losses[1] < 2e-3);
}

}  // namespace hertz_test
