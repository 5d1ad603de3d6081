// The records of the elasticity of a part: of its local deformation, and of the dynamic parameters of a part
// without nodes.
#pragma once

#include <pliant/scene/schema/schema.h>

namespace pliant {

/// Returns the record of a local deformation.
schema::Record local_record();
/// Returns the type of the elastic material of a part without nodes. Its laws have the names and material
/// numbers of the laws for local deformation.
schema::Type elasticity_type();

}  // namespace pliant
