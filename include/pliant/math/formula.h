// Formulas in scenes, of time ("0.2*sin(2*pi*t)") and of named quantities ("-20*ball.z"). The parser turns
// the text into a flat program in postfix order. A formula of time is evaluated with second-order Taylor
// numbers, so value, rate and second derivative are exact. A formula of named quantities is evaluated with
// double, Dual<1> or Taylor2<double>.
//
//   sum     = product { ("+" | "-") product }          numbers  1  .5  2.5e-3
//   product = unary { ("*" | "/") unary }              names    t  pi
//   unary   = ("-" | "+") unary | power                functions: Formula::functions()
//   power   = primary [ "^" unary ]                    -2^2 = -4, 2^3^2 = 2^9, 2^-1 = 0.5
//   primary = number | name | quantity | function "(" sum { "," sum } ")" | "(" sum ")"
//   quantity = owner [ "." word { "." word } ]      owner: a word, or any text between two apostrophes
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <pliant/math/scalar/taylor2.h>

namespace pliant {

/// An error in the text of a formula: its place and its reason.
class FormulaError : public std::runtime_error {
 public:
  /// offset: byte of the text, from 0. reason: the error as a complete message. For an unknown name the
  /// message also contains the nearest known name.
  FormulaError(std::size_t offset, const std::string& reason);

  /// Returns the byte of the text at which the error was found, from 0. If the text ends too early, this is
  /// the length of the text.
  std::size_t offset() const { return offset_; }
  /// Returns the error without its place; what() returns "at character N: reason", N = offset() + 1.
  const std::string& reason() const { return reason_; }

 private:
  std::size_t offset_;
  std::string reason_;
};

/// A formula of t and of named quantities. Constant subexpressions are evaluated once, by the constructor.
class Formula {
 public:
  /// Returns the number of a named quantity, from 0, or -1 if the name is unknown and `quantity` is empty.
  /// owner: for example the name of a part. quantity: the text after the first dot; empty if there is no dot.
  /// Throws std::invalid_argument, with a complete message, if the owner has no such quantity.
  using Names = std::function<int(const std::string& owner, const std::string& quantity)>;

  static constexpr std::size_t kMaxLength = 4096;  ///< bytes of text
  static constexpr int kMaxDepth = 64;             ///< nesting of parentheses, calls, signs and powers

  /// A function of the formula language.
  struct Function {
    std::string name;
    int arguments;
    std::string meaning;
  };
  /// Returns the functions that a formula may call.
  static const std::vector<Function>& functions();

  /// Parses a text. names: the quantities besides t and pi; by default there are none. Throws FormulaError if
  /// the text is not a formula, if it is too long or nested too deeply, or if a constant subexpression has no
  /// finite value (1/0).
  explicit Formula(const std::string& text, const Names& names = {});

  /// Returns the value of the formula. time: t, s. variables: the values of the named quantities, in the
  /// order of their numbers. T is double, Dual<1> or Taylor2<double>. At a kink of abs, min, max or step, the
  /// derivatives are those of one branch. Defined in scalar/formula_program.h.
  template <class T>
  T value(const T& time, const T* variables) const;
  /// Returns whether the formula contains named quantities.
  bool has_variables() const { return has_variables_; }
  /// Returns whether the formula contains t.
  bool reads_time() const;

  /// For a formula without named quantities: returns the value and the first and second derivative with
  /// respect to t. At a kink of abs, min or max the derivatives are one-sided, towards larger t. At a jump of
  /// step, or of smoothstep(a, a, x), the derivatives are zero. The caller checks whether the result is
  /// finite (1/t at 0 is not).
  Taylor2<double> at(double t) const;

  /// Returns whether the formula is one number, without t and without named quantities.
  bool is_constant() const;
  /// Returns whether the formula contains abs, min, max, step or smoothstep.
  bool has_branches() const { return has_branches_; }
  /// Returns a hash of the branches that abs, min, max, step and smoothstep(a, a, x) use at t.
  std::uint64_t branches(double t) const;

  /// The operations of the postfix program.
  enum class Code : std::uint8_t {
    kNumber,
    kTime,
    kVariable,  ///< a named quantity; Instruction::number is its number
    kAdd,
    kSubtract,
    kMultiply,
    kDivide,
    kNegate,
    kPower,          ///< any base and an exponent that is not constant
    kConstantPower,  ///< any base and the constant exponent Instruction::number
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
    double number;  ///< the constant of kNumber, the exponent of kConstantPower, the number of kVariable
  };

 private:
  std::vector<Instruction> program_;
  int stack_ = 0;  ///< maximum depth of the stack during an evaluation
  bool has_branches_ = false, has_variables_ = false;
};

}  // namespace pliant
