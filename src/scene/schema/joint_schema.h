// The records of joints, one per type of body/joints/joint_registry.h, and of their stabilization
// (Baumgarte's equation, which replaces gamma in Eq. (14)).
#pragma once

#include <pliant/scene/schema/schema.h>

namespace pliant {

/// Returns the type of a joint, tagged by "type". end_point, orientation: types of the keys "from", "to" and
/// "rotation".
schema::Type joint_type(const schema::Type& end_point, const schema::Type& orientation);
schema::Record stabilization_record();

}  // namespace pliant
