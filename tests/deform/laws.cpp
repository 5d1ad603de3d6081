// Laws of every global deformation in AllDeforms (deform/all_deforms.h): identity, inverse, derivatives,
// determinants, and the kernel that applies a link of a chain.
// N11 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <cmath>

#include <Eigen/LU>

#include <pliant/deform/all_deforms.h>
#include <pliant/deform/link.h>

#include "differences.h"
#include "draws.h"
#include "worst.h"

namespace laws_test {

using namespace pliant;
using test::Draws;

namespace {

using Long = long double;
template <class Deform>
using Numbers = Vec<double, deform_size<Deform>>;

template <class Deform>
Numbers<Deform> defaults() {
  Numbers<Deform> b;
  for (int k = 0; k < deform_size<Deform>; ++k)
    b[k] = Deform::parameters[static_cast<std::size_t>(k)].standard;
  return b;
}
/// Returns random parameters in the dynamic range. |tx| and |ty| of a taper are at most 0.95, because a full
/// taper (|tx| or |ty| = 1) has no inverse at its tip.
template <class Deform>
Numbers<Deform> draw(Draws& draws) {
  Numbers<Deform> b;
  for (int k = 0; k < deform_size<Deform>; ++k)
    b[k] = draws.parameter(Deform::parameters[static_cast<std::size_t>(k)]);
  if (std::string(Deform::name) == "taper") b *= 0.95;
  return b;
}
constexpr double kHalfHeight = 1.7;  // m
/// Returns a random position in a solid that is so slim that no bend in the range folds it. The determinant
/// of the bend is 1 - k r, with the curvature k and the coordinate r along the direction of the bend. In
/// this solid the determinant is above 0.4.
Vec3<double> body_point(Draws& draws) {
  return {draws.uniform(-0.2, 0.2), draws.uniform(-0.2, 0.2), draws.uniform(-kHalfHeight, kHalfHeight)};
}

template <class Deform>
Mat3<double> gradient(const Vec3<double>& p, double h, const Numbers<Deform>& b) {
  using D = Dual<3>;
  const Vec3<D> at{D::variable(p[0], 0), D::variable(p[1], 1), D::variable(p[2], 2)};
  const Vec3<D> result = Deform::template apply<D>(at, D(h), b.template cast<D>());
  Mat3<double> F;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) F(r, c) = result[r].d[static_cast<std::size_t>(c)];
  return F;
}

/// Returns the deformed position. all: the arguments of Deform::apply() in one vector, that is the position
/// p, the half height h and the parameters b.
template <class Deform, class T>
Vec3<T> apply_to_all(const Vec<T, 4 + deform_size<Deform>>& all) {
  return Deform::template apply<T>(Vec3<T>(all.template head<3>()), all[3],
                                   Vec<T, deform_size<Deform>>(all.template tail<deform_size<Deform>>()));
}

}  // namespace

TEMPLATE_LIST_TEST_CASE("the defaults are the identity, bit for bit", "[deform]", AllDeforms) {
  Draws draws(1);
  for (int trial = 0; trial < 200; ++trial) {
    const Vec3<double> p = draws.vector(3);
    const double h = draws.uniform(0.1, 4);
    CHECK(TestType::template apply<double>(p, h, defaults<TestType>()) == p);
    CHECK(TestType::template inverse<double>(p, h, defaults<TestType>()) == p);
  }
}

// The amplitudes of a deformation are its first parameters; at their defaults the deformation is the
// identity.
TEMPLATE_LIST_TEST_CASE(
    "with amplitudes at their defaults the deformation is the identity, for any values of other parameters",
    "[deform]", AllDeforms) {
  Draws draws(8);
  for (int trial = 0; trial < 200; ++trial) {
    Numbers<TestType> b = draw<TestType>(draws);
    b.template head<deform_amplitudes<TestType>>() =
        defaults<TestType>().template head<deform_amplitudes<TestType>>();
    REQUIRE(is_identity<TestType>(b.data()));
    const Vec3<double> p = draws.vector(3);
    const double h = draws.uniform(0.1, 4);
    CHECK((TestType::template apply<double>(p, h, b) - p).norm() <= 1e-15 * p.norm());
    CHECK((gradient<TestType>(p, h, b) - Mat3<double>::Identity()).norm() <= 1e-15);
    b[0] += 1e-300;
    CHECK_FALSE(is_identity<TestType>(b.data()));
  }
}

