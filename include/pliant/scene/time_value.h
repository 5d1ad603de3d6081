// Functions of time in a scene: a number, a formula of t in quotes, or key frames {"t": [...], "y": [...]}.
#pragma once

#include <string>

#include <pliant/math/time_function.h>
#include <pliant/scene/json/json_value.h>
#include <pliant/scene/schema/schema.h>

namespace pliant {

namespace schema {

/// A scalar function of time.
Type time_function(std::string unit);
/// Three functions of time [x, y, z], or key frames of points {"t": [...], "points": [[x, y, z], ...]}.
Type time_vector(std::string unit);

}  // namespace schema

/// The function that a validated value of schema::time_function stands for.
TimeFunction read_time_function(const JsonValue& value);
/// The same for schema::time_vector.
TimeVector read_time_vector(const JsonValue& value);

}  // namespace pliant
