// Mass points of parts with dynamic exponents: their number and their error. The time to place the mass
// points of a part whose rings are not circles.
// N16 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <cmath>
#include <ctime>

#include <pliant/shape/superellipsoid_radial.h>

#include "doubling_error.h"

namespace mass_points_test {

using namespace pliant;

namespace {

/// A part, and the largest number of mass points that it may have.
struct Case {
  const char* shape;
  Part::Named rest;
  std::vector<std::string> dynamic;
  bool shell;
  int most_points;
  std::vector<std::string> chain = {};
};

std::unique_ptr<Part> prepared(const Case& c) {
  std::unique_ptr<Part> part = make_part("part", c.shape, c.chain, 1000);
  part->rest(c.rest);
  if (c.shell) part->make_shell();
  part->make_dynamic(c.dynamic);
  part->prepare();
  return part;
}

/// Checks the number of mass points of a part, and that their error (doubling_error()) is at most most_error.
void check_case(const Case& c, double most_error) {
  const std::unique_ptr<Part> part = prepared(c);
  CAPTURE(c.shape, c.dynamic.size(), c.shell, part->mass_points().n_points);
  CHECK(part->mass_points().n_points <= c.most_points);
  const double error = test::doubling_error(*part, 10);
  CHECK(error <= most_error);
  // Two rules with different points never agree exactly.
  CHECK(error > 0);
}

}  // namespace

TEST_CASE("N16: dynamic exponents of the trigonometric map: few mass points and rounding errors only",
          "[mass][long]") {
  for (const Case& c :
       {Case{"superellipsoid", {}, {"eps1", "eps2"}, false, 8800},
        Case{"superellipsoid", {}, {"eps1", "eps2"}, true, 10000},
        Case{"superellipsoid", {{"eps1", 0.2}, {"eps2", 1.7}}, {"eps1", "eps2"}, false, 10000},
        Case{"superellipsoid", {}, {"a1", "a2", "a3", "eps1", "eps2"}, false, 10500},
        Case{"superellipsoid", {}, {"eps1"}, false, 220},
        Case{"supertoroid", {}, {"eps1", "eps2"}, false, 14000},
        Case{"supertoroid", {}, {"a1", "eps1"}, false, 330}})
    check_case(c, 2e-13);
}

TEST_CASE("N16: dynamic exponents of the radial map: few mass points, errors below 1e-11", "[mass][long]") {
  for (const Case& c :
       {Case{"superellipsoid_radial", {}, {"eps1", "eps2"}, false, 57000},
        Case{"superellipsoid_radial", {}, {"eps1", "eps2"}, true, 57000},
        Case{"superellipsoid_radial", {{"eps1", 0.5}, {"eps2", 0.5}}, {"eps1", "eps2"}, false, 57000},
        Case{"superellipsoid_radial", {{"eps1", 1.5}, {"eps2", 0.3}}, {"eps1", "eps2"}, false, 68000},
        Case{"superellipsoid_radial", {}, {"a1", "a2", "a3", "eps1", "eps2"}, false, 57000},
        Case{"superellipsoid_radial", {}, {"eps1"}, false, 700},
        Case{"superellipsoid_radial", {}, {"eps2"}, false, 5500}})
    check_case(c, 1e-11);
}

TEST_CASE("N16: dynamic exponents of deformed parts: number of mass points", "[mass][long]") {
  const Part::Named taper{{"taper.tx", 0.3}, {"taper.ty", 0.3}}, twist{{"twist.angle", 0.8}};
  for (const Case& c : {Case{"superellipsoid", taper, {"eps1", "eps2"}, false, 19000, {"taper"}},
                        Case{"superellipsoid", twist, {"eps1", "eps2"}, false, 130000, {"twist"}},
                        Case{"superellipsoid_radial", taper, {"eps1", "eps2"}, false, 160000, {"taper"}},
                        Case{"superellipsoid_radial", twist, {"eps1", "eps2"}, false, 410000, {"twist"}}}) {
    CAPTURE(c.shape, c.chain.front());
    CHECK(prepared(c)->mass_points().n_points <= c.most_points);
  }
}

namespace {

/// Integrals over the radial superellipsoid with unit axes and density 1 by the trapezoidal rule. This rule
/// converges exponentially for analytic integrands that decay at both ends. With s = w n R(n; eps), where R
/// is 1 / gauge, the integral of f(n) w^2 over the volume is the integral of f R(n; eps at rest)^3 / 5 over
/// the directions n. One octant is integrated, with n along (1, e^t, e^s).
struct RadialIntegrals {
  double xx = 0, zz = 0, by_1_1 = 0, by_1_2 = 0, by_2_2 = 0;  ///< by_k_l: integral of dR/d eps_k dR/d eps_l

