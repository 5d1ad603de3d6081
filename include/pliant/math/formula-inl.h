// Evaluation of the postfix program of a formula on second-order Taylor numbers.
#pragma once

#include <pliant/math/formula.h>

#include <array>
#include <cmath>

#include <pliant/math/header_only.h>

namespace pliant {

namespace detail::formula_program {

using Code = Formula::Code;
using Instruction = Formula::Instruction;
using Taylor = Taylor2<double>;

inline constexpr int kSmallStack = 16;
/// Each level of nesting adds at most five numbers to the stack: the left operands of a sum and of a product,
/// the base of a power, and two earlier arguments of a function.
inline constexpr int kLargeStack = 5 * (Formula::kMaxDepth + 2);

/// Returns the sign of x just after t: that of its value, or, if this is 0, that of the first derivative that
/// is not zero; 0 if all are zero.
inline double sign_ahead(const Taylor& x) {
  for (const double a : {x.v, x.d, x.dd}) {
    if (a != 0) return a > 0 ? 1 : -1;
  }
  return 0;
}

/// Returns f(a) from the value and the first and second derivative of f at a.v.
inline Taylor chain(const Taylor& a, double value, double slope, double curvature) {
  return {value, slope * a.d, curvature * a.d * a.d + slope * a.dd};
}

inline Taylor tan(const Taylor& a) {
  const double y = math::sin(a.v) / math::cos(a.v);
  const double slope = 1 + y * y;
  return chain(a, y, slope, 2 * y * slope);
}

/// Returns a^n for a constant exponent. If the factor n or n - 1 in a derivative of a^n is zero, this
/// derivative is 0 for every a.
inline Taylor power(const Taylor& a, double n) {
  const double slope = n == 0 ? 0 : n * std::pow(a.v, n - 1);
  const double curvature = n == 0 || n == 1 ? 0 : n * (n - 1) * std::pow(a.v, n - 2);
  return chain(a, std::pow(a.v, n), slope, curvature);
}

/// Returns a^b for a variable exponent. The derivatives contain log a, so they are not finite for a <= 0.
inline Taylor power(const Taylor& a, const Taylor& b) {
  const Taylor exponent = b * log(a);
  const double value = std::pow(a.v, b.v);
  return {value, value * exponent.d, value * (exponent.d * exponent.d + exponent.dd)};
}

/// Returns the argument that is larger just after t if sign is 1, or smaller if sign is -1; the first of two
/// equal ones; NaN if one of them is NaN.
inline Taylor choose(const Taylor& x, const Taylor& y, double sign) {
  const Taylor difference = x - y;
  if (std::isnan(difference.v)) return difference;
  return sign * sign_ahead(difference) >= 0 ? x : y;
}

/// Returns 0 for x < edge, 1 for x >= edge, NaN for NaN.
inline Taylor step(const Taylor& x, double edge) {
  if (x.v < edge) return 0.0;
  return x.v >= edge ? Taylor(1.0) : x;
}

/// Returns 0 up to a, 1 from b on, and between them the quintic whose first and second derivatives vanish at
/// both ends. With a = b the function is a step; with a > b it falls from 1 (up to b) to 0 (from a on).
inline Taylor smoothstep(const Taylor& a, const Taylor& b, const Taylor& x) {
  if (a.v == b.v) return step(x, a.v);
  const Taylor s = (x - a) / (b - a);
  if (s.v <= 0) return 0.0;
  if (s.v >= 1) return 1.0;
  return s * s * s * (10.0 + s * (-15.0 + 6.0 * s));
}

/// Returns the number of arguments of an operation.
inline int arguments(Code code) {
  switch (code) {
    case Code::kNumber:
    case Code::kTime:
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

/// Returns the result of one instruction on its arguments, x[0] the first.
inline Taylor apply(const Instruction& instruction, const Taylor& time, const Taylor* x) {
  switch (instruction.code) {
    case Code::kNumber:
      return instruction.number;
    case Code::kTime:
      return time;
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
      return power(x[0], x[1]);
    case Code::kConstantPower:
      return power(x[0], instruction.number);
    case Code::kSin:
      return sin(x[0]);
    case Code::kCos:
      return cos(x[0]);
    case Code::kTan:
      return tan(x[0]);
    case Code::kExp:
      return exp(x[0]);
    case Code::kLog:
      return log(x[0]);
    case Code::kSqrt:
      return sqrt(x[0]);
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
  return 0.0;
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

/// Evaluates a program at t with a stack of Size numbers. Before each instruction it calls see(instruction,
/// arguments).
template <int Size, class See>
Taylor run(const std::vector<Instruction>& program, double t, See&& see) {
  const Taylor time(t, 1.0, 0.0);
  std::array<Taylor, Size> stack;
  Taylor* top = stack.data();
  for (const Instruction& instruction : program) {
    top -= arguments(instruction.code);
    see(instruction, top);
    *top = apply(instruction, time, top);
    ++top;
  }
  return stack[0];
}

}  // namespace detail::formula_program

PLIANT_INLINE Taylor2<double> Formula::at(double t) const {
  auto unseen = [](const Instruction&, const Taylor2<double>*) {};
  return stack_ <= detail::formula_program::kSmallStack
             ? detail::formula_program::run<detail::formula_program::kSmallStack>(program_, t, unseen)
             : detail::formula_program::run<detail::formula_program::kLargeStack>(program_, t, unseen);
}

PLIANT_INLINE std::uint64_t Formula::branches(double t) const {
  constexpr std::uint64_t prime = 1099511628211U;  // of the hash FNV-1a
  std::uint64_t all = 14695981039346656037U;
  detail::formula_program::run<detail::formula_program::kLargeStack>(
      program_, t, [&](const Instruction& instruction, const Taylor2<double>* x) {
        if (detail::formula_program::has_branches(instruction.code))
          all = (all ^ (detail::formula_program::branch(instruction, x) ? 1U : 2U)) * prime;
      });
  return all;
}

PLIANT_INLINE bool Formula::is_constant() const {
  return program_.size() == 1 && program_[0].code == Code::kNumber;
}

}  // namespace pliant
