// Reading the joints of a scene and their stabilization.
#pragma once

#include <string>

#include <pliant/body/multibody.h>
#include <pliant/scene/reader/reader.h>

#include "point_reader.h"
#include "scene/scene_faults.h"

namespace pliant {

/// Returns the solver for joint forces with this name in the schema.
JointSolver::Choice joint_solver(const std::string& name);

Stabilization read_stabilization(const Reader& r, SceneFaults& faults);

/// Reads a joint and adds it to the MultiBody; faults are reported.
void read_joint(const Reader& r, const PointReader& points, SceneFaults& faults, MultiBody& body);

}  // namespace pliant
