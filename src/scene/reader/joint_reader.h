// Reading the joints of a scene and their stabilization.
#pragma once

#include <string>
#include <vector>

#include <pliant/body/multibody.h>
#include <pliant/scene/reader/reader.h>

#include "point_reader.h"
#include "scene/scene_faults.h"

namespace pliant {

/// Returns the solver for joint forces with a name of the schema: "blocks", "augmented", or else automatic.
JointSolver::Choice joint_solver(const std::string& name);

/// Returns the stabilization of the joints of a scene. r: an object of stabilization_record().
Stabilization read_stabilization(const Reader& r, SceneFaults& faults);

/// Returns whether an entry of the list of joints makes a ring of joints.
bool has_ring(const Reader& r);
/// Returns the names of the joints of a ring with a name, "NAME.1", ..., "NAME.count"; no names
/// without a ring.
std::vector<std::string> ring_names(const Reader& r);

/// Reads an entry of the list of joints without its drive, and adds one joint to the MultiBody, or the joints
/// NAME.1, NAME.2, ... of a ring. Returns these joints. If the entry has faults, they are reported instead,
/// and the result is empty.
std::vector<Joint*> read_joint(const Reader& r, const PointReader& points, SceneFaults& faults,
                               MultiBody& body);

}  // namespace pliant
