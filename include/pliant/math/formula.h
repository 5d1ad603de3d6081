// Formulas of time in scenes, "0.2*sin(2*pi*t)": a text becomes a flat program in postfix order, which runs
// on second-order Taylor numbers, so that value, rate and second derivative are exact.
//
//   sum     = product { ("+" | "-") product }          numbers  1  .5  2.5e-3
//   product = unary { ("*" | "/") unary }              names    t  pi
//   unary   = ("-" | "+") unary | power                functions: Formula::functions()
//   power   = primary [ "^" unary ]                    -2^2 = -4, 2^3^2 = 2^9, 2^-1 = 0.5
//   primary = number | name | function "(" sum { "," sum } ")" | "(" sum ")"
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/math/scalar/taylor2.h>

namespace pliant {

/// A fault in the text of a formula: where, and what was expected there.
class FormulaError : public std::runtime_error {
 public:
  /// `reason` reads on its own: what is wrong, what was expected, the nearest name.
  FormulaError(std::size_t offset, const std::string& reason);

  /// Byte of the text at which the fault was found, from 0; the length of the text where it ends too early.
  std::size_t offset() const { return offset_; }
  /// The fault without its place; what() says "at character N: reason".
  const std::string& reason() const { return reason_; }

 private:
  std::size_t offset_;
  std::string reason_;
};

/// A formula of one variable, t. Parts without t are computed once, when the text is read.
class Formula {
 public:
  static constexpr std::size_t kMaxLength = 4096;  ///< bytes of text
  static constexpr int kMaxDepth = 64;             ///< nesting of parentheses, calls, signs and powers

  struct Function {
    std::string name;
    int arguments;
    std::string meaning;
  };
  /// What a formula may call.
  static const std::vector<Function>& functions();

  /// Throws FormulaError when the text is not a formula, is too long or too deep, or when a part without t
  /// has no finite value, as in 1/0.
  explicit Formula(const std::string& text);

  /// Value, first and second derivative in t. At a kink (abs, min, max, step, the ends of smoothstep) the
  /// derivatives are those towards larger t. Not finite where the formula is not, as 1/t at 0: that is left
  /// to the caller.
  Taylor2<double> at(double t) const;

  /// No t in it.
  bool is_constant() const;
  /// Whether abs, min, max or steps are in it, and a number that tells which of their branches are taken at
  /// t.
  bool has_branches() const { return has_branches_; }
  std::uint64_t branches(double t) const;

  enum class Code : std::uint8_t {
    kNumber,
    kTime,
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kNegate,
    kPower,          ///< both sides vary
    kConstantPower,  ///< the exponent is the instruction's number
    kSin,
    kCos,
    kTan,
    kExp,
    kLog,
    kSqrt,
    kAbs,
    kMin,
    kMax,
    kStep,
    kSmoothstep
  };
  struct Instruction {
    Code code;
    double number;
  };

 private:
  std::vector<Instruction> program_;
  int stack_ = 0;  ///< most numbers the program holds at a time
  bool has_branches_ = false;
};

}  // namespace pliant
