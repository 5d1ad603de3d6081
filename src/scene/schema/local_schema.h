// The records of the elasticity of a part: of its local deformation, or of its dynamic parameters if it has
// no local deformation.
#pragma once

#include <pliant/scene/schema/schema.h>

namespace pliant {

/// Returns the record of a local deformation.
schema::Record local_record();
/// Returns the type of the elastic material of a part without local deformation. Its laws have the names and
/// material numbers of the laws for local deformation.
schema::Type elasticity_type();

}  // namespace pliant
