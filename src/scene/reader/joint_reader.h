// Joints of a scene, and how they close and hold.
#pragma once

#include <string>

#include <pliant/body/multibody.h>
#include <pliant/scene/reader/reader.h>

#include "point_reader.h"
#include "scene/scene_faults.h"

namespace pliant {

JointSolver::Choice joint_solver(const std::string& name);

Stabilization read_stabilization(const Reader& r, SceneFaults& faults);

/// Adds a joint to the body, or faults.
void read_joint(const Reader& r, const PointReader& points, SceneFaults& faults, MultiBody& body);

}  // namespace pliant
