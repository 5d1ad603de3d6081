// Impulses of many simultaneous contacts between simple masses: Coulomb's law at each contact, checked with
// the resulting velocities; momentum; warm starts. A mover is a part, or a set of parts that joints connect
// (coulomb_system.h).
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <pliant/solve/coulomb_system.h>

#include "draws.h"

namespace coulomb_system_test {

using namespace pliant;
using test::Draws;

namespace {

/// Masses in a line. Each mass has `contacts` contacts with the next mass, with normals close to the
/// direction of the line. The first mass also has `contacts` contacts with a wall.
struct LineOfMasses {
  CoulombSystem system;
  std::vector<double> mass;
  VecX<double> x;
  double mu;

  /// size: number of velocities of each mover; 3 for point masses, 6 for bodies of unit rotational inertia
  /// with contacts away from their centres.
  LineOfMasses(int movers, int size, int contacts, double friction, Draws& draws) : mu(friction) {
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

  /// Returns the largest violation of the velocity conditions of all contacts.
  double max_violation() const {
    double max_violation = 0;
    for (int k = 0; k < system.size(); ++k) {
      const Vec3<double>&p = system.impulse(k), u = system.velocity(k, x);
      const Eigen::Vector2d pull = p.tail<2>(), slip = u.tail<2>();
      REQUIRE(p[0] >= -1e-9);
      REQUIRE(pull.norm() <= mu * p[0] + 1e-6);
      max_violation = std::max(max_violation, -u[0]);
      if (p[0] > 1e-5) max_violation = std::max(max_violation, u[0]);
      if (pull.norm() < mu * p[0] - 1e-5) max_violation = std::max(max_violation, slip.norm());
    }
    return max_violation;
  }
};

}  // namespace

TEST_CASE("impulses of many contacts obey Coulomb's law at each contact", "[coulomb]") {
  Draws draws(7);
  for (const double mu : {0.0, 0.3, 0.8})
    for (int trial = 0; trial < 20; ++trial) {
      LineOfMasses line(1 + trial % 7, 6, 2, mu, draws);
      const CoulombResult result = line.system.solve(line.x);
      CHECK(result.residual < 1e-10);
      CHECK(result.fallbacks == 0);
      CHECK(line.max_violation() < 1e-8);
    }
}

TEST_CASE("impulses on point masses obey Coulomb's law", "[coulomb]") {
  Draws draws(8);
  for (int trial = 0; trial < 20; ++trial) {
    LineOfMasses line(10, 3, 1, 0.5, draws);
    const CoulombResult result = line.system.solve(line.x);
    CHECK(result.residual < 1e-5);
    CHECK(line.max_violation() < 1e-4);
  }
}

TEST_CASE("point masses with more contacts than degrees of freedom: the search succeeds", "[coulomb]") {
  Draws draws(11);
  for (int trial = 0; trial < 20; ++trial) {
    LineOfMasses line(2 + trial % 9, 3, 5, 0.4, draws);
    const CoulombResult result = line.system.solve(line.x);
    CHECK(result.residual < 1e-5);
    CHECK(result.fallbacks == 0);
  }
}

TEST_CASE("a mover that no impulse changes keeps its velocity", "[coulomb]") {
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

TEST_CASE("final velocities are the initial velocities plus the changes by the impulses", "[coulomb]") {
  Draws draws(9);
  LineOfMasses line(12, 3, 2, 0.5, draws);
  const VecX<double> before = line.x;
  line.system.solve(line.x);
  VecX<double> x = before;
  for (int k = 0; k < line.system.size(); ++k) line.system.add_change(k, 1, x);
  CHECK((x - line.x).norm() < 1e-15 * x.norm());
  CHECK((x - before).norm() > 1);
}

TEST_CASE("unconnected movers do not affect each other's impulses", "[coulomb]") {
  Draws one(10), copy(10);
  LineOfMasses single(4, 6, 2, 0.5, one), both(4, 6, 2, 0.5, copy);
  const int separate = both.system.add_mover(3);
  both.mass.push_back(1);
  both.system.add_contact(0.5);
  both.system.add_side(separate, 0, 3) = Mat3<double>::Identity();
  both.system.add_push(separate) = Mat3<double>::Identity();
  both.x.conservativeResize(both.x.size() + 3);
  both.x.tail<3>() << -1, 0.2, 0;
  single.system.solve(single.x);
  both.system.solve(both.x);
  CHECK(both.x.head(single.x.size()) == single.x);
  CHECK(both.x.tail<3>().norm() < 1e-11);
}

TEST_CASE("a warm start at the solution needs at most four sweeps", "[coulomb]") {
  Draws draws(11), copy(11);
  LineOfMasses line(8, 6, 2, 0.5, draws), again(8, 6, 2, 0.5, copy);
  const CoulombResult first = line.system.solve(line.x);
  CHECK(first.sweeps > 10);
  for (int k = 0; k < line.system.size(); ++k) again.system.impulse(k) = line.system.impulse(k);
  const CoulombResult second = again.system.solve(again.x);
  CHECK(second.sweeps <= 4);
  CHECK(second.residual < 1e-11);
  CHECK((again.x - line.x).norm() < 1e-10);
}

TEST_CASE("impulses also change velocities that no contact uses", "[coulomb]") {
  // The contacts use only some velocities of two large movers.
  constexpr int kSize = 30;
  const std::vector<Eigen::Index> used{2, 3, 4, 11, 20, 21};
  Draws draws(5);
  auto filled = [&](int rows, int columns) {
    MatX<double> matrix(rows, columns);
    for (double& number : matrix.reshaped()) number = draws.uniform(-1, 1);
    return matrix;
  };
  const MatX<double> root = filled(kSize, kSize),
                     inverse_mass = root * root.transpose() / kSize + MatX<double>::Identity(kSize, kSize);
  CoulombSystem full, reduced;
  for (int i = 0; i < 2; ++i) {
    full.add_mover(kSize);
    reduced.add_mover(6);
  }
  VecX<double> x = filled(2 * kSize, 1), x_reduced(12);
  for (int contact = 0; contact < 12; ++contact) {
    const int movers = contact < 3 ? 1 : 2;
    full.add_contact(0.5);
    reduced.add_contact(0.5);
    for (int i = 0; i < movers; ++i) {
      MatX<double> J = MatX<double>::Zero(3, kSize);
      J(Eigen::all, used) = filled(3, 6);
      full.add_side(i, 2, 3) = J.middleCols(2, 3);
      full.add_side(i, 11, 1) = J.col(11);
      full.add_side(i, 20, 2) = J.middleCols(20, 2);
      reduced.add_side(i, 0, 6) = J(Eigen::all, used);
      const MatX<double> Y = inverse_mass * J.transpose();
      full.add_push(i) = Y;
      reduced.add_push(i) = Y(used, Eigen::all);
    }
  }
  const VecX<double> before = x;
  x_reduced << before.head(kSize)(used), before.tail(kSize)(used);
  CHECK(full.solve(x).residual < 1e-10);
  CHECK(reduced.solve(x_reduced).residual < 1e-10);
  VecX<double> changed = before;
  for (int k = 0; k < full.size(); ++k) {
    CHECK((full.impulse(k) - reduced.impulse(k)).norm() < 1e-10);
    CHECK((full.velocity(k, x) - reduced.velocity(k, x_reduced)).norm() < 1e-10);
    full.add_change(k, 1, changed);
  }
  CHECK((changed - x).norm() < 1e-12);
  CHECK((x - before).tail(kSize)[0] != 0);
  CHECK((x.head(kSize)(used) - x_reduced.head(6)).norm() < 1e-10);
  CHECK((x.tail(kSize)(used) - x_reduced.tail(6)).norm() < 1e-10);
}

TEST_CASE("a tolerance as a share of the approach speed bounds the residual and saves sweeps", "[coulomb]") {
  for (const int size : {3, 6}) {
    int last_sweeps = std::numeric_limits<int>::max();
    for (const double share : {1e-12, 1e-8, 1e-4, 1e-2}) {
      CAPTURE(size, share);
      Draws draws(5);
      LineOfMasses line(12, size, 2, 0.5, draws);
      double approach = 0;
      for (int k = 0; k < line.system.size(); ++k)
        approach = std::max(approach, -line.system.velocity(k, line.x)[0]);
      const CoulombResult result = line.system.solve(line.x, {0, share});
      CHECK(result.residual <= share * approach + 1e-14);
      CHECK(result.worst_residual == result.residual);
      CHECK(result.worst_accepted >= share * approach * (1 - 1e-12));
      CHECK(result.worst_residual <= result.worst_accepted);
      CHECK(result.sweeps <= last_sweeps);
      last_sweeps = result.sweeps;
    }
  }
}

TEST_CASE("the search ends if it stalls because of nearly equal contacts", "[coulomb]") {
  // A body has four contacts with the ground. A fifth contact is a micrometre from one of them, with a
  // slightly different approach rate that only a huge impulse could equalise.
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

TEST_CASE("a motion that no impulse can stop is reported in the residual", "[coulomb]") {
  CoulombSystem system;
  system.add_mover(3);
  system.add_contact(0.5);
  system.add_side(0, 0, 3) = Mat3<double>::Identity();
  VecX<double> x = Vec3<double>(-2, 0, 0);
  const CoulombResult result = system.solve(x);
  CHECK(result.residual == Approx(2).epsilon(1e-15));
  CHECK(result.worst_residual == result.residual);
  CHECK(result.worst_accepted == Approx(2e-3));
  CHECK(x == Vec3<double>(-2, 0, 0));
}

TEST_CASE("a tolerance does not depend on the unit of a parameter at its limit", "[coulomb]") {
  // A body with three contacts with a wall and a parameter at its limit. unit: value of the parameter,
  // divided by its value in the first case.
  Draws draws(12);
  for (int trial = 0; trial < 20; ++trial) {
    Eigen::Matrix<double, 7, 7> root;
    for (double& entry : root.reshaped()) entry = draws.uniform(-1, 1);
    const Eigen::Matrix<double, 7, 7> inverse_mass =
        root * root.transpose() + 0.1 * Eigen::Matrix<double, 7, 7>::Identity();
    MatX<double> rows = MatX<double>::Zero(4, 7);
    for (int k = 0; k < 3; ++k)
      for (int j = 0; j < 7; ++j) rows(k, j) = (j == 0 ? 1 : 0) + draws.uniform(-0.4, 0.4);
    rows(3, 6) = -1;
    const double share = 1e-3;
    for (const double unit : {1.0, 1e5, 1e-5}) {
      CAPTURE(trial, unit);
      VecX<double> scale = VecX<double>::Ones(7);
      scale[6] = unit;
      CoulombSystem system;
      system.add_mover(7);
      for (int k = 0; k < 4; ++k) {
        if (k < 3)
          system.add_contact(0);
        else
          system.add_limit();
        const VecX<double> J = rows.row(k).transpose().cwiseQuotient(k < 3 ? scale : VecX<double>::Ones(7));
        system.add_side(0, 0, 7).row(0) = J.transpose();
        system.add_push(0).col(0) = scale.cwiseProduct(inverse_mass * scale.cwiseProduct(J));
      }
      VecX<double> x = VecX<double>::Zero(7);
      x[0] = -1;
      x[6] = unit;
      double approach = 0;
      for (int k = 0; k < 3; ++k) approach = std::max(approach, -system.velocity(k, x)[0]);
      system.solve(x, {0, share});
      for (int k = 0; k < 4; ++k) {
        const double u = system.velocity(k, x)[0], p = system.impulse(k)[0],
                     stopped = k < 3 ? approach : system.effect(k, k)(0, 0) * p;
        CHECK(u >= -share * stopped - 1e-9 * unit);
        if (p > 0) CHECK(u <= share * stopped + system.effect(k, k)(0, 0) * p * 1e-9);
      }
    }
  }
}

}  // namespace coulomb_system_test
