// Reading functions of time and state: a formula may read parts, joints, springs, tracks and sensors by their
// names.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/actuation/state_function.h>
#include <pliant/scene/scene.h>

#include "scene/scene_faults.h"
#include "time_reader.h"

namespace pliant {

class StateReader {
 public:
  /// scene: formulas may read its parts, joints, springs, tracks and sensors by their names; the scene must
  /// outlive the reader. Coordinates of joints that a formula reads are added to the MultiBody.
  /// at_points: the quantities at a point that the formulas of a distributed force may read.
  StateReader(Scene& scene, SceneFaults& faults, std::vector<std::string> at_points = {})
      : scene_(scene), times_(scene.end, faults), faults_(faults), at_points_(std::move(at_points)) {}

  /// Returns the function that a validated value of type schema::state_function describes, or std::nullopt if
  /// the value is faulty; the fault is reported.
  std::optional<StateFunction> function(const JsonValue& value) const;
  /// Returns the three functions under a key, or std::nullopt if the key is absent or a function is faulty.
  std::optional<StateVector> vector(const Reader& r, const char* key) const;

 private:
  Scene& scene_;
  TimeReader times_;
  SceneFaults& faults_;
  std::vector<std::string> at_points_;
};

}  // namespace pliant
