// Reading the colours of a scene.
#pragma once

#include <pliant/scene/json/json_value.h>
#include <pliant/scene/scene.h>

namespace pliant {

/// Returns the colour of a value "#rrggbb" or [red, green, blue].
Color read_color(const JsonValue& value);

}  // namespace pliant
