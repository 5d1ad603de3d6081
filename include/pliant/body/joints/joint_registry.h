// The joints that scenes know, by name: those of body/joints/all_joints.h.
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
  JointKeys keys;  ///< what of a setting it uses
  /// Parts of the setting must be prepared. Throws std::invalid_argument when the setting makes no joint.
  std::unique_ptr<Joint> (*make)(std::string name, const JointSetting& setting);
};

const std::vector<JointInfo>& all_joints();

/// A joint of a type, "hinge" say. Throws std::invalid_argument likewise, and listing the types for an
/// unknown one.
std::unique_ptr<Joint> make_joint(const std::string& type, std::string name, const JointSetting& setting);

}  // namespace pliant