TEMPLATE_LIST_TEST_CASE("the inverse reverses the deformation", "[deform]", AllDeforms) {
  Draws draws(2);
  for (int trial = 0; trial < 1000; ++trial) {
    const Vec3<double> p = body_point(draws);
    const Numbers<TestType> b = draw<TestType>(draws);
    const Vec3<double> result = TestType::template apply<double>(p, kHalfHeight, b);
    const Vec3<double> back = TestType::template inverse<double>(result, kHalfHeight, b);
    INFO(TestType::name << " b " << b.transpose() << " p " << p.transpose());
    // A taper near its tip amplifies rounding errors in the inverse.
    const double stretch = std::max(1.0, gradient<TestType>(p, kHalfHeight, b).inverse().norm());
    CHECK((back - p).norm() <= 2e-14 * stretch);
  }
}

TEMPLATE_LIST_TEST_CASE("derivatives agree with differences in long double", "[deform]", AllDeforms) {
  constexpr int K = deform_size<TestType>;
  Draws draws(3);
  test::Worst worst, worst_curvature;
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3<double> p = body_point(draws);
    Numbers<TestType> b = draw<TestType>(draws);
    if (trial == 0) b = defaults<TestType>();
    using D = Dual<4 + K>;
    Vec<double, 4 + K> x, rate;
    x << p, kHalfHeight, b;
    for (int k = 0; k < 4 + K; ++k) rate[k] = draws.uniform(-1, 1);
    Vec<D, 4 + K> x_d;
    Vec<Taylor2<double>, 4 + K> x_t;
    for (int k = 0; k < 4 + K; ++k) {
      x_d[k] = D::variable(x[k], k);
      x_t[k] = Taylor2<double>(x[k], rate[k], 0);
    }
    const Vec3<D> dual = apply_to_all<TestType, D>(x_d);
    using VecL = Vec<Long, 4 + K>;
    const VecL x_l = x.template cast<Long>(), rate_l = rate.template cast<Long>();
    const double size = std::max(1.0, dual[0].v * dual[0].v + dual[1].v * dual[1].v + dual[2].v * dual[2].v);
    for (int k = 0; k < 4 + K; ++k) {
      const Vec3<Long> slope = test::first_derivative(
          [&](Long t) {
            VecL at = x_l;
            at[k] += t;
            return apply_to_all<TestType, Long>(at);
          },
          5e-4L);
      for (int r = 0; r < 3; ++r)
        worst.note(std::abs(dual[r].d[static_cast<std::size_t>(k)] - static_cast<double>(slope[r])) / size);
    }
    auto path = [&](Long t) { return apply_to_all<TestType, Long>(VecL(x_l + t * rate_l)); };
    const Vec3<Long> first = test::first_derivative(path, 5e-4L),
                     second = test::second_derivative(path, 1.7e-3L);
    const Vec3<Taylor2<double>> along = apply_to_all<TestType, Taylor2<double>>(x_t);
    for (int r = 0; r < 3; ++r) {
      worst.note(std::abs(along[r].d - static_cast<double>(first[r])) / size);
      worst_curvature.note(std::abs(along[r].dd - static_cast<double>(second[r])) /
                           std::max(1.0, std::abs(along[r].dd)));
    }
  }
  CHECK(worst < 1e-12);
  CHECK(worst_curvature < 1e-12);
}

TEST_CASE("N11: a bend and its derivatives are continuous at zero bend", "[deform]") {
  Draws draws(4);
  for (double angle : {0.0, 1e-300, 1e-12, -1e-12, 1e-6, -1e-6}) {
    for (int trial = 0; trial < 20; ++trial) {
      const Vec3<double> p = body_point(draws);
      const double h = kHalfHeight, k = angle / h, r = p[0], z = p[2];
      using D = Dual<2>;
      const Vec<D, 2> b{D::variable(angle, 0), D::variable(0.0, 1)};
      const Vec3<D> result = Bend::apply<D>(p.cast<D>(), D(h), b);
      // Power series of r cos kz + (1 - cos kz)/k and of sin(kz)/k - r sin kz in the curvature k.
      const double across = r + k * z * z / 2 - k * k * r * z * z / 2 - k * k * k * z * z * z * z / 24;
      const double along = z - k * r * z - k * k * z * z * z / 6;
      const double across_slope = z * z / 2 - k * r * z * z - k * k * z * z * z * z / 8;
      const double along_slope = -r * z - k * z * z * z / 3 + k * k * r * z * z * z / 2;
      CHECK(result[0].v == Approx(across).epsilon(1e-14).margin(1e-15));
      CHECK(result[2].v == Approx(along).epsilon(1e-14).margin(1e-15));
      CHECK(result[0].d[0] == Approx(across_slope / h).epsilon(1e-12).margin(1e-14));
      CHECK(result[2].d[0] == Approx(along_slope / h).epsilon(1e-12).margin(1e-14));
      // The direction has no effect at zero bend.
      CHECK(std::abs(result[1].d[1]) <= std::abs(angle) * 10);
    }
  }
}

