// The surface strain for colouring: correct for known stretches, zero for rigid motion.
#include <pliant/local/shell/surface_strain.h>

#include <Eigen/Geometry>

#include <pliant/math/scalar/functions.h>
#include <pliant/part/mesh/surface.h>
#include <pliant/part/registry.h>

#include "catch.h"

namespace surface_strain_test {

using namespace pliant;

namespace {

/// A surface mesh at rest: positions (m, columns) and triangles.
struct Skin {
  Eigen::Matrix3Xd X;
  Eigen::Matrix3Xi triangles;
};

Skin skin_of(const char* shape) {
  const std::unique_ptr<Part> part = make_part("part", shape, {}, 1000);
  part->prepare();
  const Surface surface(*part, 4);
  return {part->s(surface.material(), part->parameters().rest()), surface.triangles()};
}

// Two right triangles in the plane z = 0, of areas 1/2 and 1, that share the edge from (0, 0) to (0, 1).
Skin two_triangles() {
  Skin skin;
  skin.X.resize(3, 4);
  skin.X << 0, 0, 1, -2, 0, 1, 0, 0, 0, 0, 0, 0;
  skin.triangles.resize(3, 2);
  skin.triangles << 0, 0, 2, 1, 1, 3;
  return skin;
}

}  // namespace

TEST_CASE("a uniform stretch gives equal strain at every vertex") {
  for (const char* shape : {"sphere", "superellipsoid", "box", "cylinder", "supertoroid"}) {
    INFO(shape);
    const Skin skin = skin_of(shape);
    const SurfaceStrain strain(skin.X, skin.triangles);
    for (const double stretch : {1.1, 0.8, 1 + 1e-6}) {
      const VecX<double> at = strain.at(stretch * skin.X);
      const double green = 0.5 * (stretch * stretch - 1);
      CHECK((at.array() - green).abs().maxCoeff() < 1e-12);
    }
  }
}

TEST_CASE("rigid motion causes no strain, and rotation does not change the strain") {
  const Skin skin = skin_of("superellipsoid");
  const SurfaceStrain strain(skin.X, skin.triangles);
  const Mat3<double> R = Eigen::AngleAxisd(2.1, Vec3<double>(1, -2, 0.5).normalized()).toRotationMatrix();
  const Vec3<double> c(3, -4, 5);
  CHECK(strain.at((R * skin.X).colwise() + c).cwiseAbs().maxCoeff() < 1e-12);
  Mat3<double> F;
  F << 1.2, 0.3, 0, 0, 0.9, -0.1, 0.2, 0, 1;
  const VecX<double> here = strain.at(F * skin.X), turned = strain.at((R * F * skin.X).colwise() + c);
  CHECK(here.maxCoeff() > 0.1);
  CHECK((here - turned).cwiseAbs().maxCoeff() < 1e-12);
}

TEST_CASE("the strain is the largest principal strain") {
  const Skin skin = two_triangles();
  const SurfaceStrain strain(skin.X, skin.triangles);
  // Longer along x, shorter along y: the strain along x is the result.
  Mat3<double> F = Vec3<double>(1.3, 0.7, 5).asDiagonal();
  CHECK((strain.at(F * skin.X).array() - 0.5 * (1.69 - 1)).abs().maxCoeff() < 1e-14);
  // Shorter along both axes: the smaller contraction is the result.
  F = Vec3<double>(0.6, 0.9, 1).asDiagonal();
  CHECK((strain.at(F * skin.X).array() - 0.5 * (0.81 - 1)).abs().maxCoeff() < 1e-14);
  // Simple shear g: 2 G = [[0, g], [g, g^2]].
  const double g = 0.8;
  F = Mat3<double>::Identity();
  F(0, 1) = g;
  const double largest = 0.5 * (0.5 * g * g + std::hypot(0.5 * g * g, g));
  CHECK((strain.at(F * skin.X).array() - largest).abs().maxCoeff() < 1e-14);
}

TEST_CASE("the strain of a vertex is the area-weighted mean of its triangles") {
  const Skin skin = two_triangles();
  const SurfaceStrain strain(skin.X, skin.triangles);
  Eigen::Matrix3Xd x = skin.X;
  x(0, 2) = 2;  // the first triangle is twice as long along x: G = 3/2
  const VecX<double> at = strain.at(x);
  CHECK(at[2] == Approx(1.5));
  CHECK(at[3] == Approx(0).margin(1e-15));
  CHECK(at[0] == Approx(1.5 * 0.5 / 1.5));
  CHECK(at[1] == at[0]);
}

TEST_CASE("degenerate triangles have no weight") {
  Skin skin = two_triangles();
  skin.X.col(3) << 0, 0.5, 0;  // the vertex is on the edge
  const SurfaceStrain strain(skin.X, skin.triangles);
  const VecX<double> at = strain.at(1.1 * skin.X);
  CHECK(at.head(3).isApproxToConstant(0.105, 1e-12));
  CHECK(at[3] == 0);
}

}  // namespace surface_strain_test
