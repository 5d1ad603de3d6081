// The records of a scene file: its keys with their types, units, ranges, defaults and descriptions.
#pragma once

#include <pliant/scene/schema/schema.h>

namespace pliant {

/// Returns the root record. Validation, reading and the JSON Schema of scenes are derived from it.
const schema::Record& scene_record();

/// Returns the type of the value of a global parameter of a part.
const schema::Type& parameter_type();

}  // namespace pliant
