#include "state_reader.h"

#include <stdexcept>
#include <utility>

#include <pliant/body/actuation/named_signal.h>
#include <pliant/scene/time_value.h>

namespace pliant {

std::optional<StateFunction> StateReader::function(const JsonValue& value) const {
  if (value.is_string()) {
    NamedPoints points;
    for (const Track& track : scene_.tracks) points.emplace(track.name, track.point);
    try {
      StateFunction function = state_formula(scene_.body, value.string(), points, at_points_);
      if (function.reads_state()) return function;
    } catch (const FormulaError& fault) {
      faults_.in_string(value, fault.offset(), fault.reason());
      return {};
    } catch (const std::invalid_argument& fault) {
      faults_.value(value, fault.what());
      return {};
    }
  }
  const std::optional<TimeFunction> of_time = times_.function(value, Needs::value);
  return of_time ? std::optional<StateFunction>(*of_time) : std::nullopt;
}

std::optional<StateVector> StateReader::vector(const Reader& r, const char* key) const {
  const JsonValue* value = r.json().find(key);
  if (value == nullptr || !value->is_array() || value->array().size() != 3) {
    const std::optional<TimeVector> of_time = times_.vector(r, key, Needs::value);
    return of_time ? std::optional<StateVector>(*of_time) : std::nullopt;
  }
  StateVector vector;
  bool good = r.given(key);
  for (std::size_t i = 0; i < 3; ++i) {  // check all components, even if one of them is faulty
    const JsonValue& component = value->array()[i];
    const std::optional<StateFunction> function =
        r.is_faulty(component) ? std::nullopt : this->function(component);
    if (function) vector.component[i] = *function;
    good = good && function.has_value();
  }
  return good ? std::optional<StateVector>(vector) : std::nullopt;
}

}  // namespace pliant
