// Forces and joints on a patch of nodes: independence of the mesh, the correct torque, and closed joints. A
// patch is the set of nodes within a radius of a material point (Point::patch).
#include "catch.h"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>

#include <pliant/body/placed_point.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/local/patch_weights.h>

#include "draws.h"
#include "motion.h"

namespace local_patches_test {

using namespace pliant;

namespace {

constexpr double kPatch = 0.6;  // radius of a patch, m

/// Returns settings of a soft shell or solid. order: order of the elements of a solid.
LocalSettings soft(int resolution, bool shell, int order = 1) {
  LocalSettings settings;
  settings.resolution = resolution;
  settings.order = order;
  settings.energies.push_back(shell ? local_law("membrane", {1e4, 0.3, 0.05})
                                    : local_law("elastic", {1e4, 0.3}));
  return settings;
}

/// Returns how far opposite poles of a free ball move apart under a pull of 1 N at each pole, m. patch:
/// radius of the patch on which each force acts, m; 0: the force acts at the pole.
double stretch(int resolution, double patch) {
  Primitive<Sphere> ball("ball", 1000);
  ball.deform_locally(soft(resolution, false));
  ball.prepare();
  const NodalDeformation& local = *ball.local()->nodal();
  const Eigen::Index n = local.n_nodes();
  std::vector<Eigen::Triplet<double>> entries;
  local.energies()[0]->add_stiffness(VecX<double>::Zero(3 * n), entries);
  // A small multiple of the mass matrix makes K regular for rigid motions, in which the pull does no work.
  for (Eigen::Index k = 0; k < 3 * n; ++k) entries.emplace_back(k, k, 1e-6 * local.inertia()[k]);
  Eigen::SparseMatrix<double> K(3 * n, 3 * n);
  K.setFromTriplets(entries.begin(), entries.end());
  VecX<double> f = VecX<double>::Zero(3 * n);
  for (const double side : {-1.0, 1.0}) {
    const Material<double> pole = material_at(side * kPi / 2, 0);
    const NodeWeights weights =
        patch > 0 ? patch_weights(ball, local.mesh(), pole, patch) : local.weights(ball, pole);
    for (std::size_t i = 0; i < weights.node.size(); ++i)
      f[2 * n + weights.node[i]] += side * weights.weight[i];
  }
  return f.dot(Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>(K).solve(f));
}

}  // namespace

TEST_CASE(
    "the displacement under a pull on a patch does not depend on the mesh; at a point it grows without bound",
    "[local][patch][long]") {
  const double coarse = stretch(4, kPatch), middle = stretch(6, kPatch), fine = stretch(9, kPatch);
  const double point_coarse = stretch(4, 0), point_middle = stretch(6, 0), point_fine = stretch(9, 0);
  CAPTURE(coarse, middle, fine, point_coarse, point_middle, point_fine);
  CHECK(std::abs(middle - coarse) < 0.02 * fine);
  CHECK(std::abs(fine - middle) < 0.02 * fine);
  // The displacement grows like 1 / (edge length of the mesh).
  CHECK(point_middle / point_coarse > 1.3);
  CHECK(point_fine / point_middle > 1.3);
}

TEST_CASE("a patch reproduces its point at rest, on the surface and inside", "[local][patch]") {
  test::Draws draws(2);
  struct Kind {
    const char* shape;
    bool shell;
    int order;
  };
  for (const Kind& kind : {Kind{"ellipsoid", true, 1}, Kind{"box", true, 1}, Kind{"ellipsoid", false, 1},
                           Kind{"superellipsoid", false, 2}, Kind{"cylinder", false, 1}}) {
    CAPTURE(kind.shape, kind.shell, kind.order);
    auto part = make_part("soft", kind.shape, {}, 1000);
    if (kind.shell) part->make_shell();
    part->rest({{"a1", 0.9}, {"a2", 1.1}})
        .deform_locally(soft(kind.order == 2 ? 3 : 6, kind.shell, kind.order));
    part->prepare();
    const LocalMesh& mesh = part->local()->mesh();
    for (int trial = 0; trial < 20; ++trial) {
      Material<double> m = draws.material(MeshPattern::ball);
      if (kind.shell || trial % 2 == 0) m.w = 1;
      const NodeWeights weights = patch_weights(*part, mesh, m, 0.7);
      const Vec3<double> x = part->s({m}, part->parameters().rest()).col(0);
      double sum = 0, size = 0;
      Vec3<double> mean = Vec3<double>::Zero();
      for (std::size_t i = 0; i < weights.node.size(); ++i) {
        sum += weights.weight[i];
        size += std::abs(weights.weight[i]);
        mean += weights.weight[i] * mesh.X.row(weights.node[i]).transpose();
      }
      CHECK(weights.node.size() > 8);
      CHECK(size <= 4);
      CHECK(sum == Approx(1).epsilon(1e-12));
      CHECK((mean - x).norm() <= 1e-9);
    }
    // A radius smaller than all edges of the mesh selects only the element of the point.
    const Material<double> m = material_at(0.3, 0.4);
    CHECK(patch_weights(*part, mesh, m, 1e-3) == part->local()->weights(*part, m));
  }
}

TEST_CASE("a force on a patch rotates the part as a force at its point does", "[local][patch][motion]") {
  for (const bool shell : {false, true}) {
    MultiBody body;
    body.gravity.setZero();
    auto& ball = body.add<Primitive<Ellipsoid>>("ball", 10);
    if (shell) ball.make_shell();
    ball.rest({{"a1", 0.8}}).deform_locally(soft(5, shell));
    const Point at = point(ball, material_at(0.5, 0.3), kPatch);
    const Vec3<double> force(0.3, -0.2, 0.5);
    body.force("push", at, TimeVector(force));
    Simulation simulation(body, "rk4");
    const Vec3<double> x = PlacedPoint(simulation.model(), at).at(simulation.state());
    CHECK((x - ball.s({at.material}, ball.parameters().rest()).col(0)).norm() <= 1e-12);
    const double h = 1e-6;
    simulation.step(h);
    const Ledger ledger = simulation.ledger();
    CHECK((ledger.momentum / h - force).norm() <= 1e-9);
    CHECK((ledger.angular_momentum / h - x.cross(force)).norm() <= 1e-8);
  }
}

TEST_CASE("a joint constrains the mean of its patch", "[local][patch][motion]") {
  for (const bool shell : {false, true}) {
    MultiBody body;
    auto& ball = body.add<Primitive<Ellipsoid>>("ball", shell ? 30.0 : 300.0);
    if (shell) ball.make_shell();
    ball.rest({{"a1", 0.8}}).stiffness({{"a3", 1e3}}).deform_locally(soft(4, shell));
    auto& stone = body.add<Primitive<Sphere>>("stone", 50);
    stone.rest({{"r", 0.3}}).place({0, 0, -1.3});
    body.ball("hook", world(0, 0, 1), point(ball, material_at(kPi / 2, 0), kPatch));
    body.hinge("knee", point(ball, material_at(-kPi / 2, 0), kPatch), point(stone, kPi / 2, 0), {1, 0, 0});
    Simulation simulation(body, "rk4");
    const double start = simulation.ledger().energy();
    double gap = 0;
    for (int i = 0; i < 150; ++i) {
      simulation.step(1e-3);
      for (int j = 0; j < 2; ++j) gap = std::max(gap, simulation.model().gap(simulation.state(), j));
    }
    CHECK(gap <= 1e-11);
    CHECK(std::abs(simulation.ledger().balance) <= 1e-3 * std::abs(start));
    CHECK((PlacedPoint(simulation.model(), point(ball, material_at(kPi / 2, 0), kPatch))
               .at(simulation.state()) -
           Vec3<double>(0, 0, 1))
              .norm() <= 1e-11);
  }
}

TEST_CASE("patches on parts without nodes are refused", "[local][patch]") {
  MultiBody body;
  auto& stone = body.add<Primitive<Sphere>>("stone", 1000);
  body.force("push", point(stone, material_at(0, 0), 0.1), TimeVector(Vec3<double>(1, 0, 0)));
  CHECK_THROWS_WITH(Simulation(body, "rk4"),
                    test::has_text("force 'push': its point on part 'stone' has a patch of nodes"));
  MultiBody other;
  auto& ball = other.add<Primitive<Sphere>>("ball", 1000);
  ball.deform_locally(soft(3, false));
  other.force("push", point(ball, material_at(0, 0), -0.1), TimeVector(Vec3<double>(1, 0, 0)));
  CHECK_THROWS_WITH(Simulation(other, "rk4"), test::has_text("needs a patch with a positive radius"));
}

}  // namespace local_patches_test
