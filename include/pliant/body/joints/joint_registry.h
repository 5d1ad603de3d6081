// Makes joints by the names of their types, for scenes. body/joints/all_joints.h lists the types.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/body/joints/joint.h>
#include <pliant/body/joints/joint_setting.h>

namespace pliant {

struct JointInfo {
  const char* name;
  const char* formula;
  int rows;
  JointKeys keys;  ///< members of JointSetting that the joint uses
  /// Makes a joint. The parts of the setting must be prepared (Part::prepare()). Throws std::invalid_argument
  /// for an invalid setting.
  std::unique_ptr<Joint> (*make)(std::string name, const JointSetting& setting);
};

/// Returns all types of joints.
const std::vector<JointInfo>& all_joints();

/// Makes a joint of a type, for instance "hinge". Throws std::invalid_argument for an invalid setting, and
/// for an unknown type with the list of types.
std::unique_ptr<Joint> make_joint(const std::string& type, std::string name, const JointSetting& setting);

}  // namespace pliant
