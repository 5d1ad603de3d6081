// The local deformation of a part of a scene.
#pragma once

#include <pliant/part/part.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"

namespace pliant {

/// From its record; faults are reported.
void read_local(const Reader& local, const MakeSparseFactor& make_factor, SceneFaults& faults, Part& part);

}  // namespace pliant
