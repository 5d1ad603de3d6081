// Bending by mid-edge normals. The energy is exact for constant curvature and does not change in rigid
// motion. It converges on irregular meshes of plates and of a rolled sheet, and on spheres. It passes the
// checks of energy_laws.h. phi is the rotation of the normal of an edge (bending.h).
#include <pliant/local/shell/bending.h>

#include <pliant/local/shell/membrane.h>

#include "catch.h"
#include "modes.h"

namespace bending_test {

using namespace pliant;
using namespace pliant::test;

namespace {

constexpr Sheet kSheet{7e4, 0.3, 0.02};  // E (Pa), nu, thickness (m)
constexpr double kMass = 54;             // kg/m^2

/// Returns local coordinates: those of the nodes, followed by the own coordinates of the energy (phi).
VecX<double> with_own_coordinates(const VecX<double>& nodal, const VecX<double>& own) {
  VecX<double> x(nodal.size() + own.size());
  x << nodal, own;
  return x;
}
VecX<double> rest(const ShellMesh& mesh) {
  return field(mesh, [](const Vec3<double>& X) { return X; });
}
/// Returns the masses of the nodes' coordinates, followed by the inertia of phi.
VecX<double> all_masses(const NodalEnergy& bending, const ShellMesh& mesh) {
  return with_own_coordinates(kMass * thrice(node_areas(mesh)), bending.own_inertia());
}

template <class Bending>
void check_laws() {
  const ShellMesh small = icosphere(1, 0.7), large = icosphere(4, 0.7);
  const Bending bending(small, kSheet, kMass), more(large, kSheet, kMass);
  const bool linear = bending.of() == NodalEnergy::Of::displacement;
  const Eigen::Index own = bending.own_inertia().size();
  Draws draws(1);
  const VecX<double> at_rest =
      with_own_coordinates((linear ? 0.0 : 1.0) * rest(small), VecX<double>::Zero(own));
  const VecX<double> x = at_rest + random_vector(draws, at_rest.size(), 0.05);
  CHECK(bending.energy(at_rest) == 0);
  CHECK(force(bending, at_rest).norm() == 0);
  check_slopes(bending, x, linear ? 0.1 : 2e-3);
  check_stiffness(bending, x);
  check_bound(bending, at_rest, all_masses(bending, small), 2);
  check_bound(bending, x, all_masses(bending, small), 3);
  check_threads(more, with_own_coordinates((linear ? 0.0 : 1.0) * rest(large),
                                           VecX<double>::Zero(more.own_inertia().size())) +
                          random_vector(draws, 3 * large.n_nodes() + more.own_inertia().size(), 0.005));
}

/// Returns x with the values of phi for which the moments of all edges are zero. Coordinates of nodes do not
/// change.
VecX<double> with_balanced_edges(const NodalEnergy& bending, VecX<double> x, Eigen::Index n_nodes) {
  const Eigen::Index own = x.size() - 3 * n_nodes;
  const Eigen::SparseMatrix<double> K = stiffness(bending, x).bottomRightCorner(own, own);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(K);
  x.tail(own) += factor.solve(force(bending, x).tail(own));
  return x;
}

}  // namespace

TEST_CASE("bending: derivatives, matrix, threads, frequency bound, rest state", "[local]") {
  SECTION("linear") {
    check_laws<LinearBending>();
  }
  SECTION("folding") {
    check_laws<FoldingBending>();
  }
}

TEST_CASE("bending: rigid motion causes no strain, own coordinates carry no momentum", "[local]") {
  Draws draws(2);
  const ShellMesh mesh = icosphere(2, 0.7);
  const LinearBending linear(mesh, kSheet, kMass);
  const FoldingBending folding(mesh, kSheet, kMass);
  const Eigen::Index own = linear.own_inertia().size();
  const VecX<double> phi = random_vector(draws, own, 0.1);
  const Vec3<double> c(0.3, -0.2, 0.1), w(0.4, 0.1, -0.5);
  const Mat3<double> R = Eigen::AngleAxisd(2.1, Vec3<double>(1, -2, 0.5).normalized()).toRotationMatrix();
  const VecX<double> small =
      field(mesh, [&](const Vec3<double>& X) -> Vec3<double> { return c + w.cross(X); });
  const VecX<double> large = field(mesh, [&](const Vec3<double>& X) -> Vec3<double> { return c + R * X; });
  const VecX<double> none = VecX<double>::Zero(small.size());
  const VecX<double> push = force(linear, with_own_coordinates(none, phi));
  CHECK((force(linear, with_own_coordinates(small, phi)) - push).norm() <= 1e-12 * push.norm());
  CHECK(folding.energy(with_own_coordinates(large, phi)) ==
        Approx(folding.energy(with_own_coordinates(rest(mesh), phi))).epsilon(1e-12));
  CHECK(linear.energy(with_own_coordinates(small, phi)) ==
        Approx(linear.energy(with_own_coordinates(none, phi))).epsilon(1e-12));
  // The nodal forces due to phi have no resultant force and no resultant torque.
  const auto at = nodes(push, mesh.n_nodes());
  Vec3<double> torque = Vec3<double>::Zero();
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
    torque += Vec3<double>(mesh.X().row(i)).cross(Vec3<double>(at.row(i)));
  CHECK(at.colwise().sum().norm() <= 1e-12 * push.norm());
  CHECK(torque.norm() <= 1e-12 * push.norm());
  CHECK(linear.own_inertia().sum() ==
        Approx(kMass * node_areas(mesh).sum() * kSheet.thickness * kSheet.thickness / 12));
}

TEST_CASE("bending: constant curvature is exact on irregular meshes", "[local]") {
  Draws draws(3);
  const double a = 2, b = 1.5, xx = 0.3, yy = -0.2, xy = 0.25;  // second derivatives of w
  const ShellMesh mesh = irregular_sheet(7, 5, a, b, draws);
  const auto w = [&](const Vec3<double>& X) {
    return 0.5 * xx * X[0] * X[0] + 0.5 * yy * X[1] * X[1] + xy * X[0] * X[1];
  };
  const VecX<double> d = field(mesh, [&](const Vec3<double>& X) { return Vec3<double>(0, 0, w(X)); });
  for (const double nu : {-0.5, 0.0, 0.3, 0.5}) {
    const Sheet sheet{7e4, nu, 0.02};
    const LinearBending bending(mesh, sheet, kMass);
    const std::vector<ShellEdge> edges = shell_edges(mesh);
    // phi of an edge: the mean slope of its triangles in the direction across the edge, minus the slope of w
    // in this direction at the middle of the edge.
    VecX<double> phi(static_cast<Eigen::Index>(edges.size()));
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const Vec3<double> p = mesh.X().row(edges[e].a), q = mesh.X().row(edges[e].b), middle = 0.5 * (p + q);
      // unit vector across the edge, away from the left triangle
      const Vec3<double> across = (q - p).normalized().cross(Vec3<double>(0, 0, 1));
      const Vec3<double> slope(xx * middle[0] + xy * middle[1], yy * middle[1] + xy * middle[0], 0);
      // Returns the angle from the normal of triangle t to the mid-edge normal. A normal is (-slope, 1).
      const auto normal_angle = [&](int t) {
        const Vec3<double> A = mesh.corner(t, 0), B = mesh.corner(t, 1), C = mesh.corner(t, 2);
        Vec3<double> m = Vec3<double>(B[0] - A[0], B[1] - A[1], w(B) - w(A))
                             .cross(Vec3<double>(C[0] - A[0], C[1] - A[1], w(C) - w(A)));
        m /= m[2];
        return -slope.dot(across) - m.dot(across);
      };
      const double left = normal_angle(edges[e].left);
      phi[static_cast<Eigen::Index>(e)] =
          edges[e].inside() ? 0.5 * (left + normal_angle(edges[e].right)) : left;
    }
    const VecX<double> x = with_own_coordinates(d, phi), f = force(bending, x);
    const double trace = xx + yy, square = xx * xx + yy * yy + 2 * xy * xy;
    CHECK(bending.energy(x) ==
          Approx(0.5 * sheet.bending_stiffness() * (nu * trace * trace + (1 - nu) * square) * a * b)
              .epsilon(1e-12));
    const double largest = f.lpNorm<Eigen::Infinity>();
    const Eigen::Index n = mesh.n_nodes();
    for (std::size_t e = 0; e < edges.size(); ++e)
      if (edges[e].inside()) CHECK(std::abs(f[3 * n + static_cast<Eigen::Index>(e)]) <= 1e-12 * largest);
    // Inner nodes have no force, except nodes opposite to a boundary edge. The triangle of the edge exerts a
    // moment on the edge, and no second triangle balances this moment.
    std::vector<bool> across(static_cast<std::size_t>(n), false);
    for (const ShellEdge& edge : edges)
      if (!edge.inside())
        across[static_cast<std::size_t>(mesh.triangles()(edge.left_corner, edge.left))] = true;
    for (Eigen::Index i = 0; i < n; ++i)
      if (!across[static_cast<std::size_t>(i)] && std::abs(mesh.X()(i, 0)) < 0.499 * a &&
          std::abs(mesh.X()(i, 1)) < 0.499 * b)
        CHECK(std::abs(f[2 * n + i]) <= 1e-12 * largest);
  }
}

