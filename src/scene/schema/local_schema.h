// What a scene may say of the elasticity of a part: of its local deformation, and of the whole map.
#pragma once

#include <pliant/scene/schema/schema.h>

namespace pliant {

schema::Record local_record();
/// The elastic material of a part without nodes: a law of the same name and numbers as that of nodes.
schema::Type elasticity_type();

}  // namespace pliant