TEST_CASE("a bend rotates the tangent at the end of the axis by its angle, and does not stretch it",
          "[deform]") {
  for (double angle : {0.3, -1.0, 2.0, 3.1})
    for (double direction : {0.0, 0.7, -2.0}) {
      const Vec<double, 2> b(angle, direction);
      const Mat3<double> top = gradient<Bend>({0, 0, kHalfHeight}, kHalfHeight, b);
      const Vec3<double> tangent = top.col(2);
      CHECK(tangent.norm() == Approx(1).epsilon(1e-14));
      CHECK(tangent[2] == Approx(std::cos(angle)).margin(1e-14));
      CHECK(tangent[0] * std::cos(direction) + tangent[1] * std::sin(direction) ==
            Approx(std::sin(angle)).margin(1e-14));
    }
}

TEST_CASE("N11: the inverse of a bend is valid up to the ends of its range, half a turn", "[deform]") {
  Draws draws(9);
  for (double angle : {3.14, -3.14, kPi, -kPi, kPi / 2, -kPi / 2, 1.5707963, 3.1})
    for (double zeta : {-1.0, -0.999, -0.5, 0.0, 0.5, 0.999, 1.0})
      for (int trial = 0; trial < 40; ++trial) {
        const Vec3<double> p(draws.uniform(-0.2, 0.2), draws.uniform(-0.2, 0.2), zeta * kHalfHeight);
        const Vec<double, 2> b(angle, draws.uniform(-6.3, 6.3));
        const Vec3<double> result = Bend::apply<double>(p, kHalfHeight, b);
        Vec3<double> back = Bend::inverse<double>(result, kHalfHeight, b);
        INFO("angle " << angle << " zeta " << zeta << " p " << p.transpose());
        // If the angle is pi, each half bends by half a turn. The two ends then coincide, so that the inverse
        // does not determine the sign of z.
        if (std::abs(angle) == kPi && std::abs(zeta) == 1) back[2] = std::copysign(back[2], zeta);
        CHECK((back - p).norm() <= 1e-14);
      }
}

TEST_CASE("determinants of the deformations agree with closed forms", "[deform]") {
  Draws draws(5);
  for (int trial = 0; trial < 300; ++trial) {
    const Vec3<double> p = body_point(draws);
    const double h = kHalfHeight, zeta = p[2] / h;
    {  // twists of up to 100 turns
      const double turns = trial % 3 == 0 ? 0.5 : (trial % 3 == 1 ? 10 : 100);
      CHECK(gradient<Twist>(p, h, Vec<double, 1>(2 * kPi * turns)).determinant() == Approx(1).epsilon(1e-13));
    }
    {  // large shears
      const Vec<double, 2> b(1e3, draws.uniform(-1e3, 1e3));
      CHECK(gradient<Shear>(p, h, b).determinant() == Approx(1).epsilon(1e-13));
    }
    {
      const Vec<double, 2> b = draw<Taper>(draws);
      CHECK(gradient<Taper>(p, h, b).determinant() ==
            Approx((1 + b[0] * zeta) * (1 + b[1] * zeta)).epsilon(1e-13).margin(1e-14));
    }
    {
      const Vec<double, 2> b = draw<Bend>(draws);
      const double r = std::cos(b[1]) * p[0] + std::sin(b[1]) * p[1];
      CHECK(gradient<Bend>(p, h, b).determinant() == Approx(1 - b[0] / h * r).epsilon(1e-13));
    }
    {
      const Vec<double, 3> b = draw<BendOffset>(draws);
      CHECK(gradient<BendOffset>(p, h, b).determinant() == Approx(1).epsilon(1e-14));
    }
  }
}

