// Reading the joints of a scene and their stabilization.
#pragma once

#include <string>

#include <pliant/body/multibody.h>
#include <pliant/scene/reader/reader.h>

#include "point_reader.h"
#include "scene/scene_faults.h"

namespace pliant {

/// Returns the solver for joint forces with a name of the schema: "blocks", "augmented", or else automatic.
JointSolver::Choice joint_solver(const std::string& name);

/// Returns the stabilization of the joints of a scene. r: an object of stabilization_record().
Stabilization read_stabilization(const Reader& r, SceneFaults& faults);

/// Reads a joint and adds the joint to the MultiBody. If the joint has faults, they are reported instead.
void read_joint(const Reader& r, const PointReader& points, SceneFaults& faults, MultiBody& body);

}  // namespace pliant
