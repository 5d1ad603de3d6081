// Checks of the scalar types of formulas: Dual, Taylor2, Pack, and signed powers.
#include <cmath>
#include <cstring>
#include <random>
#include <vector>

#include <pliant/math/scalar/dual.h>
#include <pliant/math/scalar/pack.h>
#include <pliant/math/scalar/signed_power.h>
#include <pliant/math/scalar/taylor2.h>

#include "catch.h"

namespace scalars_test {

using pliant::Dual;
using pliant::Pack;
using pliant::Taylor2;
namespace math = pliant::math;
using Real = long double;

namespace {

bool same_bits(double a, double b) {
  return std::memcmp(&a, &b, sizeof a) == 0;
}

/// A random formula of two variables with moderate values and derivatives, for any scalar. Each step applies
/// an operation to two earlier results.
class RandomFormula {
 public:
  RandomFormula(unsigned seed, int length) {
    std::mt19937 generator(seed);
    for (int i = 0; i < length; ++i) {
      const auto pick = [&] { return static_cast<int>(generator() % static_cast<unsigned>(i + 2)); };
      steps_.push_back({static_cast<int>(generator() % 14u), pick(), pick()});
    }
  }

  template <class T>
  T operator()(const T& x, const T& y) const {
    std::vector<T> pool{x, y};
    for (const Step& s : steps_) {
      const T &a = pool[static_cast<std::size_t>(s.a)], &b = pool[static_cast<std::size_t>(s.b)];
      pool.push_back(apply(s.code, a, b));
    }
    return pool.back();
  }

