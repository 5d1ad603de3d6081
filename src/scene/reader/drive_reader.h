// Reading the drives of joints and of parameters, and the limits of joints.
#pragma once

#include <pliant/body/multibody.h>
#include <pliant/scene/reader/reader.h>

#include "state_reader.h"

namespace pliant {

/// Reads a drive. r: an object of drive_record(). Reports faults. Returns whether there are no faults.
bool read_drive(const Reader& r, const StateReader& states, Drive& drive);

/// Reports a constant stiffness of a drive if its sum with the stiffness of the parameter is negative.
/// parameter: the object with the key "drive".
void check_sum_of_stiffnesses(const Reader& parameter, const Drive& drive, SceneFaults& faults);

/// Adds the limits of a joint. r: the entry of the joint. Faults are reported.
void read_joint_limits(const Reader& r, const Joint& joint, SceneFaults& faults, MultiBody& body);

/// Adds the drives of a joint: one for a hinge or slider, three for a ball joint. r: the object under the key
/// "drive" of the joint. Faults are reported.
void read_joint_drive(const Reader& r, const Joint& joint, const StateReader& states, MultiBody& body);

}  // namespace pliant
