// The JSON value of a function of time: a number, a formula of t in quotes, key frames {"t": [...], "y":
// [...]} with optional "end_rates", or a sum {"sum": [...]} of such functions. The formula of a function
// of time and state may also contain names of quantities of the scene, for example "ball.z".
#pragma once

#include <string>

#include <pliant/math/time_function.h>
#include <pliant/scene/json/json_value.h>
#include <pliant/scene/schema/schema.h>

namespace pliant {

namespace schema {

/// The type of a scalar function of time. unit: unit of its values.
Type time_function(std::string unit);
/// The type of a vector function of time: three functions [x, y, z], or key frames of points {"t": [...],
/// "points": [[x, y, z], ...]}. unit: unit of its components.
Type time_vector(std::string unit);
/// The type of a scalar function of time and state. unit: unit of its values. range: allowed values of a
/// constant function.
Type state_function(std::string unit, Range range);
/// The type of a vector function of time and state. unit: unit of its components.
Type state_vector(std::string unit);

}  // namespace schema

/// Returns the function that a validated value of type schema::time_function describes.
TimeFunction read_time_function(const JsonValue& value);
/// Returns the vector function that a validated value of type schema::time_vector describes.
TimeVector read_time_vector(const JsonValue& value);

}  // namespace pliant
