// The registry of joints: making a joint from its type and a JointSetting.
#include <pliant/body/joints/joint_registry.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <tuple>
#include <utility>

#include <pliant/body/joints/all_joints.h>

namespace pliant {

namespace {

Eigen::Quaterniond orientation(const Point& point) {
  return point.part == nullptr ? Eigen::Quaterniond::Identity() : point.part->R0();
}

/// Returns the size of the smallest part with coordinates at a joint, m. Throws std::invalid_argument if
/// there is none.
double smaller_size(const JointSetting& s) {
  double size = std::numeric_limits<double>::infinity();
  for (const Point* point : {&s.from, &s.to})
    if (point->part != nullptr && !point->part->fixed()) size = std::min(size, point->part->size());
  if (!std::isfinite(size)) throw std::invalid_argument("one of its ends must be on a part that moves");
  return size;
}

Mat3<double> axes_of(const Vec3<double>& direction) {
  if (!direction.allFinite() || direction.isZero(0))
    throw std::invalid_argument("its axis needs a finite length > 0");
  return axes_along(direction);
}

/// Returns the axes of the frames at `from` and at `to`, each in the frame of its part. The frames coincide
/// when the joint is closed; with from_axis, only their first axes coincide.
std::pair<Mat3<double>, Mat3<double>> axes_of(JointKeys keys, const JointSetting& s) {
  const Eigen::Quaterniond turn =
      s.rotation ? s.rotation->normalized() : orientation(s.to).conjugate() * orientation(s.from);
  const Mat3<double> to = keys.has(JointKey::axis) ? axes_of(s.axis) : Mat3<double>::Identity();
  if (s.from_axis) return {axes_of(*s.from_axis), to};
  return {turn.toRotationMatrix().transpose() * to, to};
}

/// Makes a joint of formula F. Throws std::invalid_argument for an invalid setting.
template <class F>
std::unique_ptr<Joint> make(std::string name, const JointSetting& s) {
  for (const Point* point : {&s.from, &s.to})
    if (point->part != nullptr && !point->part->prepared())
      throw std::invalid_argument("part '" + point->part->name() + "' is not prepared");
  F formula{};
  const auto axes = axes_of(F::keys, s);
  std::vector<Point> points;
  auto append = [&](const Point& at, const Mat3<double>& to_axes, MaterialFrame& frame) {
    FramedPoint side = framed(at, to_axes);
    points.insert(points.end(), side.points.begin(), side.points.end());
    frame = side.frame;
  };
  if constexpr (F::first == MaterialFrame::points)
    append(s.from, axes.first, formula.from);
  else
    points.push_back(s.from);
  if constexpr (F::second == MaterialFrame::points)
    append(s.to, axes.second, formula.to);
  else
    points.push_back(s.to);
  if constexpr (F::keys.has(JointKey::length)) formula.length = s.length;
  if constexpr (F::first == MaterialFrame::points) formula.size = smaller_size(s);
  return std::make_unique<JointOf<F>>(std::move(name), std::move(points), std::move(formula));
}

template <class... F>
std::vector<JointInfo> infos_of(std::tuple<F...>*) {
  return {JointInfo{F::name, F::formula, F::rows, F::keys, make<F>}...};
}

}  // namespace

const std::vector<JointInfo>& all_joints() {
  static const std::vector<JointInfo> all = infos_of(static_cast<AllJoints*>(nullptr));
  return all;
}

std::unique_ptr<Joint> make_joint(const std::string& type, std::string name, const JointSetting& setting) {
  std::string types;
  for (const JointInfo& info : all_joints()) {
    if (info.name != type) {
      types += (types.empty() ? "" : ", ") + std::string(info.name);
      continue;
    }
    try {
      return info.make(name, setting);
    } catch (const std::invalid_argument& fault) {
      throw std::invalid_argument(type + " '" + name + "': " + fault.what());
    }
  }
  throw std::invalid_argument("there is no joint of type '" + type + "'; the types are " + types);
}

}  // namespace pliant
