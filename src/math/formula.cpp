// Parser of formulas (recursive descent). The evaluation is in formula_program.h.
#include <pliant/math/formula-inl.h>

#include <array>
#include <charconv>
#include <cmath>
#include <string_view>
#include <utility>

#include <pliant/math/nearest_name.h>

namespace pliant {

namespace {

using Code = Formula::Code;
using Instruction = Formula::Instruction;
using Taylor = Taylor2<double>;
using detail::formula_program::arguments;

/// A function of the formula language.
struct Entry {
  const char* name;
  Code code;
  const char* meaning;
};
constexpr Entry kFunctions[] = {
    {"sin", Code::kSin, "sine of an angle in radians"},
    {"cos", Code::kCos, "cosine of an angle in radians"},
    {"tan", Code::kTan, "tangent of an angle in radians"},
    {"exp", Code::kExp, "exponential"},
    {"log", Code::kLog, "natural logarithm"},
    {"sqrt", Code::kSqrt, "square root"},
    {"abs", Code::kAbs, "absolute value"},
    {"min", Code::kMin, "the smaller of two arguments"},
    {"max", Code::kMax, "the larger of two arguments"},
    {"step", Code::kStep, "step(x): 0 for x < 0, else 1"},
    {"smoothstep", Code::kSmoothstep,
     "smoothstep(a, b, x): 0 up to a, 1 from b on, and between them a quintic with continuous second "
     "derivative"},
};

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}
bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_';
}

/// Recursive descent: each function parses one rule of the grammar (formula.h) and appends its instructions.
class Parser {
 public:
  Parser(std::string_view text, const Formula::Names& names) : text_(text), names_(names) {}

  std::vector<Instruction> parse() {
    if (text_.size() > Formula::kMaxLength) {
      throw FormulaError(Formula::kMaxLength,
                         "the formula is longer than " + std::to_string(Formula::kMaxLength) + " characters");
    }
    sum();
    if (at_ < text_.size()) fault_after_operand();
    return std::move(program_);
  }

 private:
  /// Increments the level of nesting during the life of this object.
  struct Level {
    explicit Level(Parser* parser) : p(parser) {
      if (++p->depth_ > Formula::kMaxDepth + 1) {
        throw FormulaError(p->at_, "nested deeper than " + std::to_string(Formula::kMaxDepth) + " levels");
      }
    }
    ~Level() { --p->depth_; }
    Level(const Level&) = delete;
    Level& operator=(const Level&) = delete;
    Parser* p;
  };

  void sum() {
    product();
    for (;;) {
      const std::size_t place = at_;
      if (accept('+')) {
        product();
        emit({Code::kAdd, 0}, place);
      } else if (accept('-')) {
        product();
        emit({Code::kSubtract, 0}, place);
      } else {
        return;
      }
    }
  }

  void product() {
    unary();
    for (;;) {
      const std::size_t place = at_;
      if (next() == '*' && at_ + 1 < text_.size() && text_[at_ + 1] == '*') {
        throw FormulaError(at_, "unexpected \"**\"; a power is written ^");
      }
      if (accept('*')) {
        unary();
        emit({Code::kMultiply, 0}, place);
      } else if (accept('/')) {
        unary();
        emit({Code::kDivide, 0}, place);
      } else {
        return;
      }
    }
  }

  void unary() {
    const Level level(this);
    skip_spaces();
    const std::size_t place = at_;
    if (accept('-')) {
      unary();
      emit({Code::kNegate, 0}, place);
    } else if (accept('+')) {
      unary();
    } else {
      primary();
      const std::size_t operation = at_;
      if (accept('^')) {
        unary();
        emit_power(operation);
      }
    }
    skip_spaces();
  }

  void primary() {
    const char c = next();
    if (is_digit(c) || c == '.') {
      number();
    } else if (is_letter(c) || (c == '\'' && names_)) {
      name();
    } else if (accept('(')) {
      const std::size_t opening = at_ - 1;
      sum();
      close(opening);
    } else {
      fault_expected(names_ ? "a number, t, pi, a quantity, a function or \"(\""
                            : "a number, t, pi, a function or \"(\"");
    }
    skip_spaces();
  }

