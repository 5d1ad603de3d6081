// Kinematics of parts, s of Eq. (3) and J of Eq. (9): every shape with several chains of deformations,
// against an independent evaluation in long double. Surface functions, names of parameters, messages and
// folds are tested, too.
// N10, N11 and N13 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <algorithm>
#include <cmath>

#include <Eigen/LU>

#include <pliant/part/sum_inertia.h>

#include "random_state.h"
#include "reference.h"
#include "worst.h"

namespace laws_test {

using namespace pliant;
using test::Draws;

namespace {

std::vector<std::string> shape_names() {
  std::vector<std::string> names;
  for (const auto& face : all_shapes()) names.push_back(face->name());
  return names;
}

template <class F>
void for_every_part(F&& body) {
  for (const std::string& shape : shape_names())
    for (const std::vector<std::string>& chain : test::test_chains()) {
      const std::unique_ptr<Part> part = make_part("part", shape, chain, 1000);
      if (part->shape().mesh() == MeshPattern::torus)
        part->rest({{"a3", 1}});  // tall enough to bend without a fold
      test::make_all_dynamic(*part);
      INFO(test::describe(shape, chain));
      body(*part);
    }
}

std::vector<Material<double>> points_of(Draws& draws, const Part& part, int n) {
  std::vector<Material<double>> points = test::special_points(part.shape().mesh());
  for (int i = 0; i < n; ++i) points.push_back(draws.material(part.shape().mesh()));
  return points;
}

/// Checks s, J and the time derivatives of s at material points. `scale` multiplies the tolerances, because
/// strong deformations amplify the errors of rounding and of differences.
void check_kinematics(const Part& part, const test::RandomState& state,
                      const std::vector<Material<double>>& at, double scale = 1) {
  const test::Reference reference(part, state.q_s, state.q_s_dot);
  std::vector<PointJet<double>> jets;
  Counters counters;
  part.points(at, state.q_s, state.q_s_dot, jets, counters);
  const Eigen::Matrix3Xd s = part.s(at, test::values_of(part, state));
  const double size = s.colwise().norm().maxCoeff();
  test::Worst value, slope, rate, curvature;
  for (std::size_t i = 0; i < at.size(); ++i) {
    const test::ReferencePoint r = reference.at(at[i]);
    REQUIRE(jets[i].p == s.col(static_cast<Eigen::Index>(i)));
    value.note((jets[i].p - r.s).norm() / size);
    slope.note((jets[i].J - r.J).cwiseAbs().maxCoeff() / std::max(1.0, r.J.cwiseAbs().maxCoeff()));
    rate.note((jets[i].p1 - r.s1).norm() / std::max(1.0, r.s1.norm()));
    rate.note((jets[i].p1 - jets[i].J * state.q_s_dot).norm() / std::max(1.0, r.s1.norm()));
    curvature.note((jets[i].p2 - r.s2).norm() / std::max(1.0, r.s2.norm()));
  }
  CHECK(value < 1e-14 * scale);
  CHECK(slope < 1e-12 * scale);
  CHECK(rate < 1e-12 * scale);
  CHECK(curvature < 1e-12 * scale);
}

}  // namespace

TEST_CASE("s, J and Jdot q_s_dot of every shape and several chains agree with long double", "[part][long]") {
  Draws draws(1);
  for_every_part([&](const Part& part) {
    check_kinematics(part, test::draw_state(draws, part), points_of(draws, part, 20));
    for (int trial = 0; trial < 3; ++trial)
      check_kinematics(part, test::draw_end_state(draws, part), points_of(draws, part, 5), 20);
  });
}

TEST_CASE("N13: all orders of taper, bend, twist and shear agree with long double", "[part]") {
  Draws draws(2);
  std::vector<std::string> chain{"bend", "shear", "taper", "twist"};
  do {
    const std::unique_ptr<Part> part = make_part("part", "superellipsoid", chain, 1000);
    test::make_all_dynamic(*part);
    INFO(test::describe("superellipsoid", chain));
    std::vector<Material<double>> at;
    for (int i = 0; i < 12; ++i) at.push_back(draws.material(MeshPattern::ball));
    check_kinematics(*part, test::draw_state(draws, *part), at);
    check_kinematics(*part, test::draw_end_state(draws, *part), at, 20);

    // Reference: the mass matrix and the inertial forces of some mass points, from the independent
    // evaluation.
    MassPoints points;
    for (int k = 0; k < 3; ++k) {
      std::array<Material<double>, Pack::kLanes> four;
      Pack mass(0.0);
      for (int lane = 0; lane < Pack::kLanes; ++lane) {
        four[static_cast<std::size_t>(lane)] = draws.material(MeshPattern::ball);
        mass.set(lane, draws.uniform(0.1, 1));
      }
      points.at.push_back(gather(four.data()));
      points.mass.push_back(mass);
      points.n_points += Pack::kLanes;
    }
    const test::RandomState state = test::draw_state(draws, *part);
    const test::Reference reference(*part, state.q_s, state.q_s_dot);
    Inertia<double> inertia;
    Counters counters;
    sum_inertia(*part, points, state.q_s, state.q_s_dot, state.omega, inertia, counters);
    const int n = 6 + static_cast<int>(state.q_s.size());
    MatX<double> M = MatX<double>::Zero(n, n);
    VecX<double> g = VecX<double>::Zero(n);
    for (std::size_t k = 0; k < points.at.size(); ++k)
      for (int lane = 0; lane < Pack::kLanes; ++lane) {
        const double m = points.mass[k][lane];
        auto take = [lane](const Trig<Pack>& t) {
          return Trig<double>{t.x[lane], t.sign[lane], t.log_abs[lane]};
        };
        const Material<Pack>& four = points.at[k];
        const test::ReferencePoint r =
            reference.at({take(four.cu), take(four.su), take(four.cv), take(four.sv), four.w[lane]});
        Eigen::Matrix3Xd G(3, n);
        G.leftCols<3>().setIdentity();
        G.middleCols<3>(3) << 0, r.s[2], -r.s[1], -r.s[2], 0, r.s[0], r.s[1], -r.s[0], 0;
        G.rightCols(n - 6) = r.J;
        const Vec3<double>& w = state.omega;
        const Vec3<double> b = w.cross(w.cross(r.s)) + 2 * w.cross(r.s1) + r.s2;
        M += m * G.transpose() * G;
        g -= m * G.transpose() * b;
      }
    const VecX<double> scale = M.diagonal().cwiseSqrt();
    for (int i = 0; i < n; ++i) {
      CHECK(std::abs(inertia.g_q[i] - g[i]) <=
            1e-12 * scale[i] * (g.array() / scale.array()).abs().maxCoeff());
      for (int j = 0; j < n; ++j) CHECK(std::abs(inertia.M(i, j) - M(i, j)) <= 1e-12 * scale[i] * scale[j]);
    }
  } while (std::next_permutation(chain.begin(), chain.end()));
}

TEST_CASE("material gradients agree with finite differences", "[part]") {
  Draws draws(3);
  int n_smooth = 0, n_tested = 0;
  for_every_part([&](const Part& part) {
    const test::RandomState state = test::draw_state(draws, part);
    const ParameterValues<double> values = test::values_of(part, state);
    std::vector<test::Long> all;
    for (int i = 0; i < part.parameters().size(); ++i) all.push_back(values.b[static_cast<std::size_t>(i)]);
    for (int trial = 0; trial < 10; ++trial) {
      const double tall = part.shape().mesh() == MeshPattern::torus ? kPi : kPi / 2;
      const double u = draws.uniform(-tall, tall), v = draws.uniform(-kPi, kPi), w = draws.uniform(0.2, 1);
      const Mat3<double> E = part.material_gradient(u, v, w, values);
      auto point = [&](test::Long du, test::Long dv, test::Long dw) {
        auto width = [](test::Long x) {
          return Trig<test::Long>{x, x > 0 ? 1.0L : -1.0L, std::log(std::abs(x))};
        };
        const Material<test::Long> m{width(std::cos(u + du)), width(std::sin(u + du)),
                                     width(std::cos(v + dv)), width(std::sin(v + dv)), w + dw};
        return test::reference_point(part, m, all);
      };
      Mat3<test::Long> coarse, fine;
      for (int step = 0; step < 2; ++step) {
        const test::Long h = step == 0 ? 2e-4L : 1e-4L;
        Mat3<test::Long>& D = step == 0 ? coarse : fine;
        D.col(0) = test::first_derivative([&](test::Long t) { return point(t, 0, 0); }, h);
        D.col(1) = test::first_derivative([&](test::Long t) { return point(0, t, 0); }, h);
        D.col(2) = test::first_derivative([&](test::Long t) { return point(0, 0, t); }, h);
      }
      ++n_tested;
      if ((coarse - fine).norm() > 1e-11L * fine.norm()) continue;  // at a rim or next to a pole
      ++n_smooth;
      CHECK((E - fine.cast<double>()).norm() <= 1e-8 * E.norm());
    }
  });
  CHECK(n_smooth > 0.9 * n_tested);
}

TEST_CASE(
    "the inside-outside function, its gradient, the normal and the label agree with the deformed surface",
    "[part]") {
  Draws draws(4);
  int n_smooth = 0, n_tested = 0;
  for_every_part([&](const Part& part) {
    const ParameterValues<double> values = test::values_of(part, test::draw_state(draws, part));
    std::vector<Material<double>> at;
    for (int i = 0; i < 25; ++i) {
      at.push_back(draws.material(part.shape().mesh()));
      at.back().w = i % 5 == 0 ? draws.uniform(0.3, 1.0) : 1.0;
    }
    const Eigen::Matrix3Xd s = part.s(at, values);
    const std::vector<Vec3<double>> normals = part.normals(at, values);
    for (std::size_t i = 0; i < at.size(); ++i) {
      const Vec3<double> p = s.col(static_cast<Eigen::Index>(i));
      CHECK(std::abs(part.inside_outside(p, values) - (at[i].w - 1)) <= 1e-10);
      const Material<double> found = part.label(p, values);
      CHECK((part.s({found}, values).col(0) - p).norm() <= 1e-10);

      const Vec3<double> slope = part.inside_outside_gradient(p, values);
      Vec3<double> differences, coarse;
      for (int r = 0; r < 3; ++r) {
        auto along = [&](long double t) {
          Vec3<double> shifted = p;
          shifted[r] += static_cast<double>(t);
          return static_cast<long double>(part.inside_outside(shifted, values));
        };
        differences[r] = static_cast<double>(test::first_derivative(along, 1e-3L));
        coarse[r] = static_cast<double>(test::first_derivative(along, 2e-3L));
      }
      const bool smooth = (differences - coarse).norm() <= 1e-9 * slope.norm();  // no rim or edge near
      ++n_tested;
      n_smooth += smooth ? 1 : 0;
      if (smooth) CHECK((slope - differences).norm() <= 1e-8 * slope.norm());
      CHECK(normals[i].norm() == Approx(1).epsilon(1e-14));
      if (at[i].w == 1) CHECK((normals[i] - slope.normalized()).norm() <= 1e-9);
      CHECK(normals[i] == part.normal(at[i], values));
    }
    // The inside-outside function increases along the normal.
    const Vec3<double> p = s.col(1);
    CHECK(part.inside_outside(p + 1e-3 * normals[1], values) > 0);
    CHECK(part.inside_outside(p - 1e-3 * normals[1], values) < 0);
  });
  CHECK(n_smooth > 0.9 * n_tested);
}

TEST_CASE("the normal is perpendicular to the tangents of the surface", "[part]") {
  Draws draws(5);
  for_every_part([&](const Part& part) {
    const ParameterValues<double> values = test::values_of(part, test::draw_state(draws, part));
    for (int trial = 0; trial < 10; ++trial) {
      const double tall = part.shape().mesh() == MeshPattern::torus ? kPi : kPi / 2;
      const double u = draws.uniform(-tall, tall), v = draws.uniform(-kPi, kPi);
      const Mat3<double> E = part.material_gradient(u, v, 1, values);
      const Vec3<double> n = part.normal(material_at(u, v), values);
      CHECK(std::abs(n.dot(E.col(0).normalized())) <= 1e-10);
      CHECK(std::abs(n.dot(E.col(1).normalized())) <= 1e-10);
      CHECK(n.dot(E.col(2)) > 0);
    }
  });
}

TEST_CASE("a parameter of a link is named link.parameter, and repeated links are numbered", "[part]") {
  const std::unique_ptr<Part> part =
      make_part("p", "ellipsoid", {"taper", "twist", "taper", "bend", "taper"}, 1000);
  CHECK(part->parameters().names() ==
        "a1 a2 a3 taper.tx taper.ty twist.angle taper2.tx taper2.ty bend.angle bend.direction taper3.tx "
        "taper3.ty");
  CHECK(part->parameters().find("taper2.ty") == 7);
  CHECK(part->parameters().find("taper4.tx") == -1);
}

TEST_CASE("the unit of a parameter agrees with its name", "[part]") {
  auto check = [](const ParameterSpec& spec) {
    INFO(spec.name);
    const std::string name = spec.name;
    CHECK((std::string(spec.unit()) == "rad") == (name == "angle" || name == "direction"));
    const bool is_length =
        name == "r" || name == "l" || name == "b1" || (name.size() == 2 && name[0] == 'a' && name != "a4");
    CHECK((std::string(spec.unit()) == "m") == is_length);
    CHECK((spec.quantity == Quantity::exponent) == (std::string(spec.name).substr(0, 3) == "eps"));
  };
  for (const auto& face : all_shapes())
    for (int k = 0; k < face->n_parameters(); ++k) check(face->parameters()[k]);
  for (const DeformationInfo& info : all_deformations())
    for (const ParameterSpec& spec : info.parameters) check(spec);
}

TEST_CASE("a repeated link acts twice", "[part]") {
  const std::unique_ptr<Part> part = make_part("p", "box", {"taper", "taper"}, 1000);
  part->rest({{"taper.tx", 0.5}, {"taper2.tx", -0.2}});
  const Vec3<double> s =
      part->s({material_from(std::sqrt(0.5), std::sqrt(0.5), 1, 0)}, part->parameters().rest()).col(0);
  CHECK(s[0] == Approx(1.5 * 0.8).epsilon(1e-15));
}

TEST_CASE("errors of a part name the part, the parameter, the value and the allowed range", "[part]") {
  using test::has_text;
  CHECK_THROWS_WITH(make_part("p", "pebble", {}, 1),
                    has_text("part 'p': no shape 'pebble'") && has_text("supertoroid"));
  CHECK_THROWS_WITH(make_part("p", "box", {"squash"}, 1),
                    has_text("no deformation 'squash'") && has_text("bend_offset"));
  CHECK_THROWS_WITH(make_part("p", "box", {}, 0), has_text("density 0"));
  CHECK_THROWS_WITH(make_part("p", "box", {}, -1), has_text("density -1"));
  const std::unique_ptr<Part> part = make_part("p", "box", {"taper"}, 1000);
  CHECK_THROWS_WITH(part->rest({{"taper.tz", 0.1}}),
                    has_text("no parameter 'taper.tz'") && has_text("a1 a2 a3 taper.tx"));
  CHECK_THROWS_WITH(part->rest({{"taper.tx", 1.01}}),
                    has_text("taper.tx = 1.01 is out of range; allowed: [-1, 1]"));
  CHECK_THROWS_WITH(part->rest({{"a1", 0}}), has_text("a1 = 0 is out of range"));
  CHECK_THROWS_WITH(part->rest({{"a1", -1}}), has_text("a1 = -1"));
  CHECK_THROWS_WITH(part->rest({{"a1", std::nan("")}}), has_text("out of range"));
  CHECK_THROWS_WITH(part->stiffness({{"a1", -5}}), has_text("stiffness -5 of a1"));
  CHECK_THROWS_WITH(part->damping(-1, 0), has_text("damping"));
  CHECK_THROWS_WITH(part->mass(0), has_text("mass 0"));
  CHECK_THROWS_WITH(part->inertia(1, Vec3<double>(1, 1, 3).asDiagonal()),
                    has_text("no body has this inertia"));
  CHECK_THROWS_WITH(part->place({0, 0, 0}, Eigen::Quaterniond(0, 0, 0, 0)), has_text("orientation"));
  CHECK_THROWS_WITH(part->limits("a1", {2, 1}), has_text("limits [2, 1] of a1"));
  part->make_dynamic({"a1"}).limits("a1", {0, 1e9});
  CHECK_THROWS_WITH(part->prepare(), has_text("[0.001, 1000]"));
  const MatX<double> indefinite = (MatX<double>(2, 2) << 1, 2, 2, 1).finished();
  CHECK_THROWS_WITH(part->stiffness({"a1", "a2"}, indefinite), has_text("negative eigenvalue"));
  const MatX<double> skew = (MatX<double>(2, 2) << 1, 2, 0, 1).finished();
  CHECK_THROWS_WITH(part->stiffness({"a1", "a2"}, skew), has_text("symmetric"));
}

TEST_CASE("N11: a rest shape that folds over is refused, a slim shape may bend by half a turn", "[part]") {
  const std::unique_ptr<Part> fat = make_part("fat", "cylinder", {"bend"}, 1000);
  fat->rest({{"bend.angle", 1.5}});
  CHECK_THROWS_WITH(fat->prepare(), test::has_text("part 'fat': its rest shape folds over"));
  const std::unique_ptr<Part> slim = make_part("slim", "cylinder", {"bend"}, 1000);
  slim->rest({{"a1", 0.1}, {"a2", 0.1}, {"bend.angle", kPi}});
  CHECK_NOTHROW(slim->prepare());
  CHECK_THROWS_WITH(slim->rest({{"bend.angle", 3.15}}), test::has_text("bend.angle = 3.15 is out of range"));
}

TEST_CASE("N11: initial values at which a part folds over are refused, and folds are detected at any values",
          "[part]") {
  const std::unique_ptr<Part> part = make_part("fat", "cylinder", {"bend"}, 1000);
  part->stiffness({{"bend.angle", 100}, {"a1", 1000}}).initial({{"bend.angle", 1.5}});
  CHECK_THROWS_WITH(part->prepare(), test::has_text("part 'fat': its initial shape folds over") &&
                                         test::has_text("make the body slimmer"));
  part->initial({{"bend.angle", 0.5}});
  CHECK_NOTHROW(part->prepare());
  // The part folds if its half width times the curvature is above one, that is if |angle| a1 / a3 > 1. Here
  // a3 is 1 m.
  auto at = [](double a1, double angle) { return VecMax<double>(Eigen::Vector2d(a1, angle)); };
  CHECK_FALSE(part->is_inverted(at(1, 0.99)));
  CHECK(part->is_inverted(at(1, 1.01)));
  CHECK(part->is_inverted(at(1, -1.01)));
  CHECK_FALSE(part->is_inverted(at(0.5, 1.9)));
  CHECK(part->is_inverted(at(0.5, 2.1)));
  const std::unique_ptr<Part> given = make_part("given", "cylinder", {"bend"}, 1000);
  given->rest({{"bend.angle", 1.5}}).inertia(1, Mat3<double>::Identity());
  CHECK_THROWS_WITH(given->prepare(), test::has_text("its rest shape folds over"));
  const std::unique_ptr<Part> tip = make_part("tip", "cylinder", {"taper"}, 1000);
  tip->make_dynamic({"taper.tx", "taper.ty"});
  CHECK_FALSE(tip->is_inverted(at(-1, 1)));
}

namespace {

/// Checks the inside-outside function, the label and the normals on the surface at the rest values, also at
/// the ends of the ranges of u and v.
void check_surface(const Part& part, double tolerance) {
  const ParameterValues<double> values = part.parameters().rest();
  std::vector<Material<double>> at;
  for (const Material<double>& m : test::special_points(part.shape().mesh()))
    if (m.w == 1) at.push_back(m);
  Draws draws(6);
  for (int i = 0; i < 200; ++i) {
    at.push_back(draws.material(part.shape().mesh()));
    at.back().w = 1;
  }
  const Eigen::Matrix3Xd s = part.s(at, values);
  const std::vector<Vec3<double>> normals = part.normals(at, values);
  for (std::size_t i = 0; i < at.size(); ++i) {
    const Vec3<double> p = s.col(static_cast<Eigen::Index>(i));
    INFO("u, v " << angles(at[i]).u << " " << angles(at[i]).v << " p " << p.transpose());
    CHECK(std::abs(part.inside_outside(p, values)) <= tolerance);
    CHECK(part.inside_outside_gradient(p, values).allFinite());
    CHECK((part.s({part.label(p, values)}, values).col(0) - p).norm() <= 1e-10);
    CHECK(normals[i].norm() == Approx(1).epsilon(1e-14));
    CHECK(normals[i] == part.normal(at[i], values));
  }
}

}  // namespace

TEST_CASE("N10: at the tip of a full taper all surface functions are finite and correct", "[part]") {
  for (const std::string& shape : shape_names())
    for (const std::vector<std::string>& chain : std::vector<std::vector<std::string>>{
             {"taper"}, {"taper", "twist", "shear"}, {"shear", "taper"}, {"taper", "bend"}})
      for (const auto& [tx, ty] : {std::pair(-1.0, -1.0), {1.0, 1.0}, {-1.0, 0.0}, {1.0, -1.0}}) {
        const std::unique_ptr<Part> part = make_part("part", shape, chain, 1000);
        const bool torus = part->shape().mesh() == MeshPattern::torus;
        // A taper of one axis alone shrinks an end section to an edge. Each point of this edge is the image
        // of a line, and the inverse is unique only in the middle of the edge.
        if (tx != ty && (torus || chain[0] == "shear")) continue;
        if (torus) part->rest({{"a3", 2}});
        for (const char* width : {"a1", "a2", "r"})
          if (!torus && part->parameters().find(width) >= 0) part->rest({{width, 0.4}});
        part->rest({{"taper.tx", tx}, {"taper.ty", ty}});
        if (chain.back() == "bend") part->rest({{"bend.angle", 0.6}});
        if (part->parameters().find("shear.sx") >= 0) part->rest({{"shear.sx", 0.4}});
        if (shape == "sphere" && chain.back() == "bend") part->rest({{"bend.angle", 0.2}});
        if (part->parameters().find("twist.angle") >= 0) part->rest({{"twist.angle", 1.3}});
        INFO(test::describe(shape, chain) << " " << tx << " " << ty);
        check_surface(*part, 1e-9);
      }
  const std::unique_ptr<Part> cone = make_part("cone", "ellipsoid", {"taper"}, 1000);
  cone->rest({{"taper.tx", -1}, {"taper.ty", -1}});
  const ParameterValues<double> values = cone->parameters().rest();
  CHECK(cone->inside_outside({0, 0, 1}, values) == 0);
  CHECK(cone->inside_outside_gradient({0, 0, 1}, values) == Vec3<double>(0, 0, 1));
  CHECK(cone->normal(material_at(kPi / 2, 0), values) == Vec3<double>(0, 0, 1));
  CHECK(angles(cone->label({0, 0, 1}, values)).u == Approx(kPi / 2));
  CHECK(cone->inside_outside({0.1, 0, 1}, values) > 0);
}

TEST_CASE("N11: at the ends of the range of a bend all surface functions are finite and correct", "[part]") {
  for (const std::string& shape : shape_names())
    for (const double angle : {kPi, -kPi, 3.14, kPi / 2, -kPi / 2, 1.6})
      for (const double direction : {0.0, 0.8, kPi, -6.3}) {
        const std::unique_ptr<Part> part = make_part("part", shape, {"bend"}, 1000);
        const bool torus = part->shape().mesh() == MeshPattern::torus;
        part->rest({{"bend.angle", angle}, {"bend.direction", direction}});
        // The part is slim enough not to fold.
        if (torus) part->rest({{"a1", 0.05}, {"a2", 0.05}, {"a3", 1}});
        for (const char* width : {"a1", "a2", "r"})
          if (!torus && part->parameters().find(width) >= 0) part->rest({{width, 0.14}});
        if (shape == "sphere") continue;  // a sphere cannot be slim
        INFO(shape << " " << angle << " towards " << direction);
        check_surface(*part, 1e-10);
      }
}

TEST_CASE("N10: surface functions are correct at the tips of full tapers and on half-turn bends", "[part]") {
  for (const char* shape : {"superellipsoid", "ellipsoid", "capsule"})
    for (double sign : {-1.0, 1.0}) {
      const std::unique_ptr<Part> part = make_part("part", shape, {"taper"}, 1000);
      part->rest({{"taper.tx", sign}, {"taper.ty", sign}}).prepare();
      const ParameterValues<double> rest = part->parameters().rest();
      const Material<double> tip = material_at(-sign * kPi / 2, 0);
      const Vec3<double> at = part->s({tip}, rest).col(0);
      INFO(shape << " " << sign);
      CHECK(std::abs(part->inside_outside(at, rest)) <= 1e-10);
      CHECK((part->normal(tip, rest) - Vec3<double>(0, 0, -sign)).norm() <= 1e-12);
    }
  const std::unique_ptr<Part> part = make_part("part", "superellipsoid", {"bend"}, 1000);
  part->rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 1}, {"bend.angle", kPi}}).prepare();
  const ParameterValues<double> rest = part->parameters().rest();
  for (int i = -8; i <= 8; ++i)
    for (int j = 0; j < 16; ++j) {
      const Vec3<double> at = part->s({material_at(i * kPi / 16, j * kPi / 8)}, rest).col(0);
      INFO(i << " " << j);
      CHECK(std::abs(part->inside_outside(at, rest)) <= 1e-10);
    }
}

TEST_CASE("the inside-outside function and its gradient are finite at the centre of every shape except tori",
          "[part]") {
  for (const auto& face : all_shapes()) {
    if (face->mesh() == MeshPattern::torus) continue;
    const std::unique_ptr<Part> part = make_part("part", face->name(), {}, 1000);
    part->prepare();
    const ParameterValues<double> rest = part->parameters().rest();
    INFO(face->name());
    CHECK(std::isfinite(part->inside_outside({0, 0, 0}, rest)));
    CHECK(part->inside_outside_gradient({0, 0, 0}, rest).allFinite());
  }
}

TEST_CASE("N11: an initial shape that folds over is refused", "[part]") {
  const std::unique_ptr<Part> part = make_part("fat", "cylinder", {"bend"}, 1000);
  part->initial({{"bend.angle", 2.5}});
  REQUIRE_THROWS_WITH(part->prepare(), test::has_text("part 'fat': its initial shape folds over"));
}

}  // namespace laws_test
