// The strain energy of the map from the rest shape: its quadrature rule, its derivatives, and stiffnesses
// with closed forms.
#include "catch.h"

#include <Eigen/LU>

#include <pliant/math/eigenvalues.h>
#include <pliant/math/quadrature.h>

#include "differences.h"
#include "random_state.h"

namespace continuum_test {

using namespace pliant;
using test::Draws;

namespace {

constexpr double kYoung = 900, kPoisson = 0.3;  // E, Pa; nu
const Elasticity kMaterial(kYoung, kPoisson);
const std::vector<std::string> kSolidLaws{"elastic", "st_venant_kirchhoff", "neo_hookean", "neo_hookean_log"};

struct Body {
  const char* shape;
  std::vector<std::string> chain;
  Part::Named rest;
  std::vector<std::string> dynamic;
};
const std::vector<Body>& bodies() {
  static const std::vector<Body> all{
      {"ellipsoid", {}, {{"a1", 0.5}, {"a2", 0.4}}, {"a1", "a2", "a3"}},
      {"box", {"shear"}, {{"a1", 0.2}, {"shear.sx", 0.3}}, {"a1", "a3", "shear.sx", "shear.sy"}},
      {"ellipsoid",
       {"taper", "twist"},
       {{"a3", 1.5}, {"taper.tx", 0.2}},
       {"a1", "a2", "a3", "taper.tx", "taper.ty", "twist.angle"}},
      {"cylinder",
       {"twist", "bend"},
       {{"a1", 0.3}, {"a2", 0.3}, {"bend.angle", 0.3}},
       {"a3", "twist.angle", "bend.angle"}},
      {"superellipsoid", {"taper"}, {{"eps1", 0.4}, {"eps2", 0.6}}, {"a1", "a3", "taper.tx"}},
      {"capsule", {"bend_offset"}, {}, {"r", "l", "bend_offset.b1"}},
      {"supertoroid", {"twist"}, {}, {"a1", "a3", "a4", "twist.angle"}},
  };
  return all;
}

std::unique_ptr<Part> make(const Body& body, const std::string& law, bool shell = false) {
  auto part = make_part("part", body.shape, body.chain, 1000);
  if (shell) part->make_shell();
  part->rest(body.rest).make_dynamic(body.dynamic);
  part->elasticity({law, kYoung, kPoisson, shell ? 0.02 : 0});
  part->prepare();
  return part;
}

/// Returns the rest values of the dynamic parameters, changed by random amounts of up to `size`. For
/// parameters with relative ranges (lengths) the amounts are multiples of the rest value.
VecMax<double> near_rest(Draws& draws, const Part& part, double size) {
  VecMax<double> q(part.n_s());
  for (int k = 0; k < part.n_s(); ++k) {
    const Parameter& p = part.parameters().moving(k);
    q[k] = p.rest_value() + draws.uniform(-size, size) * (p.spec->relative ? p.rest_value() : 1.0);
  }
  return q;
}

VecX<double> force(const Part& part, const VecMax<double>& q, const VecMax<double>& rate, double beta) {
  VecX<double> f = VecX<double>::Zero(q.size());
  Counters counters;
  part.continuum()->add_force(part, q, rate, beta, f, counters);
  return f;
}
VecX<double> force(const Part& part, const VecMax<double>& q) {
  return force(part, q, VecMax<double>(VecMax<double>::Zero(q.size())), 0);
}

/// Returns the deformation gradient F from the rest shape to the shape at q, at a material point (u, v, w).
Mat3<double> gradient(const Part& part, const VecMax<double>& q, double u, double v, double w) {
  const VecMax<double> no_rate = VecMax<double>::Zero(q.size());
  return part.material_gradient(u, v, w, part.parameters().expand<double>(q, no_rate)) *
         part.material_gradient(u, v, w, part.parameters().rest()).inverse();
}

/// Returns the energy of a solid by a dense Gauss rule over u, v and w, with panels of pi / 4 in u and v.
/// torus: whether u has the range of a torus.
template <class Law>
double dense_energy(const Part& part, const Law& law, const VecMax<double>& q, bool torus) {
  const auto rule = gauss_rule(10);
  const int panels = torus ? 8 : 4;
  double sum = 0;
  for (int i = 0; i < panels; ++i)
    for (int j = 0; j < 8; ++j)
      for (const auto& a : rule)
        for (const auto& b : rule)
          for (const auto& c : rule) {
            const double u = -kPi * panels / 8 + kPi / 4 * (i + a.x), v = kPi / 4 * (j + b.x);
            const double volume =
                std::abs(part.material_gradient(u, v, c.x, part.parameters().rest()).determinant());
            sum += a.weight * b.weight * c.weight * kPi * kPi / 16 * volume *
                   law.density(gradient(part, q, u, v, c.x));
          }
  return sum;
}

/// Returns omega^2 of the dynamic parameters in free motion without momentum and angular momentum, in rising
/// order.
VecX<double> omega2(const Part& part) {
  VecMax<double> q(part.n_s());
  for (int k = 0; k < part.n_s(); ++k) q[k] = part.parameters().moving(k).rest_value();
  const MatX<double> M = part.rest_inertia().M;
  const auto n = part.n_s();
  const MatX<double> M_rs = M.topRightCorner(6, n);
  const MatX<double> free =
      M.bottomRightCorner(n, n) - M_rs.transpose() * M.topLeftCorner(6, 6).inverse() * M_rs;
  return symmetric_eigenpairs(part.elastic_stiffness(q), free).values;
}

}  // namespace

TEST_CASE("the strain energy is the integral of the law over the rest body", "[continuum][long]") {
  Draws draws(3);
  for (const Body& body : bodies()) {
    const std::string shape = body.shape;
    // A rule in the angles is not accurate for the trigonometric map with small exponents.
    if (shape == "superellipsoid") continue;
    const auto part = make(body, "neo_hookean");
    CAPTURE(test::describe(body.shape, body.chain), part->continuum()->points().n_points);
    const VecMax<double> q = near_rest(draws, *part, 0.2);
    const double expected = dense_energy(*part, NeoHookean(kMaterial), q, shape == "supertoroid");
    CHECK(part->continuum()->energy(*part, q) == Approx(expected).epsilon(20 * kStrainTolerance));
  }
}

TEST_CASE("with homogeneous strain one quadrature point suffices, and the energy is exact", "[continuum]") {
  for (const std::string& law : kSolidLaws) {
    const auto part = make(bodies()[0], law);
    CHECK(part->continuum()->points().n_points == 1);
    CHECK(part->continuum()->points().rule == "affine");
    const VecMax<double> q = Vec3<double>(0.6, 0.3, 1.3);
    const Mat3<double> F = Vec3<double>(0.6 / 0.5, 0.3 / 0.4, 1.3).asDiagonal();
    const double density = law == "elastic"
                               ? LinearLaw(kMaterial).density(Mat3<double>(F - Mat3<double>::Identity()))
                           : law == "neo_hookean"     ? NeoHookean(kMaterial).density(F)
                           : law == "neo_hookean_log" ? NeoHookeanLog(kMaterial).density(F)
                                                      : StVenantKirchhoff(kMaterial).density(F);
    const double volume = 4 * kPi / 3 * 0.5 * 0.4;
    CHECK(part->continuum()->energy(*part, q) == Approx(volume * density).epsilon(1e-13));
  }
  // A given mass changes the density, not the volume.
  Part& heavy = *make(bodies()[0], "elastic").release();
  const std::unique_ptr<Part> owner(&heavy);
  const double before = heavy.continuum()->energy(heavy, Vec3<double>(0.6, 0.3, 1.3));
  heavy.mass(77);
  heavy.prepare();
  CHECK(heavy.continuum()->energy(heavy, Vec3<double>(0.6, 0.3, 1.3)) == Approx(before).epsilon(1e-13));
}

TEST_CASE("the force is the derivative of the energy, and the stiffness that of the force",
          "[continuum][long]") {
  Draws draws(5);
  for (const Body& body : bodies())
    for (const std::string& law : kSolidLaws) {
      const auto part = make(body, law);
      CAPTURE(test::describe(body.shape, body.chain), law);
      const VecMax<double> q = near_rest(draws, *part, 0.1);
      const VecX<double> f = force(*part, q);
      const MatX<double> K = part->elastic_stiffness(q);
      for (int k = 0; k < part->n_s(); ++k) {
        auto moved = [&](long double t) {
          VecMax<double> at = q;
          at[k] += static_cast<double>(t);
          return at;
        };
        const long double h = 1e-2L * std::abs(q[k] == 0 ? 1 : q[k]);
        const auto slope = test::first_derivative(
            [&](long double t) {
              return Vec<long double, 1>(
                  static_cast<long double>(part->continuum()->energy(*part, moved(t))));
            },
            h);
        CHECK(static_cast<double>(-slope[0]) == Approx(f[k]).epsilon(1e-8).margin(1e-9 * f.norm()));
        const VecX<double> column =
            test::first_derivative(
                [&](long double t) { return VecX<long double>(force(*part, moved(t)).cast<long double>()); },
                h)
                .cast<double>();
        CHECK((K.col(k) + column).norm() <= 1e-8 * (K.col(k).norm() + K.norm() * 1e-2));
      }
    }
}

TEST_CASE("at rest the force is zero, and damping is beta times the stiffness", "[continuum][long]") {
  Draws draws(7);
  for (const Body& body : bodies())
    for (const std::string& law : kSolidLaws) {
      const auto part = make(body, law);
      CAPTURE(test::describe(body.shape, body.chain), law);
      const VecMax<double> rest = near_rest(draws, *part, 0), rate = near_rest(draws, *part, 0.1) - rest;
      const MatX<double> K = part->elastic_stiffness(rest);
      const double size = (K * rate).norm();
      CHECK(std::abs(part->continuum()->energy(*part, rest)) <= 1e-13 * K.norm() * rest.squaredNorm());
      CHECK(force(*part, rest).norm() <= 1e-11 * K.norm() * rest.norm());
      CHECK((force(*part, rest, rate, 0.5) + 0.5 * K * rate).norm() <= 1e-9 * size);
      CHECK((part->strain_stiffness(rest) - K).norm() <= 1e-9 * K.norm());
      // In deformed states damping also removes energy.
      for (int i = 0; i < 10; ++i) {
        const VecMax<double> q = near_rest(draws, *part, 0.4), v = near_rest(draws, *part, 1) - rest;
        VecX<double> f = VecX<double>::Zero(q.size()), undamped = force(*part, q);
        Counters counters;
        const double power = part->continuum()->add_force(*part, q, v, 0.1, f, counters);
        CHECK(power < 0);
        CHECK(power == Approx(VecX<double>(f - undamped).dot(VecX<double>(v))).epsilon(1e-9));
      }
    }
}

TEST_CASE("a solid sphere with three dynamic semi-axes has the frequencies of homogeneous deformation",
          "[continuum]") {
  // eta is omega r / c_t with the speed c_t of shear waves. The deviatoric modes have eta^2 = 10, and the
  // breathing mode has eta^2 = 5 (3 lambda + 2 mu) / mu.
  for (const std::string& law : kSolidLaws) {
    const double r = 0.7, density = 1000;
    const auto part = make({"ellipsoid", {}, {{"a1", r}, {"a2", r}, {"a3", r}}, {"a1", "a2", "a3"}}, law);
    const VecX<double> eta2 = omega2(*part) * (r * r * density / kMaterial.mu());
    CHECK(eta2[0] == Approx(10).epsilon(1e-12));
    CHECK(eta2[1] == Approx(10).epsilon(1e-12));
    CHECK(eta2[2] ==
          Approx(5 * (3 * kMaterial.lambda() + 2 * kMaterial.mu()) / kMaterial.mu()).epsilon(1e-12));
  }
}

TEST_CASE("a bar with dynamic semi-axes has Young's modulus in the limit of a slender bar", "[continuum]") {
  // A homogeneous stretch has omega = sqrt(3) c / a3 with c = sqrt(E / rho).
  std::vector<double> error;
  for (const double aspect : {4.0, 8.0, 16.0}) {
    const auto part = make(
        {"box", {}, {{"a1", 1 / aspect}, {"a2", 1 / aspect}, {"a3", 1}}, {"a1", "a2", "a3"}}, "neo_hookean");
    error.push_back(std::abs(std::sqrt(omega2(*part)[0]) / std::sqrt(3 * kYoung / 1000) - 1));
  }
  CHECK(std::log2(error[0] / error[1]) == Approx(2).margin(0.1));
  CHECK(std::log2(error[1] / error[2]) == Approx(2).margin(0.1));
  CHECK(error[2] <= 1e-3);
}

TEST_CASE("a twisted cylinder has the stiffness G J_p / L", "[continuum]") {
  const double r = 0.3, half = 1.2, G = kMaterial.mu(), J_p = kPi / 2 * std::pow(r, 4), L = 2 * half;
  for (const std::string& law : kSolidLaws) {
    const auto part =
        make({"cylinder", {"twist"}, {{"a1", r}, {"a2", r}, {"a3", half}}, {"twist.angle"}}, law);
    // The ends rotate relative to each other by twice the angle.
    CHECK(part->elastic_stiffness(VecMax<double>::Zero(1))(0, 0) == Approx(4 * G * J_p / L).epsilon(1e-8));
    CHECK(omega2(*part)[0] == Approx(3 * G / (1000 * half * half)).epsilon(1e-8));
  }
}

TEST_CASE("a bent bar has the stiffness of plane sections with constant shape", "[continuum]") {
  // Sections do not contract laterally, so that lambda + 2 mu replaces E. The energy is
  // (lambda + 2 mu) I k^2 L / 2, with the second moment of area I, the length L = 2 half and the curvature
  // k = angle / half.
  const double r = 0.05, half = 1, I = kPi / 4 * std::pow(r, 4);
  const auto part =
      make({"cylinder", {"bend"}, {{"a1", r}, {"a2", r}, {"a3", half}}, {"bend.angle"}}, "neo_hookean");
  CHECK(part->elastic_stiffness(VecMax<double>::Zero(1))(0, 0) ==
        Approx((kMaterial.lambda() + 2 * kMaterial.mu()) * I * 2 / half).epsilon(1e-7));
}

TEST_CASE("a closed spherical shell that breathes has the exact frequency", "[continuum]") {
  // omega^2 r^2 rho (1 - nu_P^2) / E = 2 (1 + nu_P), where nu_P is Poisson's ratio. The density of a shell is
  // its mass per area, so rho = density / thickness.
  const double r = 0.8, thickness = 0.02, density = 3;
  auto part = make_part("shell", "sphere", {}, density);
  part->make_shell().rest({{"r", r}}).make_dynamic({"r"});
  part->elasticity({"st_venant_kirchhoff_membrane", kYoung, kPoisson, thickness});
  part->prepare();
  CHECK(omega2(*part)[0] * r * r * (density / thickness) * (1 - kPoisson) / kYoung ==
        Approx(2).epsilon(kStrainTolerance));
}

TEST_CASE(
    "shells: the force is the derivative of the energy, and bends in all directions have equal energies",
    "[continuum][long]") {
  Draws draws(9);
  for (const Body& body : {bodies()[0], bodies()[2], bodies()[3]}) {
    const auto part = make(body, "st_venant_kirchhoff_membrane", true);
    const VecMax<double> q = near_rest(draws, *part, 0.1);
    const VecX<double> f = force(*part, q);
    for (int k = 0; k < part->n_s(); ++k) {
      const auto slope = test::first_derivative(
          [&](long double t) {
            VecMax<double> at = q;
            at[k] += static_cast<double>(t);
            return Vec<long double, 1>(static_cast<long double>(part->continuum()->energy(*part, at)));
          },
          1e-2L);
      CHECK(static_cast<double>(-slope[0]) == Approx(f[k]).epsilon(1e-8).margin(1e-9 * f.norm()));
    }
  }
  // A bend in another direction is a rotated bend, with equal energy.
  auto part = make_part("part", "cylinder", {"bend"}, 1000);
  part->make_shell().rest({{"a1", 0.2}, {"a2", 0.2}}).make_dynamic({"bend.angle", "bend.direction"});
  part->elasticity({"st_venant_kirchhoff_membrane", kYoung, kPoisson, 0.01});
  part->prepare();
  const double there = part->continuum()->energy(*part, Eigen::Vector2d(0.7, 0)),
               turned = part->continuum()->energy(*part, Eigen::Vector2d(0.7, 1.1));
  CHECK(there > 0);
  CHECK(turned == Approx(there).epsilon(10 * kStrainTolerance));
}

TEST_CASE("elasticity that does not fit a part is refused with the reason", "[continuum][long]") {
  auto ball = [](const char* shape, const char* law) {
    auto part = make_part("ball", shape, {"taper"}, 1000);
    part->elasticity({law, 1e4, 0.3, 0.01}).make_dynamic({"a1"});
    return part;
  };
  CHECK_THROWS_WITH(make_part("ball", "box", {}, 1)->elasticity({"jelly", 1, 0.3, 0}),
                    test::has_text("part 'ball': no law of elasticity 'jelly'; there are: elastic"));
  CHECK_THROWS_WITH(make_part("ball", "box", {}, 1)->elasticity({"elastic", 0, 0.3, 0}),
                    test::has_text("part 'ball'"));
  CHECK_THROWS_WITH(ball("box", "st_venant_kirchhoff_membrane")->prepare(),
                    test::has_text("is for shells, not for solids"));
  CHECK_THROWS_WITH(ball("box", "elastic")->make_shell().prepare(),
                    test::has_text("is for solids, not for shells"));
  CHECK_THROWS_WITH(ball("superellipsoid", "elastic")->make_dynamic({"eps1"}).prepare(),
                    test::has_text("changing eps1 strains the material of a superellipsoid without bound") &&
                        test::has_text("superellipsoid_radial"));
  CHECK_THROWS_WITH(ball("supertoroid", "elastic")->make_dynamic({"eps2"}).prepare(),
                    test::has_text("freeze eps2"));
  CHECK_NOTHROW(ball("superellipsoid_radial", "elastic")->make_dynamic({"eps1"}).prepare());
  auto pulsing = ball("box", "elastic");
  pulsing->rest("a1", TimeFunction::key_frames({0, 1}, {1, 1.2}));
  CHECK_THROWS_WITH(pulsing->prepare(), test::has_text("give a1 a stiffness"));
  CHECK_NOTHROW(pulsing->stiffness({{"a1", 10}}).prepare());
  auto soft = ball("box", "elastic");
  LocalSettings settings;
  soft->deform_locally(settings);
  CHECK_THROWS_WITH(soft->prepare(), test::has_text("it deforms locally"));
}

TEST_CASE("frozen parts have no strain energy", "[continuum]") {
  auto part = make_part("stone", "box", {"twist"}, 1000);
  part->elasticity({"elastic", 1e4, 0.3, 0});
  part->prepare();
  CHECK(part->continuum() == nullptr);
}

}  // namespace continuum_test
