// The records of joints, one per type of joint in pliant/body/joints/joint_registry.h, and of their
// stabilization (section 4 of the paper), which adds Baumgarte's terms to gamma in Eq. (14).
#pragma once

#include <pliant/scene/schema/schema.h>

namespace pliant {

/// Returns the type of a joint, with one record per value of the key "type". end_point: type of the keys
/// "from" and "to". orientation: type of the key "rotation".
schema::Type joint_type(const schema::Type& end_point, const schema::Type& orientation);
schema::Record stabilization_record();

}  // namespace pliant
