// Warnings about settings that are valid, but probably not intended.
#pragma once

#include <pliant/scene/reader/reader.h>
#include <pliant/scene/scene.h>

#include "scene/scene_faults.h"

namespace pliant {

/// Warns if the sizes of parts differ by more than a factor of a million, and if the camera sees no point of
/// a part at time 0. root: the whole scene, read without errors.
void add_warnings(const Scene& scene, const Reader& root, SceneFaults& faults);

}  // namespace pliant
