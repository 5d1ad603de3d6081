// Rings of points: one entry of a scene that makes several point-to-point joints. Three points fix the
// relative orientation of two parts, as in the paper, and two points act as a hinge.
#pragma once

#include <vector>

#include <pliant/body/joints/joint_setting.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"

namespace pliant {

/// Returns the settings of the joints of a ring, in the order of their names. With orthonormal directions
/// e_1, e_2 perpendicular to the axis, and the angles a_k = 2 pi k / count, the points of the side `to` are
///   X + radius (cos a_k e_1 + sin a_k e_2)
/// (m, in the frame of the part at rest or in the world), with X the point of the setting. The points of the
/// side `from` have the same offsets from their point X, transformed to the frame of the part of `from`. The
/// transformation is setting.rotation, the orientation of `from` relative to `to`; when absent, the relative
/// orientation at time 0. The points of both sides are therefore the corners of equal polygons, except that
/// points of a shell are moved to its surface. r: an object of ring_record(). A fault is reported, and the
/// result is empty, if a point is outside of its part, if a point of the world moves, if the radius is tiny,
/// or if both parts are rigid and the polygons differ.
std::vector<JointSetting> ring_of_joints(const Reader& r, const JointSetting& setting, SceneFaults& faults);

}  // namespace pliant
