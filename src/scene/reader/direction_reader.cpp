#include "direction_reader.h"

#include <cmath>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "scene/json/json_write.h"

namespace pliant {

Vec3<double> read_direction(const JsonValue& value, SceneFaults& faults) {
  const Vec3<double> d = read_vector3(value);
  if (d.isZero(0)) {
    faults.value(value, "expected a direction that is not zero");
    return {0, 0, 1};
  }
  return d.stableNormalized();
}

Eigen::Quaterniond read_orientation(const Reader& r, SceneFaults& faults) {
  if (!r.complete()) return Eigen::Quaterniond::Identity();
  if (r.name() == "by_axis") {
    if (std::abs(r.number("angle")) > 2 * kPi)
      faults.warn(r.at("angle"), "this is more than a full turn; angles are in radians");
    return Eigen::Quaterniond(Eigen::AngleAxisd(r.number("angle"), read_direction(r.at("axis"), faults)));
  }
  const JsonValue& value = r.at("quaternion");
  const std::vector<double> q = r.numbers("quaternion");
  const Eigen::Vector4d wxyz(q[0], q[1], q[2], q[3]);
  const double length = wxyz.stableNorm();
  if (std::abs(length - 1) <= 1e-3) return Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
  std::string hint;
  if (length > 0) {
    const Eigen::Vector4d unit = wxyz.stableNormalized();
    for (const double x : {unit[0], unit[1], unit[2], unit[3]})
      hint += (hint.empty() ? "; did you mean [" : ", ") + shortest(std::round(x * 1e6) / 1e6);
    hint += "]?";
  }
  faults.value(value, "its length is " + brief(length) + "; expected a quaternion of length 1" + hint);
  return Eigen::Quaterniond::Identity();
}

}  // namespace pliant
