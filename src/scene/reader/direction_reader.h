// Directions and orientations of a scene.
#pragma once

#include <Eigen/Geometry>

#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"

namespace pliant {

/// A vector of any length but 0 as a unit vector; (0, 0, 1) with a fault when it has none.
Vec3<double> read_direction(const JsonValue& value, SceneFaults& faults);

/// {"quaternion"} or {"axis", "angle"}; no turn with a fault when it is neither.
Eigen::Quaterniond read_orientation(const Reader& r, SceneFaults& faults);

}  // namespace pliant