  RadialIntegrals(double eps1, double eps2, double rest1, double rest2, double h) {
    const int reach = static_cast<int>(34 / h);
    for (int i = -reach; i <= reach; ++i)
      for (int j = -reach; j <= reach; ++j)
        add(Vec3<double>(1, std::exp(i * h), std::exp(j * h)), eps1, eps2, rest1, rest2, h);
  }

 private:
  static double R(const Vec3<double>& n, double eps1, double eps2) {
    return 1 / SuperellipsoidRadial::gauge<double>(n, Vec<double, 5>(1, 1, 1, eps1, eps2));
  }
  void add(const Vec3<double>& along, double eps1, double eps2, double rest1, double rest2, double h) {
    const Vec3<double> n = along.normalized();
    const double solid_angle = n[0] * n[1] * n[2] * h * h, at_rest = R(n, rest1, rest2);
    const double weight = 8 * solid_angle * at_rest * at_rest * at_rest / 5;
    if (weight < 1e-18) return;
    // Central differences of sixth order.
    auto slope = [](const auto& f) {
      constexpr double d = 2e-3;
      return (45 * (f(d) - f(-d)) - 9 * (f(2 * d) - f(-2 * d)) + (f(3 * d) - f(-3 * d))) / (60 * d);
    };
    const double r = R(n, eps1, eps2), r1 = slope([&](double d) { return R(n, eps1 + d, eps2); }),
                 r2 = slope([&](double d) { return R(n, eps1, eps2 + d); });
    xx += weight * r * r * n[0] * n[0];
    zz += weight * r * r * n[2] * n[2];
    by_1_1 += weight * r1 * r1;
    by_1_2 += weight * r1 * r2;
    by_2_2 += weight * r2 * r2;
  }
};

}  // namespace

TEST_CASE("N16: inertia and the blocks of dynamic exponents agree with integrals over all directions",
          "[mass][long]") {
  for (const Vec<double, 2>& rest : {Vec<double, 2>(1, 1), Vec<double, 2>(0.5, 0.7)}) {
    const std::unique_ptr<Part> part = prepared(
        {"superellipsoid_radial", {{"eps1", rest[0]}, {"eps2", rest[1]}}, {"eps1", "eps2"}, false, 0});
    for (const Vec<double, 2>& now : {rest, Vec<double, 2>(0.5, 1.5), Vec<double, 2>(1.6, 0.6)}) {
      Inertia<double> I;
      Counters counters;
      part->evaluate_inertia(VecMax<double>(now), VecMax<double>::Zero(2), Vec3<double>::Zero(), I, counters);
      const RadialIntegrals exact(now[0], now[1], rest[0], rest[1], 0.06);
      const double density = part->density(), xx = exact.xx * density, zz = exact.zz * density;
      CAPTURE(rest.transpose(), now.transpose());
      CHECK(std::abs(I.M(3, 3) - (xx + zz)) <= 1e-11 * I.M(3, 3));
      CHECK(std::abs(I.M(5, 5) - 2 * xx) <= 1e-11 * I.M(5, 5));
      CHECK(std::abs(I.M(3, 4)) <= 1e-13 * I.M(3, 3));
      CHECK(I.M.block<3, 3>(0, 3).norm() <= 1e-13 * I.M(0, 0));
      // Rounding errors of the differences limit the accuracy of these integrals.
      CHECK(std::abs(I.M(6, 6) - exact.by_1_1 * density) <= 1e-10 * I.M(6, 6));
      CHECK(std::abs(I.M(7, 7) - exact.by_2_2 * density) <= 1e-10 * I.M(7, 7));
      CHECK(std::abs(I.M(6, 7) - exact.by_1_2 * density) <= 1e-10 * std::sqrt(I.M(6, 6) * I.M(7, 7)));
    }
  }
}

TEST_CASE("mass points of a bent supertoroid are placed in less than 6 s of processor time", "[mass]") {
  const std::clock_t start = std::clock();
  const std::unique_ptr<Part> part = prepared({"supertoroid",
                                               {{"a1", 0.0131},
                                                {"a2", 0.0194},
                                                {"a3", 0.0222},
                                                {"a4", 1.58},
                                                {"eps1", 0.66},
                                                {"eps2", 1.397},
                                                {"bend_offset.b1", 0.0006},
                                                {"bend_offset.b2", 0.0863},
                                                {"bend_offset.b3", 0.3516}},
                                               {"a2", "a4", "bend_offset.b1"},
                                               false,
                                               60,
                                               {"bend_offset"}});
#ifdef PLIANT_SANITIZED
  constexpr double seconds = 120;
#else
  constexpr double seconds = 6;
#endif
  CHECK(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC < seconds);
  CHECK(part->mass_points().rule == "rings");
  CHECK(part->mass_points().n_points <= 60);
  CHECK(part->mass_points().relative_error == 0);
  CHECK(test::doubling_error(*part, 6) <= 2e-13);
}

}  // namespace mass_points_test
