// What a scene may say of the local deformation of a part.
#pragma once

#include <pliant/scene/schema.h>

namespace pliant {

schema::Record local_record();

}  // namespace pliant
