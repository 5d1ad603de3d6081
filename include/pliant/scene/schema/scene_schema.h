// The records of a scene file: what its keys are, mean and may be.
#pragma once

#include <pliant/scene/schema/schema.h>

namespace pliant {

/// The root record. Checking, reading and the JSON Schema of scenes follow from it.
const schema::Record& scene_record();

/// What the value of a parameter of a part may be.
const schema::Type& parameter_type();

}  // namespace pliant