TEST_CASE("bending: for small displacements the folding energy equals the linear energy", "[local]") {
  Draws draws(4);
  const ShellMesh mesh = icosphere(1, 0.7);
  const LinearBending linear(mesh, kSheet, kMass);
  const FoldingBending folding(mesh, kSheet, kMass);
  const Eigen::Index own = linear.own_inertia().size();
  const VecX<double> dx = random_vector(draws, 3 * mesh.n_nodes() + own), f = force(linear, dx);
  CHECK((derivative(folding, with_own_coordinates(rest(mesh), VecX<double>::Zero(own)), dx) - f).norm() <=
        1e-12 * f.norm());
}

TEST_CASE("bending: a fold that passes half a turn keeps its energy, force and stiffness", "[local]") {
  // Two triangles with a common edge. Triangle 1 turns about the edge by the angle a, and the mid-edge normal
  // by half of this angle, relative to triangle 0. E is the energy of the angle a, for any number of turns.
  Nodes X(4, 3);
  X << 0, 0, 0, 0, 1, 0, -0.8, 0.4, 0, 0.9, 0.5, 0;
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 1, 1, 0, 2, 3;
  const ShellMesh mesh(X, triangles);
  const FoldingBending bending(mesh, kSheet, kMass);
  const Eigen::Index own = bending.own_inertia().size();
  const auto folded = [&](double a) {
    Nodes x = X;
    x.row(3) << 0.9 * std::cos(a), 0.5, -0.9 * std::sin(a);
    VecX<double> y = VecX<double>::Zero(own);
    const double turns = std::round(a / (2 * kPi)), rest = a - 2 * kPi * turns;
    y[0] = kPi * turns + fold_turn(rest).value;
    return with_own_coordinates(x.reshaped(), y);
  };
  const double unit = bending.energy(folded(0.5)) / 0.25;
  CHECK(unit > 0);
  for (const double a :
       {-7.0, -3.3, -3.1, -1.7, 0.3, 1.6, 2.5, 3.141, 3.142, 4.0, 6.2, 6.4, 9.4, 9.5, 12.0}) {
    CAPTURE(a);
    CHECK(bending.energy(folded(a)) == Approx(unit * a * a).epsilon(1e-10));
    Draws draws(11);
    const VecX<double> x = folded(a) + random_vector(draws, 12 + own, 0.05);
    check_slopes(bending, x, 5e-4);
    check_stiffness(bending, x);
  }
  // The force does not jump at half a turn.
  const VecX<double> before = force(bending, folded(kPi - 1e-9)), after = force(bending, folded(kPi + 1e-9));
  CHECK((after - before).norm() <= 1e-6 * before.norm());
}

