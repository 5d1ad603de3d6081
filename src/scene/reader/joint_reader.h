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

/// Reads a joint without its drive, and adds the joint to the MultiBody. Returns the joint. If the joint has
/// faults, they are reported instead, and the result is nullptr.
Joint* read_joint(const Reader& r, const PointReader& points, SceneFaults& faults, MultiBody& body);

}  // namespace pliant
