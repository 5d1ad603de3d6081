// Impulses of many contacts at once, of movers that are plain masses: Coulomb's law at each of them, by the
// velocities that come out; momentum; where the search begins.
#include "catch.h"

#include <cmath>

#include <Eigen/Geometry>

#include <pliant/solve/coulomb_system.h>

#include "draws.h"

namespace coulomb_system_test {

using namespace pliant;
using test::Draws;

namespace {

/// Masses in a line, each of which meets the next in several contacts with normals near the line, the first a
/// wall besides.
struct Row {
  CoulombSystem system;
  std::vector<double> mass;
  VecX<double> x;
  double mu;

  /// size: of each mover, 3 for points, 6 for bodies of unit inertia pushed off their centres.
  Row(int movers, int size, int contacts, double friction, Draws& draws) : mu(friction) {
    for (int i = 0; i < movers; ++i) {
      system.add_mover(size);
      mass.push_back(std::pow(10, draws.uniform(-1, 1)));
    }
    x.setZero(size * movers);
    for (double& velocity : x) velocity = draws.uniform(-1, 1);
    for (int i = 0; i < movers; ++i) {
      x[size * i] -= 1;
      for (int k = 0; k < contacts; ++k) {
        const Vec3<double> n = (Vec3<double>::UnitX() + draws.vector(0.2)).normalized();
        Mat3<double> axes;
        axes << n, n.unitOrthogonal(), n.cross(n.unitOrthogonal());
        system.add_contact(mu);
        add(i, size, axes.transpose(), draws.vector(1), i > 0 ? draws.vector(1) : Vec3<double>::Zero());
      }
    }
  }

  void add(int i, int size, const Mat3<double>& D, const Vec3<double>& arm, const Vec3<double>& other_arm) {
    Eigen::Matrix3Xd J(3, size), J_other(3, size);
    J.leftCols<3>() = D;
    J_other.leftCols<3>() = -D;
    if (size == 6) {
      J.rightCols<3>() = -D * skew<double>(arm);
      J_other.rightCols<3>() = D * skew<double>(other_arm);
    }
    system.add_side(i, 0, size) = J;
    if (i > 0) system.add_side(i - 1, 0, size) = J_other;
    system.add_push(i) = response(i, J);
    if (i > 0) system.add_push(i - 1) = response(i - 1, J_other);
  }

  MatX<double> response(int i, const Eigen::Matrix3Xd& J) const {
    MatX<double> Y = J.transpose();
    Y.topRows<3>() /= mass[static_cast<std::size_t>(i)];
    return Y;
  }