TEST_CASE("bending: a triangle that swings about its edge beyond half a turn keeps its energy",
          "[local][long]") {
  // Two triangles, elastic in their planes, with a soft hinge. The angular velocity of one triangle about the
  // common edge is large enough for more than half a turn against the moment of the hinge.
  Nodes X(4, 3);
  X << 0, 0, 0, 0, 1, 0, -0.8, 0.4, 0, 0.9, 0.5, 0;
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 1, 1, 0, 2, 3;
  const ShellMesh mesh(X, triangles);
  const FoldingBending bending(mesh, {1e3, 0.3, 0.02}, kMass);
  const StVenantKirchhoffMembrane membrane(mesh, kSheet);
  const VecX<double> M = all_masses(bending, mesh),
                     rest_state =
                         with_own_coordinates(rest(mesh), VecX<double>::Zero(bending.own_inertia().size()));
  const Eigen::Index n = rest_state.size();
  const auto nodal = [](const VecX<double>& x) { return VecX<double>(x.head(12)); };
  const auto energy = [&](const VecX<double>& x, const VecX<double>& v) {
    return bending.energy(x) + membrane.energy(nodal(x)) + 0.5 * M.dot(v.cwiseAbs2());
  };
  const auto acceleration = [&](const VecX<double>& x) -> VecX<double> {
    VecX<double> f = force(bending, x);
    f.head(12) += force(membrane, nodal(x));
    return f.cwiseQuotient(M);
  };
  VecX<double> x = rest_state, v = VecX<double>::Zero(n);
  v[2 * 4 + 3] = -8;  // z of the tip, m/s
  const double start = energy(x, v), h = 2e-5;
  double worst = 0, least_turns = 0, most_turns = 0;
  for (int step = 0; step < 250000; ++step) {  // RK4
    const VecX<double> a1 = acceleration(x), a2 = acceleration(x + h / 2 * v),
                       a3 = acceleration(x + h / 2 * v + h * h / 4 * a1),
                       a4 = acceleration(x + h * v + h * h / 2 * a2);
    x += h * v + h * h / 6 * (a1 + a2 + a3);
    v += h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
    if (step % 100 != 0) continue;
    worst = std::max(worst, std::abs(energy(x, v) / start - 1));
    most_turns = std::max(most_turns, x[12]);
    least_turns = std::min(least_turns, x[12]);
  }
  INFO("y/pi from " << least_turns / kPi << " to " << most_turns / kPi << ", energy error " << worst);
  CHECK(least_turns < -1.2 * kPi);
  CHECK(worst <= 1e-9);
}

