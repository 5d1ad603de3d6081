#include "joint_ring.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>

#include <Eigen/Geometry>

#include "direction_reader.h"

namespace pliant {

namespace {

/// A point of a ring with w - 1 up to this number is moved to the surface; w is the radial coordinate. In a
/// solid, a point with a larger w is a fault.
constexpr double kOnSurface = 1e-9;
/// Smallest radius as a share of the size of a part. With a smaller ring, rounding errors of its points would
/// determine the orientation.
constexpr double kSmallestRadius = 1e-5;
/// Two polygons are equal if difference_of_polygons() is at most this share of the radius.
constexpr double kEqual = 1e-6;

/// Returns the point at an offset (m) from a point, in the frame of its part at rest or in the world, or
/// std::nullopt if the part has no point there.
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

/// Returns the place of a point at rest in the frame of its part, or in the world, m.
Vec3<double> place_at_rest(const Point& point) {
  if (point.part == nullptr) return point.world.value(0);
  return point.part->s({point.material}, point.part->parameters().rest()).col(0);
}

bool is_rigid(const Part* part) {
  return part == nullptr || (part->n_s() == 0 && part->local() == nullptr);
}

/// Compares the distances of each point from the first three points of its polygon, on the side `from` and on
/// the side `to`. Returns the largest difference, m.
double difference_of_polygons(const std::vector<JointSetting>& joints) {
  std::vector<Vec3<double>> from, to;
  for (const JointSetting& joint : joints) {
    from.push_back(place_at_rest(joint.from));
    to.push_back(place_at_rest(joint.to));
  }
  double largest = 0;
  for (std::size_t k = 0; k < joints.size(); ++k)
    for (std::size_t first = 0; first < std::min<std::size_t>(3, joints.size()); ++first)
      largest = std::max(largest, std::abs((from[k] - from[first]).norm() - (to[k] - to[first]).norm()));
  return largest;
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
  for (const Point* end : {&setting.from, &setting.to})
    if (end->part != nullptr && radius < kSmallestRadius * end->part->size()) {
      std::ostringstream message;
      message << "the ring is too small to fix the orientation of part \"" << end->part->name()
              << "\"; expected a radius of at least " << kSmallestRadius * end->part->size() << " m";
      faults.value(r.at("radius"), message.str());
      return {};
    }
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
  const double difference = difference_of_polygons(joints);
  if (difference > kEqual * radius && is_rigid(setting.from.part) && is_rigid(setting.to.part)) {
    std::ostringstream message;
    message << "distances between its points differ by " << difference
            << " m on the two sides, because points of a shell are on its surface. No motion of rigid parts "
               "closes the ring; expected solid parts, or parts that deform";
    faults.place(r.json(), message.str());
    return {};
  }
  return joints;
}

}  // namespace pliant
