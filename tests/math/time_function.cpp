// Functions of time: splines through key frames and formulas.
#include <pliant/math/time_function.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <vector>

#include <pliant/math/formula.h>
#include <pliant/math/time/linear_keys.h>
#include <pliant/math/time/sum_of_functions.h>

#include "catch.h"

namespace time_function_test {

using pliant::TimeFunction;
using pliant::TimeVector;

namespace {

std::vector<double> random_times(int n, std::mt19937* generator) {
  std::uniform_real_distribution<double> gap(0.05, 1.0);
  std::vector<double> t{-1.0};
  while (static_cast<int>(t.size()) < n) t.push_back(t.back() + gap(*generator));
  return t;
}

/// Returns the message about key frames with times t and values y, or "no fault".
std::string fault(const std::vector<double>& t, const std::vector<double>& y) {
  try {
    TimeFunction::key_frames(t, y);
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "no fault";
}

}  // namespace

TEST_CASE("clamped key frames reproduce cubic polynomials") {
  std::mt19937 generator(1);
  const auto f = [](double t) { return 2 - t + 0.5 * t * t - 0.25 * t * t * t; };
  const auto df = [](double t) { return -1 + t - 0.75 * t * t; };
  const auto ddf = [](double t) { return 1 - 1.5 * t; };
  for (int n = 2; n < 20; ++n) {
    const std::vector<double> t = random_times(n, &generator);
    std::vector<double> y;
    for (const double x : t) y.push_back(f(x));
    const TimeFunction spline = TimeFunction::key_frames(t, y, df(t.front()), df(t.back()));
    for (int i = 0; i <= 100; ++i) {
      const double x = std::min(t.front() + (t.back() - t.front()) * i / 100, t.back());
      const auto at = spline.at(x);
      const double scale = 1 + std::abs(f(t.back()));
      CHECK(std::abs(at.v - f(x)) < 2e-14 * scale);
      CHECK(std::abs(at.d - df(x)) < 5e-13 * scale);
      CHECK(std::abs(at.dd - ddf(x)) < 2e-11 * scale);
    }
  }
}

TEST_CASE("linear key frames are straight lines with a kink at every key") {
  const std::vector<double> t{0, 0.5, 2, 3}, y{1, 3, 3, -1};
  const TimeFunction lines = pliant::linear_key_frames(t, y);
  for (std::size_t i = 0; i + 1 < t.size(); ++i) {
    const double rate = (y[i + 1] - y[i]) / (t[i + 1] - t[i]);
    CHECK(lines.at(t[i]).v == y[i]);
    CHECK(lines.at(t[i]).d == rate);  // at a key the rate is the rate after the key
    const auto middle = lines.at(0.5 * (t[i] + t[i + 1]));
    CHECK(middle.v == Approx(0.5 * (y[i] + y[i + 1])));
    CHECK(middle.d == rate);
    CHECK(middle.dd == 0);
    CHECK(lines.first_kink(t[i], 10).time == t[i + 1]);
  }
  CHECK(lines.value(-1) == 1);
  CHECK(lines.value(5) == -1);
  CHECK(lines.at(3).d == 0);
  CHECK(lines.value(1.3) == 3);  // equal values are kept exactly
  CHECK_FALSE(std::isfinite(lines.first_kink(3, 10).time));
  CHECK_FALSE(lines.first_kink(-1, 10).jumps);
  CHECK_THROWS_WITH(pliant::linear_key_frames({0, 0}, {1, 2}), pliant::test::has_text("times must increase"));
  CHECK_THROWS_WITH(pliant::linear_key_frames({}, {}), pliant::test::has_text("no key"));

  pliant::LinearKeys growing({0}, {1});
  CHECK(growing.at(2).v == 1);
  growing.append(1, 2);
  CHECK(growing.at(0.5).v == 1.5);
  CHECK(growing.at(0.5).d == 1);
  growing.restart(0, 7);
  CHECK(growing.at(0.5).v == 7);
}

TEST_CASE("a sum of functions of time has the values and the kinks of both") {
  const TimeFunction lines = pliant::linear_key_frames({1, 2}, {3, 7}),
                     formula = TimeFunction::formula("t^2"), sum = lines + formula;
  for (const double t : {0.5, 1.25, 3.0}) {
    CHECK(sum.at(t).v == lines.at(t).v + formula.at(t).v);
    CHECK(sum.at(t).d == lines.at(t).d + formula.at(t).d);
    CHECK(sum.at(t).dd == lines.at(t).dd + formula.at(t).dd);
  }
  CHECK(sum.first_kink(0, 5).time == 1);
  CHECK((formula + lines).first_kink(1, 5).time == 2);
  CHECK((TimeFunction(1) + TimeFunction(2)).is_constant());
  CHECK((TimeFunction(1) + TimeFunction(2)).first_value() == 3);
  CHECK_FALSE(sum.is_constant());
}

TEST_CASE("the first value of a function of time is its value at time 0") {
  CHECK(TimeFunction(2).first_value() == 2);
  CHECK(TimeFunction::formula("3 + t").first_value() == 3);
  CHECK(TimeFunction::key_frames({0, 1, 2}, {1, 5, 2}).first_value() == 1);
  const auto growing = std::make_shared<pliant::LinearKeys>(std::vector<double>{0}, std::vector<double>{4});
  const TimeFunction function(growing);
  growing->append(1, 9);
  CHECK(function.first_value() == 4);
  CHECK(function.first_value() == function.value(0));
}

TEST_CASE("key frames are interpolated, and the spline is twice continuously differentiable inside") {
  std::mt19937 generator(2);
  std::uniform_real_distribution<double> height(-1, 1);
  const std::vector<double> t = random_times(12, &generator);
  std::vector<double> y;
  for (std::size_t i = 0; i < t.size(); ++i) y.push_back(height(generator));
  for (const TimeFunction& spline :
       {TimeFunction::key_frames(t, y), TimeFunction::key_frames(t, y, 0.3, -0.7)}) {
    CHECK_FALSE(spline.is_constant());
    for (std::size_t i = 0; i < t.size(); ++i)
      CHECK(spline.value(t[i]) == Approx(y[i]).epsilon(1e-15).margin(1e-15));
    for (std::size_t i = 1; i + 1 < t.size(); ++i) {
      const double below = std::nextafter(t[i], -10.0);
      const auto left = spline.at(below), right = spline.at(t[i]);
      CHECK(left.v == Approx(right.v).margin(1e-13));
      CHECK(left.d == Approx(right.d).margin(1e-11));
      CHECK(left.dd == Approx(right.dd).margin(1e-9));
    }
    for (double x = t.front() + 0.01; x < t.back() - 0.01; x += 0.017) {
      const double h = 1e-6;
      const auto at = spline.at(x);
      CHECK(at.d == Approx((spline.value(x + h) - spline.value(x - h)) / (2 * h)).margin(1e-7).epsilon(1e-7));
      CHECK(at.dd == Approx((spline.at(x + h).d - spline.at(x - h).d) / (2 * h)).margin(1e-3).epsilon(1e-4));
    }
  }
  const TimeFunction natural = TimeFunction::key_frames(t, y);
  CHECK(natural.at(t.front()).dd == 0);
  CHECK(natural.at(t.back()).dd == Approx(0).margin(1e-12));
  const TimeFunction clamped = TimeFunction::key_frames(t, y, 0.3, -0.7);
  CHECK(clamped.at(t.front()).d == Approx(0.3).epsilon(1e-13));
  CHECK(clamped.at(t.back()).d == Approx(-0.7).epsilon(1e-13));
}

TEST_CASE("key frames of a sine converge at fourth order") {
  const auto worst = [](int n) {
    std::vector<double> t, y;
    for (int i = 0; i <= n; ++i) {
      t.push_back(2.0 * i / n);
      y.push_back(std::sin(t.back()));
    }
    const TimeFunction spline = TimeFunction::key_frames(t, y, 1.0, std::cos(2.0));
    double error = 0;
    for (int i = 0; i <= 1000; ++i) {
      const double x = 2.0 * i / 1000;
      error = std::max(error, std::abs(spline.value(x) - std::sin(x)));
    }
    return error;
  };
  CHECK(std::log2(worst(20) / worst(40)) > 3.9);
}

TEST_CASE("a spline has constant end values outside its key frames") {
  const TimeFunction spline = TimeFunction::key_frames({0, 1, 3}, {2, 5, 4});
  for (const double t : {-1e300, -1.0, -1e-9}) {
    CHECK(spline.at(t).v == 2);
    CHECK(spline.at(t).d == 0);
    CHECK(spline.at(t).dd == 0);
  }
  for (const double t : {3.0 + 1e-9, 4.0, 1e300}) {
    CHECK(spline.at(t).v == 4);
    CHECK(spline.at(t).d == 0);
  }
  CHECK(TimeFunction::key_frames({5}, {7}).is_constant());
  CHECK(TimeFunction::key_frames({5}, {7}, 1, 1).value(0) == 7);
  const TimeFunction line = TimeFunction::key_frames({1, 3}, {2, 6});
  CHECK(line.at(2).v == Approx(4));
  CHECK(line.at(2).d == Approx(2));
  CHECK(line.at(2).dd == 0);
}

TEST_CASE("invalid key frames are refused") {
  const double inf = std::numeric_limits<double>::infinity();
  CHECK(fault({}, {}) == "key frames: there is no key");
  CHECK(fault({0, 1}, {1}) == "key frames: 2 times, but 1 values");
  CHECK(fault({0, 1, 1}, {0, 0, 0}) ==
        "key frames: key 2 is not later than the key before it; times must increase");
  CHECK(fault({0, inf}, {0, 0}) == "key frames: key 1 has a time that is not finite");
  CHECK(fault({0, std::nan("")}, {0, 0}) == "key frames: key 1 has a time that is not finite");
  CHECK(fault({0, 1}, {0, std::nan("")}) == "key frames: key 1 has a value that is not finite");
  CHECK_THROWS_AS(TimeFunction::key_frames({0, 1}, {0, 1}, inf, 0), std::invalid_argument);
}

TEST_CASE("formulas are functions of time") {
  const TimeFunction f = TimeFunction::formula("2*t^2");
  CHECK_FALSE(f.is_constant());
  CHECK(f.at(3).v == 18);
  CHECK(f.at(3).d == 12);
  CHECK(f.at(3).dd == 4);
  CHECK(TimeFunction::formula("3*2").is_constant());
  CHECK(TimeFunction::formula("3*2").value(1) == 6);
  CHECK_THROWS_AS(TimeFunction::formula("3*"), pliant::FormulaError);
  const TimeVector path(TimeFunction::formula("cos(t)"), TimeFunction::formula("sin(t)"), 1.5);
  CHECK_FALSE(path.is_constant());
  const auto at = path.at(0.5);
  CHECK(at[1].d == Approx(std::cos(0.5)));
  CHECK(at[2].v == 1.5);
  CHECK(TimeVector(pliant::Vec3<double>(1, 2, 3)).is_constant());
}

TEST_CASE("functions of time report the times at which their rate or their value jumps") {
  using pliant::Kink;
  auto times = [](const TimeFunction& f, bool jumps) {
    std::vector<double> all;
    for (int i = -50; i < 100; ++i)
      for (Kink kink = f.first_kink(0.1 * i, 0.1 * (i + 1)); std::isfinite(kink.time);
           kink = f.first_kink(kink.time, 0.1 * (i + 1))) {
        CHECK(kink.jumps == jumps);
        CHECK(std::abs(f.at(kink.time + 1e-14).d - f.at(kink.time - 1e-14).d) + (jumps ? 1 : 0) > 0.1);
        all.push_back(kink.time);
      }
    return all;
  };
  auto near = [](const std::vector<double>& all, const std::vector<double>& expected) {
    REQUIRE(all.size() == expected.size());
    for (std::size_t i = 0; i < all.size(); ++i)
      CHECK(std::abs(all[i] - expected[i]) <= 1e-15 * (1 + std::abs(expected[i])));
  };
  near(times(TimeFunction::key_frames({0.2, 0.8}, {0, 0.5}), false), {0.2, 0.8});
  near(times(TimeFunction::key_frames({0.2, 0.5, 0.8}, {0, 1, 0.5}, 0, 2), false), {0.8});
  near(times(TimeFunction::key_frames({0.2, 0.5, 0.8}, {0, 1, 0.5}, 0, 0), false), {});
  near(times(TimeFunction::key_frames({1, 2}, {3, 3}), false), {});
  near(times(TimeFunction::formula("abs(t - 0.55)"), false), {0.55});
  near(times(TimeFunction::formula("0.9 * sin(0.45 * max(t - 7.2, 0))"), false), {7.2});
  near(times(TimeFunction::formula("min(max(t - 1/3, 0), 1) + 3"), false), {1. / 3, 4. / 3});
  near(times(TimeFunction::formula("abs(sin(pi * (t + 0.05)))"), false),
       {-4.05, -3.05, -2.05, -1.05, -0.05, 0.95, 1.95, 2.95, 3.95, 4.95, 5.95, 6.95, 7.95, 8.95, 9.95});
  near(times(TimeFunction::formula("t * step(t - 0.33)"), true), {0.33});
  near(times(TimeFunction::formula("smoothstep(1, 1, t)"), true), {1});
  // Smooth functions have no kinks, even if they contain functions with kinks.
  for (const char* smooth :
       {"max(t - 7.2, 0)^2", "0.5 * (1 - cos(0.45 * max(t - 7.2, 0)))", "smoothstep(1, 2, t)", "sin(t) + t^3",
        "abs(t)^3", "max(sin(2 * pi * t), 0)^6", "5"})
    near(times(TimeFunction::formula(smooth), false), {});
  // A kink is later than the first time, and not later than the second.
  const TimeFunction keys = TimeFunction::key_frames({0.25, 0.75}, {0, 1});
  CHECK(keys.first_kink(0, 0.25).time == 0.25);
  CHECK(keys.first_kink(0.25, 1).time == 0.75);
  CHECK(keys.first_kink(0.75, 1).time == std::numeric_limits<double>::infinity());
  const Kink both =
      TimeVector(TimeFunction::formula("abs(t - 0.5)"), TimeFunction::formula("step(t - 0.5)"), keys)
          .first_kink(0.3, 1);
  CHECK(both.time == 0.5);
  CHECK(both.jumps);
}

}  // namespace time_function_test