TEST_CASE("bending: an irregular sheet rolled to half a cylinder has the energy of the cylinder", "[local]") {
  const double a = 1, b = 0.6, r = a / kPi;
  double error[3];
  for (int k = 0; k < 3; ++k) {
    Draws draws(5);
    const ShellMesh mesh = irregular_sheet(10 << k, 6 << k, a, b, draws);
    const FoldingBending bending(mesh, kSheet, kMass);
    const auto roll = [&](const Vec3<double>& X) {
      return Vec3<double>(r * std::sin(X[0] / r), X[1], r * std::cos(X[0] / r));
    };
    // Returns the angle about an edge from the normal of a triangle to the normal of the cylinder at the
    // middle of the edge, rad.
    const auto normal_angle = [&](int t, int corner) {
      const std::array<Vec3<double>, 3> X{mesh.corner(t, corner), mesh.corner(t, (corner + 1) % 3),
                                          mesh.corner(t, (corner + 2) % 3)};
      const Vec3<double> e = (roll(X[2]) - roll(X[1])).normalized(), own = e.cross(roll(X[0]) - roll(X[1]));
      const double angle = 0.5 * (X[1][0] + X[2][0]) / r;
      const Vec3<double> normal(std::sin(angle), 0, std::cos(angle));
      return std::atan2(e.dot(own.cross(normal)), own.dot(normal) - own.dot(e) * e.dot(normal));
    };
    const std::vector<ShellEdge> edges = shell_edges(mesh);
    VecX<double> phi(static_cast<Eigen::Index>(edges.size()));
    for (std::size_t e = 0; e < edges.size(); ++e) {
      const double left = normal_angle(edges[e].left, edges[e].left_corner);
      phi[static_cast<Eigen::Index>(e)] =
          edges[e].inside() ? 0.5 * (left - normal_angle(edges[e].right, edges[e].right_corner)) : left;
    }
    const double expected = 0.5 * kSheet.bending_stiffness() / (r * r) * a * b;
    error[k] = std::abs(bending.energy(with_own_coordinates(field(mesh, roll), phi)) / expected - 1);
  }
  INFO("errors " << error[0] << ", " << error[1] << ", " << error[2]);
  CHECK(error[2] <= 0.005);
  CHECK(std::log2(error[0] / error[2]) >= 2 * 1.7);
}

TEST_CASE("bending: on a sphere the energy converges to that of Koiter and Sanders", "[local]") {
  // Y is a surface harmonic of degree n. Displacements w Y along the normal and u grad Y along the sphere
  // rotate normals by (u - w) grad Y. The energy on the unit sphere is E = D/2 b (b - 1 + nu) (u - w)^2 int
  // Y^2, b = n (n + 1).
  const int n = 2;
  const double b = n * (n + 1), nu = 0.3;
  for (const bool along : {false, true}) {
    double error[3];
    for (int k = 0; k < 3; ++k) {
      const ShellMesh mesh = icosphere(2 + k, 1);
      const Sheet sheet{12 * (1 - nu * nu), nu, 1};
      const LinearBending bending(mesh, sheet, 1);
      const VecX<double> area = sphere_areas(mesh), d = harmonic_fields(mesh, n).col(along ? 1 : 0);
      // If `along` is true, d contains grad Y / n; int |grad Y|^2 = b int Y^2.
      const double square = thrice(area).dot(d.cwiseAbs2()) * (along ? n * n / b : 1);
      const double scale = along ? 1.0 / n : 1;
      const VecX<double> x = with_balanced_edges(
          bending, with_own_coordinates(d, VecX<double>::Zero(bending.own_inertia().size())), mesh.n_nodes());
      error[k] = std::abs(bending.energy(x) / (0.5 * b * (b - 1 + nu) * square * scale * scale) - 1);
    }
    INFO((along ? "along" : "across") << ": errors " << error[0] << ", " << error[1] << ", " << error[2]);
    CHECK(error[2] <= 0.012);
    CHECK(std::log2(error[1] / error[2]) >= 1.9);
  }
}

