// Meshes of local deformation: masses and moments, points between nodes, the parameter rectangle (the ranges
// of u and v).
#include "catch.h"

#include <pliant/deform/all_deforms.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/part/local/nodal_deformation.h>
#include <pliant/part/mesh/parameter_mesh.h>
#include <pliant/part/registry.h>

#include "draws.h"

namespace local_deformation_test {

using namespace pliant;

namespace {

struct Kind {
  bool shell;
  int order;
};

std::unique_ptr<Part> soft(const std::string& shape, const Kind& kind) {
  auto part = make_part("soft", shape, {"taper"}, 3);
  if (kind.shell) part->make_shell();
  part->rest({{"taper.tx", 0.2}, {"taper.ty", -0.1}});
  LocalSettings settings;
  settings.resolution = 3;
  settings.order = kind.order;
  part->deform_locally(settings);
  part->prepare();
  return part;
}

}  // namespace

TEST_CASE("nodes of every shape have the mass, the centre and the inertia of the part", "[local]") {
  for (const auto& shape : all_shapes())
    for (const Kind kind : {Kind{true, 1}, Kind{false, 1}, Kind{false, 2}}) {
      CAPTURE(shape->name(), kind.shell, kind.order);
      const auto part = soft(shape->name(), kind);
      const LocalMesh& mesh = part->local()->mesh();
      CHECK(mesh.mass.minCoeff() > 0);
      CHECK(mesh.mass.sum() == Approx(part->total_mass()).epsilon(1e-12));
      Mat3<double> I = Mat3<double>::Zero();
      Vec3<double> moment = Vec3<double>::Zero();
      for (Eigen::Index k = 0; k < mesh.X.rows(); ++k) {
        const Vec3<double> x = mesh.X.row(k).transpose();
        moment += mesh.mass[k] * x;
        I += mesh.mass[k] * (x.squaredNorm() * Mat3<double>::Identity() - x * x.transpose());
      }
      const Inertia<double>& whole = part->rest_inertia();
      CHECK((moment - whole.moment).norm() <= 1e-11 * whole.mass * part->size());
      CHECK((I - whole.M.block<3, 3>(3, 3)).norm() <= 1e-11 * I.norm());
    }
}

TEST_CASE("weights of a material point give its position at rest", "[local]") {
  for (const Kind kind : {Kind{true, 1}, Kind{false, 1}, Kind{false, 2}}) {
    const auto part = soft("superellipsoid", kind);
    const LocalDeformation& local = *part->local();
    test::Draws draw(7);
    for (int i = 0; i < 50; ++i) {
      const double w = kind.shell || i % 2 == 0 ? 1 : draw.uniform(0, 0.9);
      const Material<double> m = material_at(draw.uniform(-1.5, 1.5), draw.uniform(-3, 3), w);
      const NodeWeights at = local.weights(*part, m);
      Vec3<double> x = Vec3<double>::Zero();
      double sum = 0;
      for (std::size_t k = 0; k < at.node.size(); ++k) {
        x += at.weight[k] * local.mesh().X.row(at.node[k]).transpose();
        sum += at.weight[k];
      }
      CHECK(sum == Approx(1).epsilon(1e-12));
      const Vec3<double> X = part->s({m}, part->parameters().rest()).col(0);
      // For a shell of flat triangles the accuracy is that of the mesh.
      CHECK((x - X).norm() <= (kind.shell ? 0.05 : 1e-10) * part->size());
    }
    if (kind.shell) CHECK(local.weights(*part, material_at(0, 0, 0.5)).node.empty());
  }
}

TEST_CASE("nodes of thin parts have the correct moments, relative to each dimension", "[local]") {
  for (const bool shell : {true, false}) {
    const auto part = make_part("thin", "ellipsoid", {}, 3);
    if (shell) part->make_shell();
    part->rest({{"a1", 1}, {"a2", 1e-2}, {"a3", 1e-3}});
    LocalSettings settings;
    settings.resolution = 4;
    part->deform_locally(settings);
    part->prepare();
    const LocalMesh& mesh = part->local()->mesh();
    const Mat3<double> I = part->rest_inertia().M.block<3, 3>(3, 3);
    for (int r = 0; r < 3; ++r) {
      const double square = 0.5 * I.trace() - I(r, r);
      CHECK(mesh.mass.dot(mesh.X.col(r).cwiseAbs2()) == Approx(square).epsilon(1e-8));
    }
  }
}

TEST_CASE("a part whose mesh would be degenerate is refused", "[local]") {
  const auto part = make_part("thread", "ellipsoid", {}, 3);
  part->make_shell().rest({{"a1", 1}, {"a2", 1e-9}, {"a3", 1e-9}});
  LocalSettings settings;
  settings.resolution = 2;
  part->deform_locally(settings);
  CHECK_THROWS_WITH(part->prepare(), test::has_text("part 'thread': a mesh of resolution 2"));
}

TEST_CASE("the mesh of a shell covers its parameter rectangle once", "[local]") {
  for (const auto& shape : all_shapes()) {
    CAPTURE(shape->name());
    const bool torus = shape->mesh() == MeshPattern::torus;
    const auto part = make_part("soft", shape->name(), {}, 3);
    part->make_shell();
    for (const int resolution : {1, 2, 5}) {
      LocalSettings settings;
      settings.resolution = resolution;
      part->deform_locally(settings);
      part->prepare();
      const ParameterMesh flat = parameter_mesh(part->local()->mesh());
      double area = 0;
      for (Eigen::Index t = 0; t < flat.triangles.cols(); ++t) {
        const Eigen::Vector2d p = flat.uv.col(3 * t + 1) - flat.uv.col(3 * t),
                              q = flat.uv.col(3 * t + 2) - flat.uv.col(3 * t);
        area += 0.5 * std::abs(p[0] * q[1] - p[1] * q[0]);
      }
      CHECK(area == Approx((torus ? 4 : 2) * kPi * kPi).epsilon(1e-12));
    }
  }
}

TEST_CASE("the loaded membrane over the rectangle: exact for a linear field, second order for others",
          "[local]") {
  const double w0 = 3, w1 = 7;
  std::vector<double> errors;
  for (const int resolution : {4, 8, 16}) {
    const auto part = make_part("soft", "ellipsoid", {}, 3);
    part->make_shell().rest({{"a1", 0.3}});
    LocalSettings settings;
    settings.resolution = resolution;
    settings.energies = {local_law("loaded_membrane_uv", {w0, w1})};
    part->deform_locally(settings);
    part->prepare();
    const NodalDeformation& local = *part->local()->nodal();
    auto energy = [&](auto&& of) {
      VecX<double> d = VecX<double>::Zero(local.n_d());
      for (Eigen::Index k = 0; k < local.n_nodes(); ++k)
        d[k] = of(angles(local.mesh().nodes[static_cast<std::size_t>(k)]));
      return local.energies()[0]->energy(d);
    };
    // The energy is 1/2 int (w1 |grad d|^2 + w0 d^2) du dv.
    // d = u: int 1 = 2 pi^2, int u^2 = pi^4 / 6.
    CHECK(energy([](const MaterialAngles& at) { return at.u; }) ==
          Approx(0.5 * (w1 * 2 * kPi * kPi + w0 * std::pow(kPi, 4) / 6)).epsilon(1e-12));
    // d = cos^2 u cos v: int |grad d|^2 = 7 pi^2 / 8, int d^2 = 3 pi^2 / 8.
    const double exact = kPi * kPi / 16 * (7 * w1 + 3 * w0);
    errors.push_back(std::abs(energy([](const MaterialAngles& at) {
                                return std::cos(at.u) * std::cos(at.u) * std::cos(at.v);
                              }) / exact -
                              1));
  }
  CAPTURE(errors[0], errors[1], errors[2]);
  CHECK(std::log2(errors[1] / errors[2]) >= 1.9);
  CHECK(errors[2] <= 0.02);
}

}  // namespace local_deformation_test
