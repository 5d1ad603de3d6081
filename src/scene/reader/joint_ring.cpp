#include "joint_ring.h"

#include <cmath>
#include <cstdlib>
#include <optional>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include "direction_reader.h"

namespace pliant {

namespace {

/// A point with w - 1 up to this number is on the surface; w is the radial coordinate.
constexpr double kOnSurface = 1e-9;

/// Returns the point at an offset (m) from a point, in the frame of its part at rest or in the world; nothing
/// if the part has no point there.
std::optional<Point> at_offset(const Point& centre, const Vec3<double>& offset) {
  if (centre.part == nullptr) return world(TimeVector(centre.world.value(0) + offset));
  const Part& part = *centre.part;
  const ParameterValues<double>& rest = part.parameters().rest();
  try {
    Material<double> m = part.label(Vec3<double>(part.s({centre.material}, rest).col(0)) + offset, rest);
    if (!part.shell() && !(m.w <= 1 + kOnSurface)) return {};
    if (part.shell() || m.w > 1) m.w = 1;
    return point(part, m, centre.patch);
  } catch (const std::runtime_error&) {  // no material point maps to this position
    return {};
  }
}

/// Returns the orientation of the frame of a point at time 0.
Eigen::Quaterniond orientation_at_start(const Point& end) {
  return end.part == nullptr ? Eigen::Quaterniond::Identity() : end.part->R0();
}

}  // namespace

std::vector<JointSetting> ring_of_joints(const Reader& r, const JointSetting& setting, SceneFaults& faults) {
  if (r.faulty("count") || r.faulty("axis") || !r.complete()) return {};
  for (const Point* end : {&setting.from, &setting.to})
    if (end->part == nullptr && !end->world.is_constant()) {
      faults.place(r.json(),
                   "a point of the world moves; expected points of parts, or fixed points of the world");
      return {};
    }
  const Eigen::Quaterniond turn = setting.rotation.value_or(orientation_at_start(setting.to).conjugate() *
                                                            orientation_at_start(setting.from));
  const Vec3<double> axis = read_direction(r.at("axis"), faults);
  const Vec3<double> other = std::abs(axis[0]) < 0.9 ? Vec3<double>::UnitX() : Vec3<double>::UnitY();
  const Vec3<double> e_1 = (other - axis * axis.dot(other)).normalized(), e_2 = axis.cross(e_1);
  const double radius = r.number("radius");
  const auto count = static_cast<int>(r.integer("count"));
  std::vector<JointSetting> joints;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * kPi * k / count;
    const Vec3<double> offset = radius * (std::cos(angle) * e_1 + std::sin(angle) * e_2);
    const std::optional<Point> from = at_offset(setting.from, turn.conjugate() * offset),
                               to = at_offset(setting.to, offset);
    if (!from || !to) {
      const Point& outside = from ? setting.to : setting.from;
      faults.place(r.json(), "point " + std::to_string(k + 1) + " of the ring is outside of part \"" +
                                 outside.part->name() +
                                 "\"; expected a smaller radius, or a centre deeper inside (\"w\" < 1)");
      return {};
    }
    JointSetting joint = setting;
    joint.from = *from;
    joint.to = *to;
    joints.push_back(joint);
  }
  return joints;
}

}  // namespace pliant
