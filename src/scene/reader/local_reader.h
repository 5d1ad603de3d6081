// Reading the local deformation of a part of a scene.
#pragma once

#include <pliant/part/part.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"

namespace pliant {

/// Reads an object of local_record() and sets the local deformation of the part. Faults are reported, and the
/// part is then left unchanged. make_factor: see LocalSettings.
void read_local(const Reader& local, const MakeSparseFactor& make_factor, SceneFaults& faults, Part& part);

}  // namespace pliant
