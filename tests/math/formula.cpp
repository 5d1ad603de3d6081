// Formulas: values, exact derivatives, precedence, and every error with its position.
#include <pliant/math/scalar/formula_program.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "catch.h"

namespace formula_test {

using pliant::Dual;
using pliant::Formula;
using pliant::FormulaError;
using pliant::Taylor2;
using Real = long double;

namespace {

double value(const std::string& text, double t = 0) {
  return Formula(text).at(t).v;
}

/// A formula, the function that it means, and the times at which both are compared.
struct Case {
  const char* text;
  std::function<Real(Real)> function;
  std::vector<double> times;
};

const Real kPi = 3.14159265358979323846264338327950288L;

const std::vector<Case>& cases() {
  static const std::vector<Case> list = {
      {"t", [](Real t) { return t; }, {-2, 0, 3.5}},
      {"3 - 2*t + t^2/4", [](Real t) { return 3 - 2 * t + t * t / 4; }, {-2, 0, 3.5}},
      {"0.2*sin(2*pi*t + 0.5)",
       [](Real t) { return 0.2L * std::sin(2 * kPi * t + 0.5L); },
       {-0.3, 0, 0.4, 7.1}},
      {"cos(t)^3", [](Real t) { return std::cos(t) * std::cos(t) * std::cos(t); }, {-2, 0, 2, 3}},
      {"tan(t/2)", [](Real t) { return std::tan(t / 2); }, {-1.5, 0, 0.7, 2}},
      {"exp(-t^2)", [](Real t) { return std::exp(-t * t); }, {-1.5, 0, 0.7, 2}},
      {"log(1 + t^2)", [](Real t) { return std::log(1 + t * t); }, {-1.5, 0, 0.7, 20}},
      {"sqrt(2 + sin(t))", [](Real t) { return std::sqrt(2 + std::sin(t)); }, {-1.5, 0, 0.7, 20}},
      {"(t - 4)^5", [](Real t) { return std::pow(t - 4, 5.0L); }, {-3, 0, 6}},
      {"t^-3", [](Real t) { return 1 / (t * t * t); }, {-3, -0.5, 2}},
      {"t^2.5", [](Real t) { return std::pow(t, 2.5L); }, {0.3, 1, 9}},
      {"(2 + t^2)^sin(t)", [](Real t) { return std::pow(2 + t * t, std::sin(t)); }, {-3, 0, 0.4}},
      {"2^t", [](Real t) { return std::pow(2.0L, t); }, {-3, 0, 9.5}},
      {"abs(t)*t", [](Real t) { return std::fabs(t) * t; }, {-3, 2}},
      {"min(t, t^2)", [](Real t) { return std::fmin(t, t * t); }, {-3, 0.5, 2}},
      {"max(sin(t), cos(t))", [](Real t) { return std::fmax(std::sin(t), std::cos(t)); }, {0.2, 1.5, 4.5}},
      {"step(t - 1)*(t - 1)^2", [](Real t) { return t < 1 ? 0 : (t - 1) * (t - 1); }, {0.5, 2}},
      {"smoothstep(1, 3, t)",
       [](Real t) {
         const Real s = std::fmin(std::fmax((t - 1) / 2, 0.0L), 1.0L);
         return s * s * s * (10 - 15 * s + 6 * s * s);
       },
       {0.5, 1.2, 2, 2.9, 3.5}},
      {"1/(1 + exp(-(t - 0.3)/0.1))",
       [](Real t) { return 1 / (1 + std::exp(-(t - Real(0.3)) / Real(0.1))); },
       {0, 0.3, 0.8}},
  };
  return list;
}

/// Computes the first and second derivative of f by fourth-order central differences in long double.
void differences(const std::function<Real(Real)>& f, Real t, Real* first, Real* second) {
  const Real h = 1.0L / 4096;
  const Real a = f(t - 2 * h), b = f(t - h), c = f(t), d = f(t + h), e = f(t + 2 * h);
  *first = (a - 8 * b + 8 * d - e) / (12 * h);
  *second = (-a + 16 * b - 30 * c + 16 * d - e) / (12 * h * h);
}

/// Returns the position of the error in an invalid formula, or npos.
std::size_t fault_offset(const std::string& text) {
  try {
    Formula formula(text);
  } catch (const FormulaError& e) {
    return e.offset();
  }
  return std::string::npos;
}

/// Returns the message about an invalid formula, or "no fault".
std::string fault(const std::string& text) {
  try {
    Formula formula(text);
  } catch (const FormulaError& e) {
    return e.what();
  }
  return "no fault";
}

}  // namespace

TEST_CASE("a formula returns its value, rate and second derivative") {
  for (const Case& c : cases()) {
    const Formula formula(c.text);
    CHECK_FALSE(formula.is_constant());
    for (const double t : c.times) {
      INFO(c.text << " at " << t);
      const auto y = formula.at(t);
      Real first = 0, second = 0;
      differences(c.function, t, &first, &second);
      const double exact = static_cast<double>(c.function(t));
      CHECK(std::abs(y.v - exact) <= 1e-15 * (4 * std::abs(exact) + 1));
      CHECK(y.d == Approx(static_cast<double>(first)).epsilon(1e-9).margin(1e-9));
      CHECK(y.dd == Approx(static_cast<double>(second)).epsilon(1e-7).margin(1e-7));
    }
  }
}

TEST_CASE("derivatives are exact, not finite differences") {
  const Formula wave("3*sin(2*t)");
  for (const double t : {-1.0, 0.25, 40.0}) {
    const auto y = wave.at(t);
    CHECK(y.d == Approx(6 * std::cos(2 * t)).epsilon(1e-15));
    CHECK(y.dd == Approx(-12 * std::sin(2 * t)).epsilon(1e-15));
  }
  const auto cube = Formula("t^3").at(-2);
  CHECK(cube.v == -8);
  CHECK(cube.d == 12);
  CHECK(cube.dd == -12);
  const auto square = Formula("t^2").at(0);
  CHECK((square.v == 0 && square.d == 0 && square.dd == 2));
  const auto none = Formula("t^0").at(0);
  CHECK((none.v == 1 && none.d == 0 && none.dd == 0));
}

TEST_CASE("precedence of signs and powers follows mathematics") {
  CHECK(value("-2^2") == -4);
  CHECK(value("(-2)^2") == 4);
  CHECK(value("2^3^2") == 512);
  CHECK(value("2^-1") == 0.5);
  CHECK(value("2^-2^2") == 1.0 / 16);
  CHECK(value("-t^2", 3) == -9);
  CHECK(value("--t", 3) == 3);
  CHECK(value("2*-t", 3) == -6);
  CHECK(value("1-2-3") == -4);
  CHECK(value("8/4/2") == 1);
  CHECK(value("8/4*2") == 4);
  CHECK(value("1+2*3^2") == 19);
  CHECK(value("+5") == 5);
  CHECK(value("\t 1 +\n2 ") == 3);
  CHECK(value(".5+2.+1e-3+1E2") == .5 + 2. + 1e-3 + 1e2);
  CHECK(value("pi") == std::acos(-1.0));
  CHECK(value("t^3", -1.5) == -3.375);
  CHECK(value("t^-3", -2) == -0.125);
}

TEST_CASE("subexpressions without t are evaluated once") {
  CHECK(Formula("2*pi*(1 + sqrt(4))^2").is_constant());
  CHECK(Formula("sin(0)").is_constant());
  const auto y = Formula("sqrt(0)*t + abs(0)").at(2);
  CHECK((y.v == 0 && y.d == 0 && y.dd == 0));
  CHECK(fault("1 + 1/(2 - 2)") == "at character 6: the value here is not a finite number");
  CHECK(fault("t*log(-1)") == "at character 3: the value here is not a finite number");
  CHECK(fault("(-8)^(1/3)") == "at character 5: the value here is not a finite number");
}

TEST_CASE("at a kink the derivatives are one-sided, towards later times") {
  CHECK(Formula("abs(t)").at(0).d == 1);
  CHECK(Formula("abs(-t)").at(0).d == 1);
  CHECK(Formula("abs(t^2)").at(0).dd == 2);
  CHECK(Formula("max(0, t)").at(0).d == 1);
  CHECK(Formula("max(t, 0)").at(0).d == 1);
  CHECK(Formula("min(0, t)").at(0).d == 0);
  CHECK(Formula("min(t, 0)").at(0).d == 0);
  CHECK(Formula("step(t)").at(0).v == 1);
  CHECK(Formula("step(t)").at(-1e-300).v == 0);
  CHECK(Formula("smoothstep(2, 2, t)").at(2).v == 1);
  CHECK(Formula("smoothstep(2, 2, t)").at(1.9).v == 0);
  CHECK(Formula("smoothstep(3, 1, t)").at(0).v == 1);
  CHECK(Formula("smoothstep(0, 1, t)").at(1e-9).dd == Approx(6e-8).epsilon(1e-6));
}

TEST_CASE("values that are not finite are never replaced by finite ones") {
  CHECK(std::isinf(value("1/t", 0)));
  CHECK(std::isnan(value("log(t)", -1)));
  for (const char* text :
       {"max(log(t), 0)", "max(0, log(t))", "min(log(t), 0)", "min(0, log(t))", "step(log(t))",
        "smoothstep(0, 1, log(t))", "smoothstep(0, 0, log(t))", "abs(log(t))", "t^t"}) {
    INFO(text);
    CHECK(std::isnan(value(text, -0.5)));
  }
}

TEST_CASE("errors name the position, the expectation and the nearest name") {
  CHECK(fault("") ==
        "at character 1: expected a number, t, pi, a function or \"(\", but the formula ends here");
  CHECK(fault("2*") ==
        "at character 3: expected a number, t, pi, a function or \"(\", but the formula ends here");
  CHECK(fault("sine(t)") == "at character 1: unknown function \"sine\"; did you mean \"sin\"?");
  CHECK(fault("2 + x") == "at character 5: unknown name \"x\"; did you mean \"t\"?");
  CHECK(fault("omega*t") ==
        "at character 1: unknown name \"omega\"; expected one of t, pi, sin, cos, tan, exp, log, sqrt, abs, "
        "min, max, "
        "step, smoothstep");
  CHECK(fault("2t") ==
        "at character 2: expected an operator or the end, found \"t\"; a product is written with *");
  CHECK(fault("(1 + t") == "at character 7: expected \")\" for the \"(\" at character 1");
  CHECK(fault("1 + t)") == "at character 6: \")\" without its \"(\"");
  CHECK(fault("t**2") == "at character 2: unexpected \"**\"; a power is written ^");
  CHECK(fault("sin t") == "at character 5: expected \"(\" after \"sin\", found \"t\"");
  CHECK(fault("min(t)") == "at character 6: \"min\" takes 2 arguments, found 1");
  CHECK(fault("sin(t, 1)") == "at character 6: \"sin\" takes 1 argument, found more");
  CHECK(fault("min(t 2)") ==
        "at character 7: expected \",\" before the next argument of \"min\", found \"2\"");
  CHECK(fault("t(2)") == "at character 1: \"t\" is not a function; write t*(...)");
  CHECK(fault("1e400*t") == "at character 1: the number 1e400 is outside the range of a double");
  CHECK(fault("1e-400*t") == "at character 1: the number 1e-400 is outside the range of a double");
  CHECK(fault("2 \xE2\x88\x92 t") ==
        "at character 3: expected an operator or the end, found \"\xE2\x88\x92\"");
  CHECK(fault("1,5*t") == "at character 2: expected an operator or the end, found \",\"");
  CHECK(fault("1 $ 2") == "at character 3: expected an operator or the end, found \"$\"");
  CHECK(fault(std::string("1 +\0 2", 6)).rfind("at character 4: expected a number", 0) == 0);
  CHECK(fault_offset("sin(2*t + ") == 10);
  CHECK(fault_offset(".") == 0);
}

TEST_CASE("nesting depth and length are bounded") {
  const auto nested = [](int n) { return std::string(n, '(') + "t" + std::string(n, ')'); };
  CHECK(value(nested(64), 2) == 2);
  CHECK(fault(nested(65)) == "at character 66: nested deeper than 64 levels");
  CHECK(fault_offset(nested(2000)) == 65);
  CHECK(fault_offset(std::string(4000, '-') + "t") == 65);
  CHECK(fault_offset(std::string(4000, '(')) == 65);
  std::string powers = "t", calls = "t";
  for (int i = 0; i < 1000; ++i) powers += "^1";
  CHECK(fault_offset(powers) < 200);
  for (int i = 0; i < 32; ++i) calls = "1+2*t^smoothstep(t,t," + calls + ")";
  CHECK(std::isfinite(value(calls, 0.5)));
  CHECK(fault_offset("1+2*t^smoothstep(t,t," + calls + ")") != std::string::npos);
  std::string sum = "t";
  while (sum.size() + 2 <= Formula::kMaxLength) sum += "+t";
  CHECK(value(sum, 1) == static_cast<double>((sum.size() + 1) / 2));
  CHECK(fault(sum + "+t") == "at character 4097: the formula is longer than 4096 characters");
}

TEST_CASE("every listed function can be called and has a meaning") {
  for (const Formula::Function& f : Formula::functions()) {
    INFO(f.name);
    std::string call = f.name + "(t";
    for (int i = 1; i < f.arguments; ++i) call += ", t";
    CHECK(fault(call + ")") == "no fault");
    CHECK_FALSE(f.meaning.empty());
  }
}

TEST_CASE("a formula reads named quantities, with exact derivatives on dual numbers") {
  std::vector<std::string> read;
  const Formula::Names names = [&](const std::string& owner, const std::string& quantity) {
    if (owner == "unknown") return -1;
    if (quantity == "none") throw std::invalid_argument("no such quantity");
    read.push_back(owner + ":" + quantity);
    return static_cast<int>(read.size()) - 1;
  };
  const Formula formula("sin(ball.x) * 'left wing'.bend.angle^2 + t * abs(height) + tan(t.x) ^ ball.x",
                        names);
  CHECK(read == std::vector<std::string>{"ball:x", "left wing:bend.angle", "height:", "t:x", "ball:x"});
  CHECK(formula.has_variables());
  CHECK_FALSE(Formula("sin(t)", names).has_variables());
  const std::vector<double> at{0.3, 1.2, -0.7, 0.4, 0.3}, along{0.5, -0.2, 0.1, 0.9, 0.5};
  const double t = 0.6;
  const double expected = std::sin(0.3) * 1.44 + 0.6 * 0.7 + std::pow(std::tan(0.4), 0.3);
  const double at_state = formula.value(t, at.data());
  CHECK(at_state == Approx(expected).epsilon(1e-15));
  std::vector<Dual<1>> dual;
  for (std::size_t i = 0; i < at.size(); ++i) {
    dual.emplace_back(at[i]);
    dual.back().d[0] = along[i];
  }
  const Dual<1> derivative = formula.value(Dual<1>(t), dual.data());
  CHECK(derivative.v == at_state);
  auto moved = [&](double e) {
    std::vector<double> x = at;
    for (std::size_t i = 0; i < x.size(); ++i) x[i] += e * along[i];
    return formula.value(t, x.data());
  };
  CHECK(derivative.d[0] == Approx((moved(1e-5) - moved(-1e-5)) / 2e-5).epsilon(1e-8));
  CHECK(
      formula.value<Taylor2<double>>({t, 1.0, 0.0}, std::vector<Taylor2<double>>(at.begin(), at.end()).data())
          .d == Approx(0.7));
  try {
    Formula("1 + ball.none", names);
    FAIL("the name is not reported");
  } catch (const FormulaError& fault) {
    CHECK(fault.offset() == 4);
    CHECK(fault.reason() == "no such quantity");
  }
  CHECK_THROWS_AS(Formula("unknown", names), FormulaError);
  CHECK_THROWS_AS(Formula("'ball.x", names), FormulaError);
  CHECK_THROWS_AS(Formula("ball.x"), FormulaError);
}

}  // namespace formula_test
