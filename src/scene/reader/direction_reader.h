// Reading directions and orientations of a scene.
#pragma once

#include <Eigen/Geometry>

#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"

namespace pliant {

/// Returns the unit vector along a vector. Reports a fault and returns (0, 0, 1) if the vector is zero.
Vec3<double> read_direction(const JsonValue& value, SceneFaults& faults);

/// Returns the rotation {"quaternion"} or {"axis", "angle"}, or the identity if a required key is missing. A
/// quaternion whose length differs from 1 by more than 1e-3 is reported, and the identity is returned.
Eigen::Quaterniond read_orientation(const Reader& r, SceneFaults& faults);

}  // namespace pliant