namespace {

/// Deflection of a square plate under a load of 1 per area: in the middle, and its integral over the plate.
/// The side of the plate and its bending stiffness D are 1.
struct Deflection {
  double middle, integral;
};
/// Solves for an irregular plate of n x n cells. clamped: whether the edges are clamped or simply supported.
Deflection plate(int n, bool clamped, std::uint64_t seed) {
  Draws draws(seed);
  const ShellMesh random_sheet = irregular_sheet(n, n, 1, 1, draws);
  Nodes X = random_sheet.X();
  const Eigen::Index center = (n / 2) * (n + 1) + n / 2;
  X.row(center).setZero();
  const ShellMesh mesh(X, random_sheet.triangles());
  const Sheet sheet{12 * (1 - 0.3 * 0.3) * 1e6, 0.3, 0.01};
  const LinearBending bending(mesh, sheet, 1);
  const std::vector<ShellEdge> edges = shell_edges(mesh);
  const Eigen::Index nodes = mesh.n_nodes(), own = static_cast<Eigen::Index>(edges.size());
  const auto on_boundary = [&](Eigen::Index i) { return X.row(i).cwiseAbs().maxCoeff() > 0.4999; };
  // Free coordinates: z of inner nodes, and phi of all edges that are not clamped. A clamped edge has
  // phi = -z/height, where z is the displacement of the opposite corner and height its distance from the
  // edge.
  std::vector<Eigen::Index> column(static_cast<std::size_t>(nodes), -1);
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::Index n_free = 0;
  for (Eigen::Index i = 0; i < nodes; ++i)
    if (!on_boundary(i))
      entries.emplace_back(2 * nodes + i, column[static_cast<std::size_t>(i)] = n_free++, 1);
  for (Eigen::Index e = 0; e < own; ++e) {
    const ShellEdge& edge = edges[static_cast<std::size_t>(e)];
    const auto across = static_cast<Eigen::Index>(mesh.triangles()(edge.left_corner, edge.left));
    if (edge.inside() || !clamped) {
      entries.emplace_back(3 * nodes + e, n_free++, 1);
    } else if (!on_boundary(across)) {
      const double length = (X.row(edge.b) - X.row(edge.a)).norm();
      entries.emplace_back(3 * nodes + e, column[static_cast<std::size_t>(across)],
                           -length / (2 * mesh.area(edge.left)));
    }
  }
  Eigen::SparseMatrix<double> T(3 * nodes + own, n_free);
  T.setFromTriplets(entries.begin(), entries.end());
  VecX<double> F = VecX<double>::Zero(3 * nodes + own);
  F.segment(2 * nodes, nodes) = node_areas(mesh);
  const Eigen::SparseMatrix<double> K = T.transpose() * stiffness(bending, VecX<double>::Zero(F.size())) * T;
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(K);
  const VecX<double> u = T * factor.solve(T.transpose() * F);
  return {u[2 * nodes + center], F.dot(u)};
}

}  // namespace

TEST_CASE("bending: plates on irregular meshes converge with the square of the edge length", "[local]") {
  double integral = 0;  // Navier's series
  for (int m = 1; m < 60; m += 2)
    for (int n = 1; n < 60; n += 2)
      integral += 64 / (std::pow(kPi, 8) * m * m * n * n * std::pow(m * m + n * n, 2));
  double middle[3], whole[3], clamped[3];
  for (int k = 0; k < 3; ++k) {
    const Deflection supported = plate(8 << k, false, 6);
    middle[k] = std::abs(supported.middle / 0.00406235266 - 1);
    whole[k] = std::abs(supported.integral / integral - 1);
    clamped[k] = std::abs(plate(8 << k, true, 6).middle / 0.00126531909 - 1);
  }
  INFO("supported, middle " << middle[0] << ", " << middle[1] << ", " << middle[2]);
  INFO("supported, whole " << whole[0] << ", " << whole[1] << ", " << whole[2]);
  INFO("clamped, middle " << clamped[0] << ", " << clamped[1] << ", " << clamped[2]);
  for (const double* error : {middle, whole, clamped}) {
    CHECK(error[2] <= 0.03);
    CHECK(std::log2(error[0] / error[2]) >= 2 * 1.8);
  }
}

}  // namespace bending_test
