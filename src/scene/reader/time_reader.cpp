#include "time_reader.h"

#include <cmath>

#include <pliant/scene/time_value.h>

namespace pliant {

std::optional<TimeFunction> TimeReader::function(const JsonValue& value, Needs needs) const {
  const TimeFunction f = read_time_function(value);
  if (!finite(value, f, needs)) return {};
  return f;
}

std::optional<TimeVector> TimeReader::vector(const Reader& r, const char* key, Needs needs) const {
  const JsonValue* value = r.json().find(key);
  const bool by_component = value != nullptr && value->is_array() && value->array().size() == 3;
  bool good = r.given(key);
  if (by_component) {  // check all components, even if one of them is faulty
    for (const JsonValue& component : value->array())
      good = !r.is_faulty(component) && function(component, needs) && good;
  }
  if (!good) return {};
  const TimeVector f = r.time_vector(key);
  if (!by_component)
    for (const TimeFunction& component : f.component)
      if (!finite(*value, component, needs)) return {};
  return f;
}

bool TimeReader::finite(const JsonValue& at, const TimeFunction& f, Needs needs) const {
  if (f.is_constant()) return true;
  for (int i = 0; i <= kIntervals; ++i) {
    const double t = end_ * i / kIntervals;
    const Taylor2<double> x = f.at(t);
    std::string fault;
    if (std::isnan(x.v)) {
      fault = "its value is not a real number";
    } else if (!std::isfinite(x.v)) {
      fault = "its value is not finite";
    } else if (needs == Needs::value_and_rate && !std::isfinite(x.d)) {
      fault = "its rate of change is not finite";
    } else {
      continue;
    }
    faults_.value(at, fault + " at t = " + brief(t) + " s; expected finite numbers from t = 0 to " +
                          brief(end_) + " s");
    return false;
  }
  return true;
}

}  // namespace pliant
