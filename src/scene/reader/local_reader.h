// Reading the local deformation of a part of a scene.
#pragma once

#include <pliant/part/part.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"

namespace pliant {

/// Reads an object of local_record() and sets the local deformation of the part. If there are faults, they
/// are reported and the part does not change. make_factor: makes the sparse factorisation for modes of a
/// mesh.
void read_local(const Reader& local, const MakeSparseFactor& make_factor, SceneFaults& faults, Part& part);

}  // namespace pliant