  void number() {
    const char* first = text_.data() + at_;
    double value = 0;
    const auto [last, error] = std::from_chars(first, text_.data() + text_.size(), value);
    if (error == std::errc::invalid_argument) fault_expected("a number");
    if (error == std::errc::result_out_of_range) {
      throw FormulaError(at_, "the number " + std::string(first, last) + " is outside the range of a double");
    }
    emit({Code::kNumber, value}, at_);
    at_ += static_cast<std::size_t>(last - first);
  }

  void name() {
    const std::size_t begin = at_;
    const bool quoted = text_[at_] == '\'';
    const std::string word = quoted ? quoted_word() : plain_word();
    const std::string quantity = names_ ? after_dot() : std::string();
    if (quoted || !quantity.empty()) {
      if (!variable(word, quantity, begin)) throw FormulaError(begin, "unknown name \"" + word + "\"");
      return;
    }
    const bool call = next() == '(';
    if (word == "t" || word == "pi") {
      if (call) throw FormulaError(begin, "\"" + word + "\" is not a function; write " + word + "*(...)");
      emit(word == "t" ? Instruction{Code::kTime, 0} : Instruction{Code::kNumber, kPi}, begin);
      return;
    }
    for (const Entry& entry : kFunctions) {
      if (word == entry.name) {
        if (!call) throw FormulaError(at_, "expected \"(\" after \"" + word + "\"" + found_instead());
        return arguments_of(entry, begin);
      }
    }
    if (!call && names_ && variable(word, quantity, begin)) return;
    std::vector<std::string> names;
    if (!call) names = {"t", "pi"};
    for (const Entry& entry : kFunctions) names.emplace_back(entry.name);
    const std::string hint = did_you_mean(word, names);
    std::string known;
    for (const std::string& n : names) known += (known.empty() ? "" : ", ") + n;
    throw FormulaError(begin, std::string(call ? "unknown function \"" : "unknown name \"") + word + "\"" +
                                  (hint.empty() ? "; expected one of " + known : hint));
  }

