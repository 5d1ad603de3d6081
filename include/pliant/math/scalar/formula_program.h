// Evaluation of the postfix program of a formula on numbers, dual numbers and second-order Taylor numbers:
// the body of Formula::value().
#pragma once

#include <pliant/math/formula.h>

#include <array>
#include <cmath>

#include <pliant/math/scalar/dual.h>

namespace pliant {

namespace detail::formula_program {

using Code = Formula::Code;
using Instruction = Formula::Instruction;
using Taylor = Taylor2<double>;
using Dual1 = Dual<1, double>;

/// Size of the stack for most formulas; formulas that need more numbers use kLargeStack.
inline constexpr int kSmallStack = 16;
/// Each level of nesting adds at most five numbers to the stack: the left operands of a sum and of a product,
/// the base of a power, and two earlier arguments of a function.
inline constexpr int kLargeStack = 5 * (Formula::kMaxDepth + 2);

/// Returns the sign (-1, 0 or 1) of x just after t: the sign of the first nonzero number among the value, the
/// first and the second derivative of x; 0 if all three are zero.
inline double sign_ahead(const Taylor& x) {
  for (const double a : {x.v, x.d, x.dd}) {
    if (a != 0) return a > 0 ? 1 : -1;
  }
  return 0;
}

/// Returns the sign of x. These scalars have no derivative in t that could decide the sign just after t.
inline double sign_ahead(double x) {
  return x > 0 ? 1 : (x < 0 ? -1 : 0);
}
inline double sign_ahead(const Dual1& x) {
  return sign_ahead(x.v);
}

/// Returns f(a) from the value and the first and second derivative of f at a.
inline double chain(double /*a*/, double value, double /*slope*/, double /*curvature*/) {
  return value;
}
inline Dual1 chain(const Dual1& a, double value, double slope, double /*curvature*/) {
  return chain_rule(a, value, slope);
}
inline Taylor chain(const Taylor& a, double value, double slope, double curvature) {
  return chain_rule(a, value, slope, curvature);
}

template <class T>
T tan(const T& a) {
  const double x = plain(a), y = math::sin(x) / math::cos(x);
  const double slope = 1 + y * y;
  return chain(a, y, slope, 2 * y * slope);
}

/// Returns a^n for a constant exponent n. If a factor n or n - 1 of a derivative is zero, the derivative is 0
/// for every a (also for a = 0, where the power of a is infinite).
template <class T>
T power(const T& a, double n) {
  const double x = plain(a), slope = n == 0 ? 0 : n * std::pow(x, n - 1);
  const double curvature = n == 0 || n == 1 ? 0 : n * (n - 1) * std::pow(x, n - 2);
  return chain(a, std::pow(x, n), slope, curvature);
}

/// Returns a^b for a variable exponent. The derivatives contain log a, so they are not finite for a <= 0.
inline double variable_power(double a, double b) {
  return std::pow(a, b);
}
inline Dual1 variable_power(const Dual1& a, const Dual1& b) {
  const double value = std::pow(a.v, b.v);
  return chain_rule(Dual1(b * log(a)), value, value);
}
inline Taylor variable_power(const Taylor& a, const Taylor& b) {
  const Taylor exponent = b * log(a);
  const double value = std::pow(a.v, b.v);
  return {value, value * exponent.d, value * (exponent.d * exponent.d + exponent.dd)};
}

/// Returns the argument that is larger just after t if sign is 1, or smaller if sign is -1. Returns x if the
/// arguments are equal, and NaN if one of them is NaN.
template <class T>
T choose(const T& x, const T& y, double sign) {
  const T difference = x - y;
  if (std::isnan(plain(difference))) return difference;
  return sign * sign_ahead(difference) >= 0 ? x : y;
}

/// Returns 0 for x < edge, 1 for x >= edge, NaN for NaN.
template <class T>
T step(const T& x, double edge) {
  if (plain(x) < edge) return T(0.0);
  return plain(x) >= edge ? T(1.0) : x;
}

/// Returns 0 up to a, 1 from b on, and between them the quintic whose first and second derivatives vanish at
/// both ends. With a = b the function is a step; with a > b it falls from 1 (up to b) to 0 (from a on).
template <class T>
T smoothstep(const T& a, const T& b, const T& x) {
  if (plain(a) == plain(b)) return step(x, plain(a));
  const T s = (x - a) / (b - a);
  if (plain(s) <= 0) return T(0.0);
  if (plain(s) >= 1) return T(1.0);
  return s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
}

/// Returns the number of arguments of an operation.
inline int arguments(Code code) {
  switch (code) {
    case Code::kNumber:
    case Code::kTime:
    case Code::kVariable:
      return 0;
    case Code::kAdd:
    case Code::kSubtract:
    case Code::kMultiply:
    case Code::kDivide:
    case Code::kPower:
    case Code::kMin:
    case Code::kMax:
      return 2;
    case Code::kSmoothstep:
      return 3;
    default:
      return 1;
  }
}

/// Returns the result of one instruction for its arguments x[0], x[1], ... variables: the values of the named
/// quantities, in the order of their numbers.
template <class T>
T apply(const Instruction& instruction, const T& time, const T* variables, const T* x) {
  switch (instruction.code) {
    case Code::kNumber:
      return T(instruction.number);
    case Code::kTime:
      return time;
    case Code::kVariable:
      return variables[static_cast<std::size_t>(instruction.number)];
    case Code::kAdd:
      return x[0] + x[1];
    case Code::kSubtract:
      return x[0] - x[1];
    case Code::kMultiply:
      return x[0] * x[1];
    case Code::kDivide:
      return x[0] / x[1];
    case Code::kNegate:
      return -x[0];
    case Code::kPower:
      return variable_power(x[0], x[1]);
    case Code::kConstantPower:
      return power(x[0], instruction.number);
    case Code::kSin:
      return math::sin(x[0]);
    case Code::kCos:
      return math::cos(x[0]);
    case Code::kTan:
      return tan(x[0]);
    case Code::kExp:
      return math::exp(x[0]);
    case Code::kLog:
      return math::log(x[0]);
    case Code::kSqrt:
      return math::sqrt(x[0]);
    case Code::kAbs:
      return sign_ahead(x[0]) < 0 ? -x[0] : x[0];
    case Code::kMin:
      return choose(x[0], x[1], -1);
    case Code::kMax:
      return choose(x[0], x[1], 1);
    case Code::kStep:
      return step(x[0], 0);
    case Code::kSmoothstep:
      return smoothstep(x[0], x[1], x[2]);
  }
  return T(0.0);
}

inline bool has_branches(Code code) {
  return code == Code::kAbs || code == Code::kMin || code == Code::kMax || code == Code::kStep ||
         code == Code::kSmoothstep;
}

/// Returns which of its two branches (false, true) an instruction uses on its arguments x; false for an
/// instruction without branches. The branches of a smoothstep join smoothly, so a smoothstep has branches
/// only if it is a step (a = b).
inline bool branch(const Instruction& instruction, const Taylor* x) {
  switch (instruction.code) {
    case Code::kAbs:
      return sign_ahead(x[0]) < 0;
    case Code::kMin:
    case Code::kMax:
      return sign_ahead(x[0] - x[1]) < 0;
    case Code::kStep:
      return x[0].v < 0;
    case Code::kSmoothstep:
      return x[0].v == x[1].v && x[2].v < x[0].v;
    default:
      return false;
  }
}

/// Evaluates a program with a stack of Size numbers. Before each instruction it calls see(instruction,
/// arguments).
template <int Size, class T, class See>
T run(const std::vector<Instruction>& program, const T& time, const T* variables, See&& see) {
  std::array<T, Size> stack;
  T* top = stack.data();
  for (const Instruction& instruction : program) {
    top -= arguments(instruction.code);
    see(instruction, top);
    *top = apply(instruction, time, variables, top);
    ++top;
  }
  return stack[0];
}

}  // namespace detail::formula_program

template <class T>
T Formula::value(const T& time, const T* variables) const {
  auto unseen = [](const Instruction&, const T*) {};
  using namespace detail::formula_program;
  return stack_ <= kSmallStack ? run<kSmallStack>(program_, time, variables, unseen)
                               : run<kLargeStack>(program_, time, variables, unseen);
}

}  // namespace pliant