 private:
  struct Step {
    int code, a, b;
  };
  template <class T>
  static T apply(int code, const T& a, const T& b) {
    switch (code) {
      case 0:
        return a + b;
      case 1:
        return a - b;
      case 2:
        return math::sin(a) * b;
      case 3:
        return a / (2.0 + b * b);
      case 4:
        return math::cos(a);
      case 5:
        return math::exp(T(math::sin(a)));
      case 6:
        return math::log(T(a * a + 1.5));
      case 7:
        return math::sqrt(T(1.0 + math::square(a)));
      case 8:
        return 1.0 / (a * a + 1.0);
      case 9:
        return -a * 0.5 + 0.25;
      case 10:
        return math::abs(a);
      case 11:
        return math::max(a, b);
      case 12:
        return math::min(a, b);
      default:
        return 3.0 - math::sin(T(a / 2.0)) - b;
    }
  }
  std::vector<Step> steps_;
};

bool close(double a, Real b, double tolerance) {
  return std::abs(a - static_cast<double>(b)) <= tolerance * (1 + std::abs(static_cast<double>(b)));
}

}  // namespace

TEST_CASE("every operation has its closed-form derivatives") {
  // x = 0.7 with rate 1.3 and second derivative -0.4; a function f gives f' xd and f'' xd^2 + f' xdd.
  const double x = 0.7, xd = 1.3, xdd = -0.4, c = 1.7;
  const Taylor2<double> t(x, xd, xdd);
  const Dual<1> d = Dual<1>::variable(x, 0);
  const auto check = [&](const char* name, const Taylor2<double>& y, const Dual<1>& dy, double f, double f1,
                         double f2) {
    INFO(name);
    CHECK(y.v == Approx(f).epsilon(1e-15));
    CHECK(y.d == Approx(f1 * xd).epsilon(1e-14));
    CHECK(y.dd == Approx(f2 * xd * xd + f1 * xdd).epsilon(1e-14));
    CHECK(dy.v == Approx(f).epsilon(1e-15));
    CHECK(dy.d[0] == Approx(f1).epsilon(1e-14));
  };
  check("x + c", t + c, d + c, x + c, 1, 0);
  check("c + x", c + t, c + d, x + c, 1, 0);
  check("x - c", t - c, d - c, x - c, 1, 0);
  check("c - x", c - t, c - d, c - x, -1, 0);
  check("x c", t * c, d * c, c * x, c, 0);
  check("c x", c * t, c * d, c * x, c, 0);
  check("x / c", t / c, d / c, x / c, 1 / c, 0);
  check("c / x", c / t, c / d, c / x, -c / (x * x), 2 * c / (x * x * x));
  check("-x", -t, -d, -x, -1, 0);
  check("x + x", t + t, d + d, 2 * x, 2, 0);
  check("x - sin x", t - sin(t), d - sin(d), x - std::sin(x), 1 - std::cos(x), std::sin(x));
  check("x x", t * t, d * d, x * x, 2 * x, 2);
  check("square", math::square(t), math::square(d), x * x, 2 * x, 2);
  check("x / (x + c)", t / (t + c), d / (d + c), x / (x + c), c / ((x + c) * (x + c)),
        -2 * c / std::pow(x + c, 3));
  check("sin", math::sin(t), math::sin(d), std::sin(x), std::cos(x), -std::sin(x));
  check("cos", math::cos(t), math::cos(d), std::cos(x), -std::sin(x), -std::cos(x));
  check("exp", math::exp(t), math::exp(d), std::exp(x), std::exp(x), std::exp(x));
  check("log", math::log(t), math::log(d), std::log(x), 1 / x, -1 / (x * x));
  check("sqrt", math::sqrt(t), math::sqrt(d), std::sqrt(x), 0.5 / std::sqrt(x), -0.25 / (x * std::sqrt(x)));
  check("abs", math::abs(Taylor2<double>(-t)), math::abs(Dual<1>(-d)), x, 1, 0);
  check("max", math::max(t, Taylor2<double>(0.1)), math::max(d, Dual<1>(0.1)), x, 1, 0);
  check("min", math::min(t, Taylor2<double>(0.1)), math::min(d, Dual<1>(0.1)), 0.1, 0, 0);
  check("where", math::where_positive(Taylor2<double>(-t), Taylor2<double>(1.0), t * t),
        math::where_positive(Dual<1>(-d), Dual<1>(1.0), d * d), x * x, 2 * x, 2);
}

TEST_CASE("assignment operators agree with the binary operators") {
  Taylor2<double> t(0.7, 1.3, -0.4), u = t;
  const Taylor2<double> w(2.0, -1.0, 0.5);
  u += w;
  u *= w;
  u -= w;
  u /= w;
  const Taylor2<double> expected = ((t + w) * w - w) / w;
  CHECK((u.v == expected.v && u.d == expected.d && u.dd == expected.dd));
  Dual<2> a = Dual<2>::variable(0.7, 0), b = Dual<2>::variable(2.0, 1), r = a;
  r += b;
  r *= b;
  r -= b;
  r /= b;
  const Dual<2> e = ((a + b) * b - b) / b;
  CHECK((r.v == e.v && r.d == e.d));
}

TEST_CASE("random formulas agree on every scalar") {
  const double dx = 0.6, dy = -1.1;
  for (unsigned seed = 0; seed < 400; ++seed) {
    const RandomFormula f(seed, 3 + static_cast<int>(seed % 12));
    std::mt19937 generator(seed);
    std::uniform_real_distribution<double> range(-2, 2);
    const double x = range(generator), y = range(generator);
    INFO("seed " << seed << " at " << x << ", " << y);

    const double value = f(x, y);
    const auto dual = f(Dual<2>::variable(x, 0), Dual<2>::variable(y, 1));
    const auto exact = f(Dual<2, Real>::variable(x, 0), Dual<2, Real>::variable(y, 1));
    CHECK(same_bits(dual.v, value));
    CHECK(close(value, exact.v, 1e-13));
    for (std::size_t i = 0; i < 2; ++i) CHECK(close(dual.d[i], exact.d[i], 1e-12));

    const Real h = 1.0L / (1 << 13);
    const Real difference = (8 * (f(Real(x) + h, Real(y)) - f(Real(x) - h, Real(y))) -
                             (f(Real(x) + 2 * h, Real(y)) - f(Real(x) - 2 * h, Real(y)))) /
                            (12 * h);
    CHECK(close(static_cast<double>(exact.d[0]), difference, 1e-9));

    const auto taylor = f(Taylor2<double>(x, dx, 0.0), Taylor2<double>(y, dy, 0.0));
    CHECK(same_bits(taylor.v, value));
    CHECK(close(taylor.d, exact.d[0] * Real(dx) + exact.d[1] * Real(dy), 1e-12));

    using Inner = Dual<2, Real>;
    using Second = Dual<2, Inner>;
    Second x2(Inner::variable(x, 0)), y2(Inner::variable(y, 1));
    x2.d[0] = Inner(1.0L);
    y2.d[1] = Inner(1.0L);
    const Second hessian = f(x2, y2);
    const Real curvature = hessian.d[0].d[0] * Real(dx) * Real(dx) +
                           2 * hessian.d[0].d[1] * Real(dx) * Real(dy) +
                           hessian.d[1].d[1] * Real(dy) * Real(dy);
    CHECK(hessian.d[0].d[1] == Approx(hessian.d[1].d[0]).margin(1e-12));
    CHECK(close(taylor.dd, curvature, 1e-11));

    const auto along = f(Taylor2<Dual<2>>(Dual<2>::variable(x, 0), Dual<2>(dx), Dual<2>()),
                         Taylor2<Dual<2>>(Dual<2>::variable(y, 1), Dual<2>(dy), Dual<2>()));
    CHECK(close(along.dd.v, curvature, 1e-11));
    CHECK(close(along.v.d[1], exact.d[1], 1e-12));
    CHECK(close(along.d.d[0], hessian.d[0].d[0] * Real(dx) + hessian.d[0].d[1] * Real(dy), 1e-11));
  }
}

TEST_CASE("each lane of a pack has the bits of the result for a double") {
  for (unsigned seed = 0; seed < 200; ++seed) {
    const RandomFormula f(seed, 10);
    std::mt19937 generator(seed + 1000);
    std::uniform_real_distribution<double> range(-2, 2);
    Pack x, y;
    for (int i = 0; i < Pack::kLanes; ++i) {
      x.set(i, range(generator));
      y.set(i, range(generator));
    }
    const Pack value = f(x, y);
    const auto dual = f(Dual<2, Pack>::variable(x, 0), Dual<2, Pack>::variable(y, 1));
    const auto taylor = f(Taylor2<Pack>(x, Pack(0.6), Pack(0.0)), Taylor2<Pack>(y, Pack(-1.1), Pack(0.0)));
    for (int i = 0; i < Pack::kLanes; ++i) {
      INFO("seed " << seed << " lane " << i);
      CHECK(same_bits(value[i], f(x[i], y[i])));
      const auto d = f(Dual<2>::variable(x[i], 0), Dual<2>::variable(y[i], 1));
      const auto t = f(Taylor2<double>(x[i], 0.6, 0.0), Taylor2<double>(y[i], -1.1, 0.0));
      CHECK(same_bits(dual.v[i], d.v));
      CHECK(same_bits(dual.d[0][i], d.d[0]));
      CHECK(same_bits(dual.d[1][i], d.d[1]));
      CHECK(same_bits(taylor.v[i], t.v));
      CHECK(same_bits(taylor.d[i], t.d));
      CHECK(same_bits(taylor.dd[i], t.dd));
    }
  }
}

TEST_CASE("sine, cosine and exponential are within a unit in the last place, in every lane") {
  std::mt19937 generator(5);
  double worst_sine = 0, worst_cosine = 0, worst_exp = 0;
  const auto ulp_error = [](double x, Real exact) {  // error in units in the last place
    const double nearest = static_cast<double>(exact);
    const double unit = std::nextafter(std::abs(nearest), HUGE_VAL) - std::abs(nearest);
    return static_cast<double>(std::abs(Real(x) - exact) / unit);
  };
  for (const double most : {1e-5, 0.5, 1.0, 7.0, 700.0, 1e6}) {
    std::uniform_real_distribution<double> range(-most, most), exponents(-745, 709);
    for (int trial = 0; trial < 20000; ++trial) {
      Pack x, y;
      for (int i = 0; i < Pack::kLanes; ++i) {
        x.set(i, range(generator));
        y.set(i, most < 2 ? range(generator) : exponents(generator));
      }
      const auto [s, c] = math::sin_cos(x);
      const Pack e = math::exp(y);
      for (int i = 0; i < Pack::kLanes; ++i) {
        worst_sine = std::max(worst_sine, ulp_error(s[i], std::sin(Real(x[i]))));
        worst_cosine = std::max(worst_cosine, ulp_error(c[i], std::cos(Real(x[i]))));
        worst_exp = std::max(worst_exp, ulp_error(e[i], std::exp(Real(y[i]))));
        if (trial % 16 != 0) continue;
        CHECK((same_bits(s[i], math::sin(x[i])) && same_bits(c[i], math::cos(x[i]))));
        CHECK(same_bits(e[i], math::exp(y[i])));
      }
    }
  }
  CHECK(worst_sine < 1);
  CHECK(worst_cosine < 1);
  CHECK(worst_exp < 1);
  // The doubles nearest to multiples of pi/2.
  for (int k = -2000; k <= 2000; ++k) {
    const double x = static_cast<double>(k * 1.57079632679489661923L);
    CHECK(ulp_error(math::sin(x), std::sin(Real(x))) < 1);
    CHECK(ulp_error(math::cos(x), std::cos(Real(x))) < 1);
  }
}

TEST_CASE("sine, cosine and exponential at the limits of the number range") {
  CHECK((math::sin(0.0) == 0 && math::cos(0.0) == 1 && math::exp(0.0) == 1));
  CHECK((math::exp(-1e6) == 0 && math::exp(-HUGE_VAL) == 0 && math::exp(-745.0) > 0));
  CHECK((std::isinf(math::exp(710.0)) && std::isinf(math::exp(HUGE_VAL)) && std::isfinite(math::exp(709.7))));
  CHECK(std::isnan(math::exp(std::nan(""))));
  const Pack x = [] {
    Pack lanes(0.5);
    lanes.set(1, std::nan(""));
    lanes.set(2, HUGE_VAL);
    lanes.set(3, 1e17);
    return lanes;
  }();
  const auto [s, c] = math::sin_cos(x);
  CHECK((same_bits(s[0], math::sin(0.5)) && same_bits(c[0], math::cos(0.5))));
  CHECK((std::isnan(s[1]) && std::isnan(c[2]) && s[3] == static_cast<double>(std::sin(1e17L))));
}

TEST_CASE("a pack sums its lanes and broadcasts") {
  Pack p(2.5);
  CHECK(sum(p) == 10);
  p.set(2, -1);
  CHECK((p[0] == 2.5 && p[2] == -1));
  const Pack chosen = math::where_positive(p, Pack(1.0), Pack(7.0));
  CHECK((chosen[1] == 1 && chosen[2] == 7));
}

TEST_CASE("the unused branch of a selection has no effect") {
  const Taylor2<double> t(-1.0, 1.0, 0.0);
  const auto y = math::where_positive(t, log(t), Taylor2<double>(2.0));
  CHECK((y.v == 2 && y.d == 0 && y.dd == 0));
  const auto d = math::where_positive(Dual<1>(-1.0), log(Dual<1>::variable(-1.0, 0)), Dual<1>(2.0));
  CHECK((d.v == 2 && d.d[0] == 0));
}

TEST_CASE("signed powers have value and derivatives, also at zero") {
  for (const double x : {-1.0, -0.3, -1e-8, 5e-324, 1e-3, 0.5, 1.0}) {
    for (const double eps : {0.02, 0.3, 1.0, 1.9, 5.0}) {
      INFO("x " << x << " eps " << eps);
      const auto base = pliant::trig(x);
      const double expected = std::copysign(std::pow(std::abs(x), eps), x);
      const double log_abs = std::log(std::abs(x));
      CHECK(signed_power(base, eps) == Approx(expected).epsilon(1e-12).margin(1e-320));
      const auto d = signed_power(base, Dual<1>::variable(eps, 0));
      CHECK(d.d[0] == Approx(expected * log_abs).epsilon(1e-12).margin(1e-318));
      const auto t = signed_power(base, Taylor2<double>(eps, 2.0, 0.0));
      CHECK(t.dd == Approx(4 * expected * log_abs * log_abs).epsilon(1e-12).margin(1e-316));
    }
  }
  for (const double eps : {0.02, 1.0, 5.0}) {
    for (const double zero : {0.0, -0.0}) {
      const auto base = pliant::trig(zero);
      CHECK(signed_power(base, eps) == 0);
      const auto d = signed_power(base, Dual<1>::variable(eps, 0));
      CHECK((d.v == 0 && d.d[0] == 0));
      const auto t = signed_power(base, Taylor2<double>(eps, 1.0, 1.0));
      CHECK((t.v == 0 && t.d == 0 && t.dd == 0));
    }
  }
  CHECK(signed_power(pliant::trig(1.0), Dual<1>::variable(0.5, 0)).d[0] == 0);
}

}  // namespace scalars_test
