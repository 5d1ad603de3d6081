// Meshes of local deformation: masses and moments, points among the nodes.
#include "catch.h"

#include <pliant/deform/all_deforms.h>
#include <pliant/part/registry.h>

#include "draws.h"

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

TEST_CASE("weights of a material point make up its place at rest", "[local]") {
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
      // A shell of flat triangles is as near to the point as its mesh is fine.
      CHECK((x - X).norm() <= (kind.shell ? 0.05 : 1e-10) * part->size());
    }
    if (kind.shell) CHECK(local.weights(*part, material_at(0, 0, 0.5)).node.empty());
  }
}
