#include <pliant/scene/time_value.h>

#include <pliant/math/formula.h>
#include <pliant/math/time/linear_keys.h>
#include <pliant/math/time/sum_of_functions.h>

#include "scene/json/json_write.h"

namespace pliant {

namespace schema {

namespace {

void check_formula(const JsonValue& value, const ReportAt& report) {
  try {
    Formula formula(value.string());
  } catch (const FormulaError& e) {
    report(value, e.reason(), e.offset());
  }
}

/// Checks a formula as check_formula() does, but accepts names. StateReader checks the names.
void check_state_formula(const JsonValue& value, const ReportAt& report) {
  try {
    Formula formula(value.string(), [](const std::string&, const std::string&) { return 0; });
  } catch (const FormulaError& e) {
    report(value, e.reason(), e.offset());
  }
}

/// Returns the rule for key frames: their times increase, and there are as many values as times. values: the
/// JSON key of the values.
Check key_rule(const char* values) {
  return [values](const JsonValue& frames, const ReportAt& report) {
    const JsonValue::Array& t = frames.find("t")->array();
    const JsonValue& y = *frames.find(values);
    for (std::size_t i = 1; i < t.size(); ++i) {
      if (t[i].number() > t[i - 1].number()) continue;
      report(t[i], "expected a time later than the one before it, " + shortest(t[i - 1].number()),
             kWholeValue);
    }
    if (y.array().size() != t.size()) {
      report(y, "expected one entry for each time, that is " + std::to_string(t.size()), kWholeValue);
    }
  };
}

Type times() {
  return array(number(unbounded(), "s"), 1).expecting("an array of one or more increasing numbers (s)");
}

Type formula() {
  return text(1).expecting("a formula of t in quotes").checked(check_formula);
}

Type state_formula() {
  return text(1).expecting("a formula of t and of named quantities in quotes").checked(check_state_formula);
}

Field interpolation() {
  return optional("interpolation",
                  choice({{"spline", "a twice continuously differentiable cubic spline"},
                          {"linear", "straight lines; the rate jumps at the key frames"}}),
                  "The curve between the key frames.", "\"spline\"");
}

bool is_linear(const JsonValue& frames) {
  const JsonValue* kind = frames.find("interpolation");
  return kind != nullptr && kind->string() == "linear";
}

Type key_frames() {
  const Check rule = [keys = key_rule("y")](const JsonValue& frames, const ReportAt& report) {
    keys(frames, report);
    const JsonValue* rates = frames.find("end_rates");
    if (rates != nullptr && is_linear(frames))
      report(*rates, "straight lines have no end rates; expected no \"end_rates\"", kWholeValue);
  };
  return record({"key_frames",
                 "Key frames: a curve through the values; constant before the first and after the last key "
                 "frame.",
                 {required("t", times(), "Times of the key frames, increasing.", "[0, 1, 2]"),
                  required("y", array(number(unbounded(), ""), 1),
                           "Values at these times, in the unit of the function.", "[0, 0.5, 0]"),
                  optional("end_rates", array(number(unbounded(), ""), 2, 2),
                           "Rates of change at the first and the last key frame; when absent, the second "
                           "derivative is zero there."),
                  interpolation()}})
      .checked(rule);
}

Type point_key_frames() {
  return record({"point_key_frames",
                 "Key frames of points: a curve through the points; constant before the first and after the "
                 "last key frame.",
                 {required("t", times(), "Times of the key frames, increasing.", "[0, 1, 2]"),
                  required("points", array(vector3(""), 1),
                           "Points [x, y, z] at these times, in the unit of the function.",
                           "[[0, 0, 0], [0, 0, 1], [0, 0, 0]]"),
                  interpolation()}})
      .checked(key_rule("points"));
}

Type sum_of_functions() {
  const Type terms =
      array(one_of({number(unbounded(), ""), formula(), key_frames()}), 1)
          .expecting("an array of one or more numbers, formulas of t in quotes, or key frames");
  return record({"sum_of_functions",
                 "The sum of functions of time. The viewer writes such a sum if the user changes a gravity "
                 "that is a function of time.",
                 {required("sum", terms, "The functions, in the unit of the sum.", "[\"sin(t)\", 1]")}});
}

std::string in(const std::string& unit) {
  return unit.empty() || unit == "1" ? "" : " (" + unit + ")";
}

}  // namespace

Type time_function(std::string unit) {
  const std::string words =
      "a number" + in(unit) + ", a formula of t in quotes, or key frames {\"t\": [...], \"y\": [...]}";
  return one_of({number(unbounded(), std::move(unit)), formula(), key_frames(), sum_of_functions()})
      .expecting(words)
      .defined_as("time_function");
}

Type time_vector(std::string unit) {
  const std::string words = "[x, y, z] of numbers" + in(unit) +
                            " or formulas of t in quotes, or key frames {\"t\": [...], \"points\": [...]}";
  Type each = array(time_function(std::move(unit)), 3, 3);
  return one_of({each.expecting(words), point_key_frames()}).expecting(words).defined_as("time_vector");
}

Type state_function(std::string unit, Range range) {
  const std::string words =
      number(range, unit).words() +
      ", a formula of t and of named quantities in quotes, or key frames {\"t\": [...], "
      "\"y\": [...]}";
  return one_of({number(range, std::move(unit)), state_formula(), key_frames()}).expecting(words);
}

Type state_vector(std::string unit) {
  const std::string words =
      "[x, y, z] of numbers" + in(unit) +
      " or formulas of t and of named quantities in quotes, or key frames {\"t\": [...], \"points\": [...]}";
  Type each = array(state_function(std::move(unit), unbounded()), 3, 3);
  return one_of({each.expecting(words), point_key_frames()}).expecting(words).defined_as("state_vector");
}

}  // namespace schema

namespace {

std::vector<double> numbers(const JsonValue& array) {
  std::vector<double> x;
  for (const JsonValue& element : array.array()) x.push_back(element.number());
  return x;
}

/// Returns the function through key frames without end rates. frames: the JSON value, whose key
/// "interpolation" selects the curve.
TimeFunction through(const JsonValue& frames, std::vector<double> t, std::vector<double> y) {
  return schema::is_linear(frames) ? linear_key_frames(std::move(t), std::move(y))
                                   : TimeFunction::key_frames(std::move(t), std::move(y));
}

}  // namespace

TimeFunction read_time_function(const JsonValue& value) {
  if (value.is_number()) return value.number();
  if (value.is_string()) return TimeFunction::formula(value.string());
  if (const JsonValue* terms = value.find("sum")) {
    TimeFunction sum;
    for (const JsonValue& term : terms->array()) sum = sum + read_time_function(term);
    return sum;
  }
  std::vector<double> t = numbers(*value.find("t")), y = numbers(*value.find("y"));
  if (const JsonValue* rates = value.find("end_rates")) {
    return TimeFunction::key_frames(std::move(t), std::move(y), rates->array()[0].number(),
                                    rates->array()[1].number());
  }
  return through(value, std::move(t), std::move(y));
}

TimeVector read_time_vector(const JsonValue& value) {
  if (value.is_array()) {
    const JsonValue::Array& x = value.array();
    return {read_time_function(x[0]), read_time_function(x[1]), read_time_function(x[2])};
  }
  const std::vector<double> t = numbers(*value.find("t"));
  TimeVector path;
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<double> y;
    for (const JsonValue& point : value.find("points")->array()) y.push_back(point.array()[i].number());
    path.component[i] = through(value, t, std::move(y));
  }
  return path;
}

}  // namespace pliant