  std::string plain_word() {
    const std::size_t begin = at_;
    while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) ++at_;
    return std::string(text_.substr(begin, at_ - begin));
  }
  /// Reads the text between two apostrophes.
  std::string quoted_word() {
    const std::size_t end = text_.find('\'', at_ + 1);
    if (end == std::string_view::npos)
      throw FormulaError(text_.size(),
                         "expected \"'\" for the \"'\" at character " + std::to_string(at_ + 1));
    const std::string word(text_.substr(at_ + 1, end - at_ - 1));
    at_ = end + 1;
    return word;
  }
  /// Reads a dot and the words with dots after it. Returns these words; empty if there is no dot.
  std::string after_dot() {
    std::string words;
    while (at_ + 1 < text_.size() && text_[at_] == '.' && is_letter(text_[at_ + 1])) {
      ++at_;
      words += (words.empty() ? "" : ".") + plain_word();
    }
    return words;
  }
  /// Appends the instruction of a named quantity. Returns false if its name is unknown. place: the byte of
  /// the text at which the name begins.
  bool variable(const std::string& owner, const std::string& quantity, std::size_t place) {
    int number = 0;
    try {
      number = names_(owner, quantity);
    } catch (const std::invalid_argument& fault) {
      throw FormulaError(place, fault.what());
    }
    if (number < 0) return false;
    emit({Code::kVariable, static_cast<double>(number)}, place);
    return true;
  }

  void arguments_of(const Entry& entry, std::size_t place) {
    const std::size_t opening = at_;
    accept('(');
    const int wanted = arguments(entry.code);
    for (int i = 0; i < wanted; ++i) {
      if (i > 0 && !accept(',')) {
        if (next() == ')') throw FormulaError(at_, expects(entry) + ", found " + std::to_string(i));
        fault_expected("\",\" before the next argument of \"" + std::string(entry.name) + "\"");
      }
      sum();
    }
    if (next() == ',') throw FormulaError(at_, expects(entry) + ", found more");
    close(opening);
    emit({entry.code, 0}, place);
  }

  static std::string expects(const Entry& entry) {
    const int n = arguments(entry.code);
    return "\"" + std::string(entry.name) + "\" takes " + std::to_string(n) +
           (n == 1 ? " argument" : " arguments");
  }

  void close(std::size_t opening) {
    if (accept(')')) return;
    if (at_ >= text_.size()) {
      throw FormulaError(at_, "expected \")\" for the \"(\" at character " + std::to_string(opening + 1));
    }
    fault_after_operand();
  }

  /// Appends an instruction. If all its arguments are numbers, replaces them by the result; throws
  /// FormulaError if the result is not finite. place: the byte of the text that an error reports.
  void emit(const Instruction& instruction, std::size_t place) {
    const std::size_t n = static_cast<std::size_t>(arguments(instruction.code));
    bool constant = n > 0;
    for (std::size_t i = 0; i < n; ++i) constant = constant && from_top(i).code == Code::kNumber;
    if (!constant) {
      program_.push_back(instruction);
      return;
    }
    std::array<Taylor, 3> x;
    for (std::size_t i = 0; i < n; ++i) x[n - 1 - i] = from_top(i).number;
    const double value = detail::formula_program::apply<Taylor>(instruction, Taylor(), nullptr, x.data()).v;
    if (!std::isfinite(value)) throw FormulaError(place, "the value here is not a finite number");
    program_.resize(program_.size() - n);
    program_.push_back({Code::kNumber, value});
  }

  void emit_power(std::size_t place) {
    const Instruction exponent = from_top(0);
    if (exponent.code != Code::kNumber) return emit({Code::kPower, 0}, place);
    program_.pop_back();
    emit({Code::kConstantPower, exponent.number}, place);
  }

  const Instruction& from_top(std::size_t i) const { return program_[program_.size() - 1 - i]; }

  void skip_spaces() {
    while (at_ < text_.size() &&
           (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n' || text_[at_] == '\r')) {
      ++at_;
    }
  }
  /// Returns the next character that is not a space; 0 at the end.
  char next() {
    skip_spaces();
    return at_ < text_.size() ? text_[at_] : '\0';
  }
  bool accept(char c) {
    if (next() != c || at_ >= text_.size()) return false;
    ++at_;
    return true;
  }

  std::string found_instead() {
    next();
    if (at_ >= text_.size()) return ", but the formula ends here";
    std::size_t length = 1;  // bytes of one UTF-8 character
    while (at_ + length < text_.size() && (static_cast<unsigned char>(text_[at_ + length]) & 0xC0) == 0x80)
      ++length;
    return ", found \"" + std::string(text_.substr(at_, length)) + "\"";
  }
  [[noreturn]] void fault_expected(const std::string& what) {
    const std::string found = found_instead();
    throw FormulaError(at_, "expected " + what + found);
  }
  [[noreturn]] void fault_after_operand() {
    const char c = next();
    const bool product = is_letter(c) || is_digit(c) || c == '(';
    const std::string found = found_instead();
    if (c == ')' && depth_ == 0) throw FormulaError(at_, "\")\" without its \"(\"");
    throw FormulaError(at_, std::string("expected an operator ") + (depth_ > 0 ? "or \")\"" : "or the end") +
                                found + (product ? "; a product is written with *" : ""));
  }

  std::string_view text_;
  const Formula::Names& names_;
  std::size_t at_ = 0;
  int depth_ = 0;
  std::vector<Instruction> program_;
};

}  // namespace

FormulaError::FormulaError(std::size_t offset, const std::string& reason)
    : std::runtime_error("at character " + std::to_string(offset + 1) + ": " + reason),
      offset_(offset),
      reason_(reason) {}

const std::vector<Formula::Function>& Formula::functions() {
  static const std::vector<Function> list = [] {
    std::vector<Function> all;
    for (const Entry& entry : kFunctions) all.push_back({entry.name, arguments(entry.code), entry.meaning});
    return all;
  }();
  return list;
}

Formula::Formula(const std::string& text, const Names& names) : program_(Parser(text, names).parse()) {
  int height = 0;
  for (const Instruction& instruction : program_) {
    height += 1 - arguments(instruction.code);
    stack_ = std::max(stack_, height);
    has_variables_ = has_variables_ || instruction.code == Code::kVariable;
    has_branches_ = has_branches_ || detail::formula_program::has_branches(instruction.code);
  }
  if (stack_ > detail::formula_program::kLargeStack)
    throw std::logic_error("a formula needs a larger stack than the limit of nesting allows");
}
}  // namespace pliant
