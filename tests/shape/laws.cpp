// Laws of every shape in AllShapes (shape/all_shapes.h): e and its derivatives, and the inverse of e. e maps
// a material point (u, v, w) to its position. The label of a position x is the material point with e(label) =
// x; the gauge of x is the radial coordinate w of this material point.
// N01, N02, N05 and N15 in names of tests are rows of the table in tests/README.md.
#include "catch.h"

#include <cmath>

#include <pliant/math/scalar/taylor2.h>
#include <pliant/part/part.h>
#include <pliant/part/registry.h>
#include <pliant/part/shape_interface.h>
#include <pliant/shape/all_shapes.h>

#include "differences.h"
#include "draws.h"
#include "worst.h"

namespace laws_test {

using namespace pliant;
using test::Draws;

namespace {

using Long = long double;

Trig<Long> widen(const Trig<double>& t) {
  return {t.x, t.sign, t.sign != 0 ? std::log(std::abs(static_cast<Long>(t.x))) : kLogZero};
}
Material<Long> widen(const Material<double>& m) {
  return {widen(m.cu), widen(m.su), widen(m.cv), widen(m.sv), m.w};
}

template <class Shape>
ShapeVec<Shape, double> draw_parameters(Draws& draws) {
  ShapeVec<Shape, double> a;
  for (int k = 0; k < shape_size<Shape>; ++k)
    a[k] = draws.parameter(Shape::parameters[static_cast<std::size_t>(k)]);
  return a;
}
template <class Shape>
ShapeVec<Shape, double> defaults() {
  ShapeVec<Shape, double> a;
  for (int k = 0; k < shape_size<Shape>; ++k) a[k] = Shape::parameters[static_cast<std::size_t>(k)].standard;
  return a;
}
/// Returns the parameters with every exponent replaced by eps.
template <class Shape>
ShapeVec<Shape, double> with_exponents(ShapeVec<Shape, double> a, double eps) {
  for (int k = 0; k < shape_size<Shape>; ++k)
    if (Shape::parameters[static_cast<std::size_t>(k)].quantity == Quantity::exponent) a[k] = eps;
  return a;
}
template <class Shape>
double size_of(const ShapeVec<Shape, double>& a) {
  double size = 0;
  for (const Material<double>& m : test::special_points(Shape::mesh))
    size = std::max(size, Shape::template e<double>(m, a).norm());
  return size;
}
/// Returns the step of finite differences for a parameter of value a: 1e-3 times the larger of |a| and 0.1.
Long step_of(double a) {
  return 1e-3L * std::max(std::abs(a), 0.1);
}

/// Returns the special points of the shape (poles, seams and others, draws.h) and 60 random material points.
template <class Shape>
std::vector<Material<double>> test_points(Draws& draws) {
  std::vector<Material<double>> points = test::special_points(Shape::mesh);
  for (int i = 0; i < 60; ++i) points.push_back(draws.material(Shape::mesh));
  return points;
}

}  // namespace

TEMPLATE_LIST_TEST_CASE("e and its parameter derivatives agree with long double", "[shape]", AllShapes) {
  using Shape = TestType;
  constexpr int K = shape_size<Shape>;
  Draws draws(1);
  test::Worst worst_value, worst_slope, worst_curvature;
  for (int trial = 0; trial < 12; ++trial) {
    const ShapeVec<Shape, double> a = trial == 0 ? defaults<Shape>() : draw_parameters<Shape>(draws);
    const ShapeVec<Shape, Long> al = a.template cast<Long>();
    const double size = size_of<Shape>(a);
    ShapeVec<Shape, double> rate;
    for (int k = 0; k < K; ++k) rate[k] = draws.uniform(-1, 1) * std::max(std::abs(a[k]), 0.1);
    for (const Material<double>& m : test_points<Shape>(draws)) {
      const Material<Long> ml = widen(m);
      const Vec3<Long> value = Shape::template e<Long>(ml, al);
      worst_value.note((Shape::template e<double>(m, a).template cast<Long>() - value).norm() / size);

      using D = Dual<K>;
      Vec<D, K> a_d;
      for (int k = 0; k < K; ++k) a_d[k] = D::variable(a[k], k);
      const Vec3<D> dual = Shape::template e<D>(m, a_d);
      for (int k = 0; k < K; ++k) {
        const Vec3<Long> slope = test::first_derivative(
            [&](Long t) {
              ShapeVec<Shape, Long> shifted = al;
              shifted[k] += t;
              return Vec3<Long>(Shape::template e<Long>(ml, shifted));
            },
            step_of(a[k]));
        for (int r = 0; r < 3; ++r) {
          const double d = dual[r].d[static_cast<std::size_t>(k)];
          REQUIRE(std::isfinite(d));
          worst_slope.note(std::abs(d - static_cast<double>(slope[r])) * std::abs(a[k]) / size);
        }
      }

      Vec<Taylor2<double>, K> a_t;
      for (int k = 0; k < K; ++k) a_t[k] = Taylor2<double>(a[k], rate[k], 0);
      const Vec3<Taylor2<double>> along = Shape::template e<Taylor2<double>>(m, a_t);
      auto path = [&](Long t) {
        return Vec3<Long>(Shape::template e<Long>(ml, al + t * rate.template cast<Long>()));
      };
      const Vec3<Long> first = test::first_derivative(path, 1e-3L),
                       second = test::second_derivative(path, 3e-3L);
      for (int r = 0; r < 3; ++r) {
        worst_slope.note(std::abs(along[r].d - static_cast<double>(first[r])) / size);
        worst_curvature.note(std::abs(along[r].dd - static_cast<double>(second[r])) / size);
      }
    }
  }
  CHECK(worst_value < 1e-14);
  CHECK(worst_slope < 1e-12);
  CHECK(worst_curvature < 1e-12);
}

TEMPLATE_LIST_TEST_CASE("derivatives by dual numbers in double and in long double agree", "[shape]",
                        AllShapes) {
  using Shape = TestType;
  constexpr int K = shape_size<Shape>;
  Draws draws(2);
  test::Worst worst;
  // 0.02 and 5 are allowed for frozen exponents only. draw_parameters() draws from the smaller range of
  // dynamic exponents.
  for (double eps : {0.02, 0.1, 0.5, 1.0, 1.9, 5.0}) {
    const ShapeVec<Shape, double> a = with_exponents<Shape>(draw_parameters<Shape>(draws), eps);
    const double size = size_of<Shape>(a);
    for (const Material<double>& m : test_points<Shape>(draws)) {
      using D = Dual<K>;
      using DL = Dual<K, Long>;
      Vec<D, K> a_d;
      Vec<DL, K> a_l;
      for (int k = 0; k < K; ++k) {
        a_d[k] = D::variable(a[k], k);
        a_l[k] = DL::variable(a[k], k);
      }
      const Vec3<D> e = Shape::template e<D>(m, a_d);
      const Vec3<DL> el = Shape::template e<DL>(widen(m), a_l);
      for (int r = 0; r < 3; ++r)
        for (std::size_t k = 0; k < K; ++k)
          worst.note(std::abs(e[r].d[k] - static_cast<double>(el[r].d[k])) *
                     std::abs(a[static_cast<int>(k)]) / size);
    }
  }
  CHECK(worst < 1e-12);
}

TEMPLATE_LIST_TEST_CASE("N01 N02 N15: points at poles, seams and centres are finite, and surfaces close",
                        "[shape]", AllShapes) {
  using Shape = TestType;
  constexpr int K = shape_size<Shape>;
  for (double eps : {0.02, 0.03, 0.1, 0.3, 1.0, 2.0, 5.0}) {
    const ShapeVec<Shape, double> a = with_exponents<Shape>(defaults<Shape>(), eps);
    using D = Dual<K>;
    Vec<D, K> a_d;
    Vec<Taylor2<double>, K> a_t;
    for (int k = 0; k < K; ++k) {
      a_d[k] = D::variable(a[k], k);
      a_t[k] = Taylor2<double>(a[k], 1, 0);
    }
    for (const Material<double>& m : test::special_points(Shape::mesh)) {
      const Vec3<D> e = Shape::template e<D>(m, a_d);
      const Vec3<Taylor2<double>> t = Shape::template e<Taylor2<double>>(m, a_t);
      for (int r = 0; r < 3; ++r) {
        REQUIRE(std::isfinite(e[r].v));
        for (double d : e[r].d) REQUIRE(std::isfinite(d));
        REQUIRE(std::isfinite(t[r].dd));
      }
    }
    // v = -pi and v = pi give one position, to the last bit. At a pole, v has no effect.
    for (int i = -2; i <= 2; ++i)
      for (double w : {0.25, 1.0}) {
        const double u = i * kPi / 4;
        CHECK(Shape::template e<double>(material_at(u, -kPi, w), a) ==
              Shape::template e<double>(material_at(u, kPi, w), a));
        if (Shape::mesh == MeshPattern::ball && std::abs(i) == 2) {
          CHECK(Shape::template e<double>(material_at(u, 1.1, w), a) ==
                Shape::template e<double>(material_at(u, -2, w), a));
        }
      }
  }
}

TEST_CASE("N02: the derivative of a power by its exponent is zero at base zero", "[shape]") {
  for (double eps : {0.02, 0.03, 0.1, 0.3, 1.0}) {
    Vec<Dual<5>, 5> a;
    const double values[5] = {1, 1, 1, eps, eps};
    for (int k = 0; k < 5; ++k) a[k] = Dual<5>::variable(values[k], k);
    const Vec3<Dual<5>> pole = Superellipsoid::e<Dual<5>>(material_at(kPi / 2, 0), a);
    CHECK(pole[0].v == 0);
    CHECK(pole[0].d[3] == 0);
    CHECK(pole[2].v == 1);
    CHECK(pole[2].d[3] == 0);
  }
}

TEST_CASE("N02: exponents outside their range are refused, and the message contains the range", "[shape]") {
  for (double eps : {0.01, 1e-3, 1e-6, 0.0, -0.1, 5.1}) {
    const std::unique_ptr<Part> part = make_part("p", "superellipsoid", {}, 1000);
    CHECK_THROWS_WITH(part->rest({{"eps1", eps}}), test::has_text("[0.02, 5]"));
  }
}

TEMPLATE_LIST_TEST_CASE("points are linear in the radial coordinate", "[shape]", AllShapes) {
  using Shape = TestType;
  Draws draws(3);
  for (int trial = 0; trial < 8; ++trial) {
    const ShapeVec<Shape, double> a = draw_parameters<Shape>(draws);
    const double size = size_of<Shape>(a);
    for (Material<double> m : test_points<Shape>(draws)) {
      const Vec3<double> now = Shape::template e<double>(m, a);
      const double w = m.w;
      m.w = 1;
      const Vec3<double> surface = Shape::template e<double>(m, a);
      m.w = 0;
      const Vec3<double> centre = Shape::template e<double>(m, a);
      CHECK((now - centre - w * (surface - centre)).norm() <= 1e-14 * size);
      if (Shape::mesh == MeshPattern::ball)
        CHECK(centre.norm() == 0);
      else
        CHECK(centre[2] == 0);
    }
  }
}

TEMPLATE_LIST_TEST_CASE("gauge and label invert e", "[shape]", AllShapes) {
  using Shape = TestType;
  Draws draws(4);
  for (double eps : {0.02, 0.1, 0.5, 1.0, 1.5, 2.0, 5.0}) {
    for (int trial = 0; trial < 4; ++trial) {
      const ShapeVec<Shape, double> a =
          with_exponents<Shape>(trial == 0 ? defaults<Shape>() : draw_parameters<Shape>(draws), eps);
      const ShapeInterfaceOf<Shape> face;
      const double size = size_of<Shape>(a);
      for (const Material<double>& m : test_points<Shape>(draws)) {
        const Vec3<double> x = Shape::template e<double>(m, a);
        // The rounding of the position x limits the accuracy of its gauge.
        double rounding = 0;
        for (int i = 0; i < 6; ++i) {
          const Vec3<double> off = (i < 3 ? 1e-15 : -1e-15) * size * Vec3<double>::Unit(i % 3);
          rounding += std::abs(face.gauge(x + off, a.data()) - face.gauge(x, a.data()));
        }
        const double tolerance = 1e-10 + rounding;
        INFO(Shape::name << " eps " << eps << " w " << m.w << " x " << x.transpose());
        CHECK(std::abs(face.gauge(x, a.data()) - m.w) <= tolerance);
        const Material<double> found = face.label(x, a.data());
        CHECK(std::abs(found.w - m.w) <= tolerance);
        CHECK((Shape::template e<double>(found, a) - x).norm() <= 1e-10 * size);
        CHECK(found.cu.x * found.cu.x + found.su.x * found.su.x == Approx(1).epsilon(1e-12));
        CHECK(found.cv.x * found.cv.x + found.sv.x * found.sv.x == Approx(1).epsilon(1e-12));
      }
    }
  }
}

TEMPLATE_LIST_TEST_CASE("the gauge's gradient agrees with finite differences", "[shape]", AllShapes) {
  using Shape = TestType;
  // Shapes without a closed-form label find the gauge by iteration, in double precision only.
  constexpr bool has_label = detail::has_label<Shape>;
  constexpr Long step = has_label ? 1e-4L : 1e-3L, converged = has_label ? 1e-10L : 1e-7L;
  Draws draws(5);
  int n_smooth = 0;
  for (int trial = 0; trial < 200; ++trial) {
    const ShapeVec<Shape, double> a = draw_parameters<Shape>(draws);
    const ShapeInterfaceOf<Shape> face;
    const double size = size_of<Shape>(a);
    const Vec3<double> x = draws.vector(0.8 * size);
    const ShapeVec<Shape, Long> al = a.template cast<Long>();
    const Vec3<double> g = face.gauge_gradient(x, a.data());
    Vec3<Long> differences, finer_differences;
    for (int r = 0; r < 3; ++r) {
      auto along = [&](Long t) {
        Vec3<Long> shifted = x.cast<Long>();
        shifted[r] += t;
        if constexpr (has_label)
          return Shape::template gauge<Long>(shifted, al);
        else
          return static_cast<Long>(face.gauge(shifted.template cast<double>(), a.data()));
      };
      differences[r] = test::first_derivative(along, step * size);
      finer_differences[r] = test::first_derivative(along, 0.5L * step * size);
    }
    // Differences do not converge near a kink (a rim, an edge, a coordinate plane); such points are skipped.
    if ((differences - finer_differences).norm() > converged * differences.norm()) continue;
    ++n_smooth;
    INFO(Shape::name << " a " << a.transpose() << " x " << x.transpose());
    CHECK((g - differences.cast<double>()).norm() <= (has_label ? 1e-8 : 1e-6) * g.norm());
  }
  CHECK(n_smooth > 0.9 * 200);
}

TEMPLATE_LIST_TEST_CASE("the gauge and its gradient are finite at the centre and on the x and z axes",
                        "[shape]", AllShapes) {
  using Shape = TestType;
  const ShapeVec<Shape, double> a = defaults<Shape>();
  const ShapeInterfaceOf<Shape> face;
  const double size = size_of<Shape>(a);
  for (const double z : {0.0, 1e-200, 0.3, 1.0, -1.0})
    for (const Vec3<double>& x : {Vec3<double>(0, 0, z * size), Vec3<double>(z * size, 0, 0)}) {
      INFO(Shape::name << " at " << x.transpose());
      CHECK(std::isfinite(face.gauge(x, a.data())));
      CHECK(face.gauge_gradient(x, a.data()).allFinite());
    }
}

TEMPLATE_LIST_TEST_CASE("N05: outside the solid, the gauge never overflows and increases along every ray",
                        "[shape]", AllShapes) {
  using Shape = TestType;
  Draws draws(6);
  for (double eps : {0.02, 0.1, 1.0, 5.0}) {
    const ShapeVec<Shape, double> a = with_exponents<Shape>(defaults<Shape>(), eps);
    const ShapeInterfaceOf<Shape> face;
    for (int trial = 0; trial < 40; ++trial) {
      const Vec3<double> direction = draws.vector(1);
      double before = 1;
      for (double distance : {20., 1e2, 1e3, 1e6, 1e12}) {
        const double g = face.gauge(distance * direction.normalized(), a.data());
        REQUIRE(std::isfinite(g));
        CHECK(g > before);
        CHECK(face.gauge_gradient(distance * direction.normalized(), a.data()).allFinite());
        before = g;
      }
    }
  }
}

TEMPLATE_LIST_TEST_CASE("half_height is half the extent along z", "[shape]", AllShapes) {
  using Shape = TestType;
  Draws draws(7);
  for (int trial = 0; trial < 10; ++trial) {
    const ShapeVec<Shape, double> a = draw_parameters<Shape>(draws);
    const double h = Shape::template half_height<double>(a);
    double reach = 0;
    for (const Material<double>& m : test_points<Shape>(draws))
      reach = std::max(reach, std::abs(Shape::template e<double>(m, a)[2]));
    CHECK(reach == Approx(h).epsilon(1e-14));
  }
}

TEMPLATE_LIST_TEST_CASE("mesh_label returns material points of the surface", "[shape]", AllShapes) {
  using Shape = TestType;
  Draws draws(8);
  for (double eps : {0.02, 0.1, 0.6, 1.0, 1.9, 5.0}) {
    const ShapeVec<Shape, double> a = with_exponents<Shape>(defaults<Shape>(), eps);
    const ShapeInterfaceOf<Shape> face;
    for (int trial = 0; trial < 100; ++trial) {
      const Vec3<double> g =
          Shape::mesh == MeshPattern::ball ? draws.vector(1) : Vec3<double>(draws.vector(kPi));
      const Material<double> m = face.mesh_label(g, a.data());
      CHECK(m.w == 1);
      const Vec3<double> x = Shape::template e<double>(m, a);
      const Vec3<double> slope = face.gauge_gradient(x, a.data());
      CHECK(std::abs(face.gauge(x, a.data()) - 1) <= 1e-10 + 1e-15 * slope.norm() * size_of<Shape>(a));
    }
  }
}

}  // namespace laws_test
