// What a scene may say of joints: one record for each type of body/joint_registry.h, and how they close and
// hold.
#pragma once

#include <pliant/scene/schema/schema.h>

namespace pliant {

schema::Type joint_type(const schema::Type& end_point, const schema::Type& orientation);
schema::Record stabilization_record();

}  // namespace pliant