// A link of a chain is the map T(p, h, b) of the position p, the half height h and the parameters b. The
// kernel that applies the link replaces the Jacobian J of the position by [F J + T_h dh/da, G_T]. F, T_h and
// G_T are the derivatives of T by p, h and the dynamic b, and a are the parameters of the shape. s1 and s2
// are the first and second time derivatives of the position (jet.h); p, h and b depend on time.
TEMPLATE_LIST_TEST_CASE("a link propagates jets by the chain rule", "[deform]", AllDeforms) {
  constexpr int K = deform_size<TestType>;
  Draws draws(6);
  for (int trial = 0; trial < 60; ++trial) {
    const Numbers<TestType> b = draw<TestType>(draws);
    Numbers<TestType> b_dot = Numbers<TestType>::Zero();
    std::array<bool, K> dynamic{};
    for (int k = 0; k < K; ++k) {
      dynamic[static_cast<std::size_t>(k)] = draws.uniform(0, 1) < 0.6;
      b_dot[k] = dynamic[static_cast<std::size_t>(k)] ? draws.uniform(-1, 1) : 0.0;
    }
    // The first two columns of J are for parameters of the shape, and the first of these parameters also
    // changes h. The third column is for a parameter of an earlier link.
    HalfHeight<double> half;
    half.h = Taylor2<double>(kHalfHeight, draws.uniform(-1, 1), draws.uniform(-1, 1));
    half.slope.resize(2);
    half.slope << 0.8, 0.0;
    Jet<double> jet;
    jet.s = body_point(draws);
    jet.s1 = draws.vector(1);
    jet.s2 = draws.vector(1);
    for (std::size_t c = 0; c < 3; ++c) jet.J[c] = draws.vector(1);
    const Jet<double> in = jet;
    JetBatch<double> batch{&jet, 1, 3, Level::rates};
    apply_link<TestType>(half, LinkParameters<double>{b.data(), b_dot.data(), dynamic.data()}, batch);

    using VecK = Vec<Long, K>;
    auto T = [&](const Vec3<Long>& p, Long h, const VecK& at) {
      return Vec3<Long>(TestType::template apply<Long>(p, h, at));
    };
    const Vec3<Long> p = in.s.cast<Long>();
    const VecK b_l = b.template cast<Long>();
    const Vec3<double> value = T(p, kHalfHeight, b_l).template cast<double>();
    CHECK((jet.s - value).norm() <= 1e-14 * value.norm());
    std::size_t column = 0;
    for (; column < 3; ++column) {
      const Long slope = column < 2 ? half.slope[static_cast<int>(column)] : 0.0;
      const Vec3<Long> d = test::first_derivative(
          [&](Long t) { return T(p + t * in.J[column].template cast<Long>(), kHalfHeight + t * slope, b_l); },
          5e-4L);
      CHECK((jet.J[column] - d.template cast<double>()).norm() <= 1e-11 * std::max(1.0L, d.norm()));
    }
    for (int k = 0; k < K; ++k) {
      if (!dynamic[static_cast<std::size_t>(k)]) continue;
      const Vec3<Long> d = test::first_derivative(
          [&](Long t) {
            VecK at = b_l;
            at[k] += t;
            return T(p, kHalfHeight, at);
          },
          5e-4L);
      CHECK((jet.J[column++] - d.template cast<double>()).norm() <= 1e-11 * std::max(1.0L, d.norm()));
    }
    CHECK(batch.n_columns == static_cast<int>(column));
    auto path = [&](Long t) {
      return T(p + t * in.s1.cast<Long>() + t * t / 2 * in.s2.cast<Long>(),
               half.h.v + t * half.h.d + t * t / 2 * half.h.dd, b_l + t * b_dot.template cast<Long>());
    };
    const Vec3<double> s1 = test::first_derivative(path, 5e-4L).template cast<double>();
    const Vec3<double> s2 = test::second_derivative(path, 1.7e-3L).template cast<double>();
    CHECK((jet.s1 - s1).norm() <= 1e-11 * std::max(1.0, s1.norm()));
    CHECK((jet.s2 - s2).norm() <= 1e-10 * std::max(1.0, s2.norm()));
  }
}

}  // namespace laws_test