  /// What is missed at the worst contact, of the conditions on velocities.
  double worst() const {
    double worst = 0;
    for (int k = 0; k < system.size(); ++k) {
      const Vec3<double>&p = system.impulse(k), u = system.velocity(k, x);
      const Eigen::Vector2d pull = p.tail<2>(), slip = u.tail<2>();
      REQUIRE(p[0] >= -1e-9);
      REQUIRE(pull.norm() <= mu * p[0] + 1e-6);
      worst = std::max(worst, -u[0]);
      if (p[0] > 1e-5) worst = std::max(worst, u[0]);
      if (pull.norm() < mu * p[0] - 1e-5) worst = std::max(worst, slip.norm());
    }
    return worst;
  }
};

}  // namespace

TEST_CASE("impulses of many contacts meet Coulomb's law at each", "[coulomb]") {
  Draws draws(7);
  for (const double mu : {0.0, 0.3, 0.8})
    for (int trial = 0; trial < 20; ++trial) {
      Row line(1 + trial % 7, 6, 2, mu, draws);
      const CoulombResult result = line.system.solve(line.x);
      CHECK(result.residual < 1e-10);
      CHECK(result.fallbacks == 0);
      CHECK(line.worst() < 1e-8);
    }
}

TEST_CASE("impulses on points meet Coulomb's law", "[coulomb]") {
  Draws draws(8);
  for (int trial = 0; trial < 20; ++trial) {
    Row line(10, 3, 1, 0.5, draws);
    const CoulombResult result = line.system.solve(line.x);
    CHECK(result.residual < 1e-5);
    CHECK(line.worst() < 1e-4);
  }
}

TEST_CASE("points that more contacts push than they can move are stopped exactly", "[coulomb]") {
  Draws draws(11);
  for (int trial = 0; trial < 20; ++trial) {
    Row line(2 + trial % 9, 3, 5, 0.4, draws);
    const CoulombResult result = line.system.solve(line.x);
    CHECK(result.residual < 1e-5);
    CHECK(result.fallbacks == 0);
  }
}

TEST_CASE("a side that nothing can push is no part of what is solved", "[coulomb]") {
  CoulombSystem system;
  const int point = system.add_mover(3), carried = system.add_mover(6), loose = system.add_mover(3);
  for (const int other : {carried, loose}) {
    system.add_contact(0.3);
    system.add_side(point, 0, 3) = (other == carried ? 1 : -1) * Mat3<double>::Identity();
    system.add_side(other, 0, 3) = (other == carried ? -1 : 1) * Mat3<double>::Identity();
    system.add_push(point) = (other == carried ? 1 : -1) * Mat3<double>::Identity();
  }
  VecX<double> x(12);
  x << -1, 0.2, 0, 0.5, 0, 0, 0, 0, 0, 3, 0, 0;
  const CoulombResult result = system.solve(x);
  CHECK(result.residual < 1e-5);
  CHECK(x[0] == Approx(0.5).margin(1e-5));
  CHECK(x[3] == 0.5);
  CHECK(x[9] == 3);
}

TEST_CASE("velocities after are those before and what the impulses change", "[coulomb]") {
  Draws draws(9);
  Row line(12, 3, 2, 0.5, draws);
  const VecX<double> before = line.x;
  line.system.solve(line.x);
  VecX<double> x = before;
  for (int k = 0; k < line.system.size(); ++k) line.system.add_change(k, 1, x);
  CHECK((x - line.x).norm() < 1e-15 * x.norm());
  CHECK((x - before).norm() > 1);
}

TEST_CASE("movers that nothing ties together do not change each other's impulses", "[coulomb]") {
  Draws one(10), same(10);
  Row alone(4, 6, 2, 0.5, one), two(4, 6, 2, 0.5, same);
  const int far = two.system.add_mover(3);
  two.mass.push_back(1);
  two.system.add_contact(0.5);
  two.system.add_side(far, 0, 3) = Mat3<double>::Identity();
  two.system.add_push(far) = Mat3<double>::Identity();
  two.x.conservativeResize(two.x.size() + 3);
  two.x.tail<3>() << -1, 0.2, 0;
  alone.system.solve(alone.x);
  two.system.solve(two.x);
  CHECK(two.x.head(alone.x.size()) == alone.x);
  CHECK(two.x.tail<3>().norm() < 1e-11);
}

TEST_CASE("a search that begins at the solution ends there at once", "[coulomb]") {
  Draws draws(11), same(11);
  Row line(8, 6, 2, 0.5, draws), again(8, 6, 2, 0.5, same);
  const CoulombResult first = line.system.solve(line.x);
  CHECK(first.sweeps > 10);
  for (int k = 0; k < line.system.size(); ++k) again.system.impulse(k) = line.system.impulse(k);
  const CoulombResult second = again.system.solve(again.x);
  CHECK(second.sweeps <= 4);
  CHECK(second.residual < 1e-11);
  CHECK((again.x - line.x).norm() < 1e-10);
}

TEST_CASE("what contacts do not see of a mover is pushed all the same", "[coulomb]") {
  // Of two large movers contacts see some velocities here and there.
  constexpr int kSize = 30;
  const std::vector<Eigen::Index> seen{2, 3, 4, 11, 20, 21};
  Draws draws(5);
  auto filled = [&](int rows, int columns) {
    MatX<double> matrix(rows, columns);
    for (double& number : matrix.reshaped()) number = draws.uniform(-1, 1);
    return matrix;
  };
  const MatX<double> root = filled(kSize, kSize),
                     inverse_mass = root * root.transpose() / kSize + MatX<double>::Identity(kSize, kSize);
  CoulombSystem all, part;
  for (int i = 0; i < 2; ++i) {
    all.add_mover(kSize);
    part.add_mover(6);
  }
  VecX<double> x = filled(2 * kSize, 1), x_part(12);
  for (int contact = 0; contact < 12; ++contact) {
    const int movers = contact < 3 ? 1 : 2;
    all.add_contact(0.5);
    part.add_contact(0.5);
    for (int i = 0; i < movers; ++i) {
      MatX<double> J = MatX<double>::Zero(3, kSize);
      J(Eigen::all, seen) = filled(3, 6);
      all.add_side(i, 2, 3) = J.middleCols(2, 3);
      all.add_side(i, 11, 1) = J.col(11);
      all.add_side(i, 20, 2) = J.middleCols(20, 2);
      part.add_side(i, 0, 6) = J(Eigen::all, seen);
      const MatX<double> Y = inverse_mass * J.transpose();
      all.add_push(i) = Y;
      part.add_push(i) = Y(seen, Eigen::all);
    }
  }
  const VecX<double> before = x;
  x_part << before.head(kSize)(seen), before.tail(kSize)(seen);
  CHECK(all.solve(x).residual < 1e-10);
  CHECK(part.solve(x_part).residual < 1e-10);
  VecX<double> moved = before;
  for (int k = 0; k < all.size(); ++k) {
    CHECK((all.impulse(k) - part.impulse(k)).norm() < 1e-10);
    CHECK((all.velocity(k, x) - part.velocity(k, x_part)).norm() < 1e-10);
    all.add_change(k, 1, moved);
  }
  CHECK((moved - x).norm() < 1e-12);
  CHECK((x - before).tail(kSize)[0] != 0);
  CHECK((x.head(kSize)(seen) - x_part.head(6)).norm() < 1e-10);
  CHECK((x.tail(kSize)(seen) - x_part.tail(6)).norm() < 1e-10);
}

TEST_CASE("contacts that hardly differ end a search that stalls", "[coulomb]") {
  // A body falls on four points, and on one of them again, a micrometre off and by a rate a little different,
  // which only a huge impulse would level.
  CoulombSystem system;
  system.add_mover(6);
  for (int k = 0; k < 5; ++k) {
    const Vec3<double> arm =
        k < 4 ? Vec3<double>(-1, k % 2 - 0.5, k / 2 - 0.5) : Vec3<double>(-1, -0.5, -0.5 + 1e-6);
    Eigen::Matrix<double, 3, 6> J;
    J << Mat3<double>::Identity(), -skew<double>(arm);
    system.add_contact(0.5);
    system.add_side(0, 0, 6) = J;
    system.add_push(0) = J.transpose();
  }
  system.constant(4)[0] = -1e-8;
  VecX<double> x = VecX<double>::Zero(6);
  x[0] = -1;
  const CoulombResult result = system.solve(x);
  CAPTURE(result.residual);
  CHECK(result.residual < 1e-7);
  CHECK(result.fallbacks == 0);
  CHECK(result.sweeps <= 132);
  CHECK(std::abs(x[0]) < 1e-7);
}

TEST_CASE("what cannot be stopped shows in the residual", "[coulomb]") {
  CoulombSystem system;
  system.add_mover(3);
  system.add_contact(0.5);
  system.add_side(0, 0, 3) = Mat3<double>::Identity();
  VecX<double> x = Vec3<double>(-2, 0, 0);
  CHECK(system.solve(x).residual == Approx(2).epsilon(1e-15));
  CHECK(x == Vec3<double>(-2, 0, 0));
}

}  // namespace coulomb_system_test
