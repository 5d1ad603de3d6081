// Mass distributions mu(u), Eq. (11): mass, centre and inertia against closed forms; dynamic parameters;
// nodes.
#include <cmath>
#include <memory>

#include <pliant/part/local/local_deformation.h>
#include <pliant/part/registry.h>

#include "catch.h"
#include "doubling_error.h"

namespace mass_distribution_test {

using namespace pliant;

namespace {

/// Returns a distribution from a function of a material point and of its place at rest.
template <class F>
MassDistribution each(F multiple) {
  return [multiple](const std::vector<Material<double>>& at, const Eigen::Matrix3Xd& X) {
    Eigen::VectorXd all(X.cols());
    for (Eigen::Index k = 0; k < X.cols(); ++k)
      all[k] = multiple(at[static_cast<std::size_t>(k)], Vec3<double>(X.col(k)));
    return all;
  };
}

std::unique_ptr<Part> part_of(const char* shape, const Part::Named& rest, MassDistribution distribution,
                              const std::vector<std::string>& chain = {}) {
  std::unique_ptr<Part> part = make_part("part", shape, chain, 1000);
  part->rest(rest);
  part->distribute_mass(std::move(distribution));
  return part;
}

std::string refusal(Part& part) {
  try {
    part.prepare();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "";
}

}  // namespace

TEST_CASE("a density that grows along z: mass, centre and inertia of ellipsoid and box", "[mass]") {
  const double a = 0.3, b = 0.2, c = 0.5, slope = 1.7;
  const auto along_z = each([&](const auto&, const Vec3<double>& X) { return 1 + slope * X[2]; });
  // volume: volume / (a b c); square: mean of x^2 / a^2.
  for (const auto& [shape, volume, square] :
       {std::tuple("ellipsoid", 4 * kPi / 3, 0.2), std::tuple("box", 8.0, 1.0 / 3)}) {
    const auto part = part_of(shape, {{"a1", a}, {"a2", b}, {"a3", c}}, along_z);
    part->prepare();
    const Inertia<double>& inertia = part->rest_inertia();
    const double mass = 1000 * volume * a * b * c;
    CAPTURE(shape);
    CHECK(inertia.mass == Approx(mass).epsilon(1e-13));
    CHECK(inertia.moment[2] == Approx(mass * slope * c * c * square).epsilon(1e-13));
    CHECK(inertia.moment.head<2>().norm() <= 1e-13 * mass);
    CHECK(inertia.M(3, 3) == Approx(mass * (b * b + c * c) * square).epsilon(1e-13));
    CHECK(inertia.M(5, 5) == Approx(mass * (a * a + b * b) * square).epsilon(1e-13));
  }
}

TEST_CASE("a density that depends on material coordinates: a heavy rim and a hollow centre", "[mass]") {
  // The material point (u, v, w) of a sphere is at the radius w r: mass 4 pi rho integral w^2 * w^2 r^3 dw.
  const auto rim =
      part_of("sphere", {{"r", 0.4}}, each([](const auto& m, const auto&) { return m.w * m.w; }));
  rim->prepare();
  const double full = 1000 * 4 * kPi * std::pow(0.4, 3);
  CHECK(rim->total_mass() == Approx(full / 5).epsilon(1e-13));
  CHECK(rim->rest_inertia().M(4, 4) == Approx(2.0 / 3 * full / 7 * 0.16).epsilon(1e-13));
  // On a shell: mu = 1 + cos(v) / 2 moves the centre along x by a quarter of <x^2> / r.
  const auto shell = part_of("sphere", {{"r", 0.4}},
                             each([](const auto& m, const auto&) { return 1 + 0.5 * m.cu.x * m.cv.x; }));
  shell->make_shell();
  shell->prepare();
  CHECK(shell->rest_inertia().moment[0] / shell->total_mass() == Approx(0.5 * 0.4 / 3).epsilon(1e-13));
}

TEST_CASE("a given mass is the mass of the whole distribution", "[mass]") {
  const auto part = part_of("box", {}, each([](const auto&, const Vec3<double>& X) { return 2 + X[0]; }));
  part->mass(3);
  part->prepare();
  CHECK(part->total_mass() == Approx(3).epsilon(1e-14));
  CHECK(part->rest_inertia().moment[0] == Approx(3.0 / 2 / 3).epsilon(1e-13));
}

TEST_CASE("mass points of a distribution are exact for all values of dynamic parameters", "[mass][long]") {
  const auto tilted = each([](const auto&, const Vec3<double>& X) {
    return 0.6 + std::exp(0.8 * X[0] - 0.5 * X[1]) + 0.5 * std::sin(3 * X[2]);
  });
  struct Case {
    const char* shape;
    std::vector<std::string> chain, dynamic;
    bool shell;
  };
  for (const Case& c : {Case{"ellipsoid", {}, {"a1", "a3"}, false},
                        Case{"superellipsoid", {"taper", "twist"}, {"a2", "taper.tx", "twist.angle"}, false},
                        Case{"superellipsoid", {}, {"eps1", "eps2"}, false},
                        Case{"supertoroid", {"bend"}, {"bend.angle"}, true}}) {
    const auto part = part_of(c.shape, {}, tilted, c.chain);
    if (c.shell) part->make_shell();
    part->make_dynamic(c.dynamic);
    part->prepare();
    CAPTURE(c.shape, part->mass_points().n_points, part->mass_points().relative_error);
    CHECK(test::doubling_error(*part, 10) <= 1e-11);
  }
}

TEST_CASE("the distribution mu(u) = 1 gives the inertia of a part without a distribution", "[mass][long]") {
  auto inertia_of = [](bool distributed) {
    const auto part = make_part("part", "superellipsoid", {"taper", "bend"}, 1000);
    part->rest({{"eps1", 0.4}, {"eps2", 1.4}, {"taper.tx", 0.5}, {"bend.angle", 0.6}});
    if (distributed) part->distribute_mass(each([](const auto&, const auto&) { return 1.0; }));
    part->prepare();
    return part->rest_inertia().M;
  };
  const auto M = inertia_of(false);
  CHECK((inertia_of(true) - M).norm() <= 1e-12 * M.norm());
}

TEST_CASE("nodes of a soft part have the mass distribution", "[mass]") {
  const auto part = part_of("ellipsoid", {{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.5}},
                            each([](const auto&, const Vec3<double>& X) { return 1 + 1.5 * X[2]; }));
  LocalSettings settings;
  settings.resolution = 3;
  part->deform_locally(settings);
  part->prepare();
  const LocalMesh& mesh = part->local()->mesh();
  CHECK(mesh.mass.sum() == Approx(part->total_mass()).epsilon(1e-12));
  CHECK((mesh.X.transpose() * mesh.mass - part->rest_inertia().moment).norm() <= 1e-12 * part->total_mass());
  // A node with z > 0 is heavier than its mirror image with z < 0, by about the ratio of the densities.
  double above = 0, below = 0;
  for (Eigen::Index k = 0; k < mesh.mass.size(); ++k)
    (mesh.X(k, 2) > 0 ? above : below) += std::abs(mesh.X(k, 2)) > 0.2 ? mesh.mass[k] : 0;
  CHECK(above > 1.5 * below);
}

TEST_CASE("impossible mass distributions are refused", "[mass]") {
  const auto negative = part_of("sphere", {}, each([](const auto&, const Vec3<double>& X) { return X[2]; }));
  CHECK(refusal(*negative).find("mass distribution is -") != std::string::npos);
  const auto one = each([](const auto&, const auto&) { return 1.0; });
  const auto given = part_of("sphere", {}, one);
  given->inertia(1, Mat3<double>::Identity());
  CHECK(refusal(*given).find("inertia is given") != std::string::npos);
  const auto modes = part_of("sphere", {}, one);
  LocalSettings settings;
  settings.basis = LocalSettings::Basis::modes;
  modes->deform_locally(settings);
  CHECK(refusal(*modes).find("same density") != std::string::npos);
}

}  // namespace mass_distribution_test
