// Laws of the support functions of all shapes. The support point is on the surface, and no point of the solid
// is farther in the given direction. The gradient of the support function is the support point.
#include "catch.h"

#include <cmath>

#include <pliant/shape/all_shapes.h>

#include "draws.h"
#include "worst.h"

namespace support_test {

using namespace pliant;
using test::Draws;
using test::Worst;

namespace {

template <class Shape>
ShapeVec<Shape, double> draw_parameters(Draws& draws, int trial) {
  ShapeVec<Shape, double> a;
  for (int k = 0; k < shape_size<Shape>; ++k) {
    const ParameterSpec& spec = Shape::parameters[static_cast<std::size_t>(k)];
    a[k] = trial == 0 ? spec.standard : draws.parameter(spec);
    // Exponents of all sizes: nearly square, round, pointed; above 2 the solid is not convex.
    if (spec.quantity == Quantity::exponent && trial > 0)
      a[k] = std::pow(10.0, draws.uniform(-1.5, trial % 3 == 0 ? 0.6 : 0.29));
  }
  return a;
}

/// Returns a direction. Every fourth direction is in a coordinate plane, every eighth direction along an
/// axis.
Vec3<double> direction(Draws& draws, int i) {
  Vec3<double> m = draws.vector(1);
  if (i % 4 == 0) m[draws.integer(0, 2)] = 0;
  if (i % 8 == 0) m = (i % 16 == 0 ? 1.0 : -1.0) * Vec3<double>::Unit(draws.integer(0, 2));
  return m.normalized();
}

/// Returns the support point of a shape in the direction m: the farthest of the support points of its pieces.
template <class Shape, class T>
Vec3<T> support(const Vec3<T>& m, const ShapeVec<Shape, T>& a) {
  Vec3<T> best = Shape::template support<T>(m, a, 0);
  auto along = [&](const Vec3<T>& x) { return T(m[0] * x[0] + m[1] * x[1] + m[2] * x[2]); };
  for (int piece = 1; piece < Shape::hull_pieces; ++piece)
    if (const Vec3<T> x = Shape::template support<T>(m, a, piece); plain(along(x)) > plain(along(best)))
      best = x;
  return best;
}

}  // namespace

TEMPLATE_LIST_TEST_CASE("a support point is on the surface, and no point of the solid is farther", "[shape]",
                        AllShapes) {
  using Shape = TestType;
  Draws draws(5);
  Worst off_surface, farther;
  for (int trial = 0; trial < 24; ++trial) {
    const auto a = draw_parameters<Shape>(draws, trial);
    std::vector<Vec3<double>> solid;
    for (const Material<double>& m : test::special_points(Shape::mesh))
      solid.push_back(Shape::template e<double>(m, a));
    for (int i = 0; i < 2000; ++i) {
      Material<double> m = draws.material(Shape::mesh);
      if (i % 2 == 0) m.w = 1;
      solid.push_back(Shape::template e<double>(m, a));
    }
    double size = 0;
    for (const Vec3<double>& x : solid) size = std::max(size, x.norm());
    for (int i = 0; i < 100; ++i) {
      const Vec3<double> m = direction(draws, i);
      const Vec3<double> support_point = support<Shape, double>(m, a);
      off_surface.note(std::abs(Shape::template gauge<double>(support_point, a) - 1));
      const double h = m.dot(support_point);
      for (const Vec3<double>& x : solid) farther.note(std::max(0.0, m.dot(x) - h) / size);
    }
  }
  CHECK(off_surface < 1e-12);
  CHECK(farther < 1e-14);
}

TEMPLATE_LIST_TEST_CASE("the gradient of the support function is the support point", "[shape]", AllShapes) {
  using Shape = TestType;
  using D = Dual<3>;
  Draws draws(6);
  Worst worst;
  for (int trial = 0; trial < 24; ++trial) {
    const auto a = draw_parameters<Shape>(draws, trial);
    for (int i = 0; i < 100; ++i) {
      const Vec3<double> m = draws.vector(1).normalized();
      const Vec3<D> m_dual{D::variable(m[0], 0), D::variable(m[1], 1), D::variable(m[2], 2)};
      const Vec3<D> x = support<Shape, D>(m_dual, a.template cast<D>());
      const D h = m_dual[0] * x[0] + m_dual[1] * x[1] + m_dual[2] * x[2];
      for (int k = 0; k < 3; ++k)
        worst.note(std::abs(h.d[static_cast<std::size_t>(k)] - x[k].v) / std::abs(h.v));
    }
  }
  CHECK(worst < 1e-9);
}

TEST_CASE("the derivative of the support point of a sphere is its radius, normal to the direction",
          "[shape]") {
  using D = Dual<3>;
  Draws draws(8);
  for (int i = 0; i < 20; ++i) {
    const double r = draws.uniform(0.1, 3), length = draws.uniform(0.1, 10);
    const Vec3<double> m = draws.vector(1).normalized();
    const Vec3<D> at{D::variable(length * m[0], 0), D::variable(length * m[1], 1),
                     D::variable(length * m[2], 2)};
    const Vec3<D> x = Sphere::support<D>(at, Vec<D, 1>(D(r)), 0);
    Mat3<double> slope;
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column)
        slope(row, column) = x[row].d[static_cast<std::size_t>(column)];
    const Mat3<double> across = Mat3<double>::Identity() - m * m.transpose();
    CHECK((slope * length - r * across).norm() < 1e-13 * r);
  }
}

TEMPLATE_LIST_TEST_CASE("the support point depends on the direction only, and its derivative is symmetric",
                        "[shape]", AllShapes) {
  using Shape = TestType;
  using D = Dual<3>;
  Draws draws(9);
  Worst of_length, asymmetric, negative;
  for (int trial = 0; trial < 24; ++trial) {
    const auto a = draw_parameters<Shape>(draws, trial);
    for (int i = 0; i < 50; ++i) {
      const Vec3<double> m = draws.vector(1).normalized();
      const double length = draws.uniform(0.1, 10);
      for (int piece = 0; piece < Shape::hull_pieces; ++piece) {
        const Vec3<double> one = Shape::template support<double>(m, a, piece),
                           other = Shape::template support<double>(length * m, a, piece);
        of_length.note((one - other).norm() / one.norm());
      }
      const Vec3<D> m_dual{D::variable(m[0], 0), D::variable(m[1], 1), D::variable(m[2], 2)};
      const Vec3<D> x = support<Shape, D>(m_dual, a.template cast<D>());
      Mat3<double> slope;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) slope(r, c) = x[r].d[static_cast<std::size_t>(c)];
      const double scale = slope.norm() + x[0].v + x[1].v + x[2].v;
      asymmetric.note((slope - slope.transpose()).norm() / std::abs(scale));
      const Vec3<double> e = draws.vector(1);
      negative.note(-e.dot(slope * e) / (slope.norm() + 1e-300));
    }
  }
  CHECK(of_length < 1e-9);  // flat regions amplify the rounding errors of the multiple of m
  CHECK(asymmetric < 1e-7);
  CHECK(negative < 1e-7);
}

}  // namespace support_test
