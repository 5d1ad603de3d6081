// Function bodies of MultiBody: adding parts, joints and loads.
#pragma once

#include <cmath>
#include <stdexcept>
#include <utility>

#include <pliant/body/actuation/slider_position.h>
#include <pliant/body/joints/ball.h>
#include <pliant/body/joints/joint_registry.h>
#include <pliant/body/multibody.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE Part& MultiBody::add(std::unique_ptr<Part> part) {
  if (part->name().empty()) throw std::invalid_argument("a part needs a name");
  if (!number_of_.emplace(part->name(), static_cast<int>(parts_.size())).second)
    throw std::invalid_argument("there are two parts called '" + part->name() + "'");
  parts_.push_back(std::move(part));
  return *parts_.back();
}

PLIANT_INLINE Spring& MultiBody::spring(std::string name, Point a, Point b, StateFunction stiffness,
                                        StateFunction damping, StateFunction rest_length) {
  for (const StateFunction* number : {&stiffness, &damping, &rest_length})
    if (number->is_constant() && (!(number->constant() >= 0) || !std::isfinite(number->constant())))
      throw std::invalid_argument("spring '" + name +
                                  "': stiffness, damping and rest length must be finite numbers >= 0");
  springs_.push_back(std::make_unique<Spring>());
  Spring& spring = *springs_.back();
  spring.name = std::move(name);
  spring.a = std::move(a);
  spring.b = std::move(b);
  spring.stiffness = std::move(stiffness);
  spring.damping = std::move(damping);
  spring.rest_length = std::move(rest_length);
  return spring;
}

PLIANT_INLINE void MultiBody::remove(const Spring& spring) {
  springs_.erase(std::remove_if(springs_.begin(), springs_.end(),
                                [&](const std::unique_ptr<Spring>& each) { return each.get() == &spring; }),
                 springs_.end());
}

PLIANT_INLINE void MultiBody::remove(const Drive& drive) {
  drives_.erase(std::remove_if(drives_.begin(), drives_.end(),
                               [&](const std::unique_ptr<Drive>& each) { return each.get() == &drive; }),
                drives_.end());
}

PLIANT_INLINE PointForce& MultiBody::force(std::string name, Point at, StateVector force, Frame frame) {
  forces_.push_back(std::make_unique<PointForce>(
      PointForce{std::move(name), std::move(at), std::move(force), frame, nullptr}));
  return *forces_.back();
}

PLIANT_INLINE PointForce& MultiBody::force(
    std::string name, Point at,
    std::function<Vec3<double>(double, const Vec3<double>&, const Vec3<double>&)> custom) {
  forces_.push_back(std::make_unique<PointForce>(
      PointForce{std::move(name), std::move(at), {}, Frame::world, std::move(custom)}));
  return *forces_.back();
}

PLIANT_INLINE Torque& MultiBody::torque(std::string name, const Part& part, StateVector torque, Frame frame) {
  torques_.push_back(
      std::make_unique<Torque>(Torque{std::move(name), &part, std::move(torque), frame, nullptr}));
  return *torques_.back();
}

PLIANT_INLINE DistributedForce& MultiBody::surface_force(std::string name, const Part& part,
                                                         StateVector traction, StateFunction pressure) {
  distributed_.push_back(std::make_unique<DistributedForce>(DistributedForce{
      std::move(name), &part, DistributedForce::Domain::surface, std::move(traction), std::move(pressure)}));
  return *distributed_.back();
}

PLIANT_INLINE DistributedForce& MultiBody::body_force(std::string name, const Part& part,
                                                      StateVector per_mass) {
  distributed_.push_back(std::make_unique<DistributedForce>(DistributedForce{
      std::move(name), &part, DistributedForce::Domain::body, std::move(per_mass), StateFunction(0)}));
  return *distributed_.back();
}

PLIANT_INLINE const Joint& MultiBody::coordinate(const Joint& joint, const BallAxes& ball) {
  for (const std::unique_ptr<Joint>& known : coordinates_)
    if (known->name() == joint.name()) return *known;
  for (const Point& point : joint.points())
    if (point.part != nullptr) prepare(*parts_[static_cast<std::size_t>(index(*point.part))]);
  coordinates_.push_back(make_coordinate(joint, ball));
  return *coordinates_.back();
}

PLIANT_INLINE void MultiBody::add_limits(const Joint& joint, std::vector<std::unique_ptr<Joint>> limits) {
  for (std::unique_ptr<Joint>& limit : limits) {
    limit->during(joint.on(), joint.off());
    join(std::move(limit));
  }
}

PLIANT_INLINE void MultiBody::limit(const Joint& joint, double lower, double upper, double restitution) {
  add_limits(joint, make_limits(coordinate(joint), lower, upper, restitution));
}
PLIANT_INLINE void MultiBody::limit_swing(const Joint& joint, double max, double restitution) {
  add_limits(joint, make_swing_limit(coordinate(joint), max, restitution));
}
PLIANT_INLINE void MultiBody::limit_twist(const Joint& joint, double lower, double upper,
                                          double restitution) {
  add_limits(joint, make_twist_limits(coordinate(joint), lower, upper, restitution));
}

PLIANT_INLINE Drive& MultiBody::drive(std::string name, const Joint& coordinate, int row) {
  auto drive = std::make_unique<Drive>();
  drive->name = std::move(name);
  drive->on.kind = Signal::Kind::coordinate;
  drive->on.coordinate = &coordinate;
  drive->on.index = row;
  drive->angle = row == 0 && coordinate.type() != std::string(SliderPosition::name);  // rows 1, 2: swing
  drives_.push_back(std::move(drive));
  return *drives_.back();
}

PLIANT_INLINE Drive& MultiBody::drive(std::string name, const Part& part, const std::string& parameter) {
  auto drive = std::make_unique<Drive>();
  drive->on.kind = Signal::Kind::parameter;
  drive->on.part = &part;
  drive->on.index = part.parameters().dynamic_number(parameter);
  if (drive->on.index < 0)
    throw std::invalid_argument("drive '" + name + "': part '" + part.name() +
                                "' has no dynamic parameter '" + parameter + "'");
  drive->name = std::move(name);
  drives_.push_back(std::move(drive));
  return *drives_.back();
}

PLIANT_INLINE int MultiBody::input(std::string name, double initial) {
  if (name.empty()) throw std::invalid_argument("an input needs a name");
  for (const Input& other : inputs_)
    if (other.name == name) throw std::invalid_argument("there are two inputs called '" + name + "'");
  inputs_.push_back({std::move(name), initial});
  return static_cast<int>(inputs_.size()) - 1;
}

PLIANT_INLINE const Sensor& MultiBody::sensor(std::string name, StateFunction value) {
  if (name.empty()) throw std::invalid_argument("a sensor needs a name");
  for (const std::unique_ptr<Sensor>& other : sensors_)
    if (other->name == name) throw std::invalid_argument("there are two sensors called '" + name + "'");
  sensors_.push_back(std::make_unique<Sensor>(Sensor{std::move(name), std::move(value)}));
  return *sensors_.back();
}

PLIANT_INLINE Joint& MultiBody::join(std::unique_ptr<Joint> joint) {
  const std::vector<Point>& points = joint->points();
  const std::string what = std::string(joint->type()) + " '" + joint->name() + "'";
  if (joint->name().empty()) throw std::invalid_argument("a joint needs a name");
  if (has_joint(joint->name()))
    throw std::invalid_argument("there are two joints called '" + joint->name() + "'");
  if (static_cast<int>(points.size()) != joint->n_points())
    throw std::invalid_argument(what + " ties " + std::to_string(joint->n_points()) + " points, not " +
                                std::to_string(points.size()));
  const auto first = static_cast<std::size_t>(joint->n_first());
  for (std::size_t k = 1; k < points.size(); ++k)
    if (k != first && points[k].part != points[k < first ? 0 : first].part)
      throw std::invalid_argument(what + ": the points of each side must be on one part");
  joint_names_.insert(joint->name());
  joints_.push_back(std::move(joint));
  return *joints_.back();
}

PLIANT_INLINE Joint& MultiBody::join(const std::string& type, std::string name, const JointSetting& setting) {
  for (const Point* point : {&setting.from, &setting.to})
    if (point->part != nullptr) prepare(*parts_[static_cast<std::size_t>(index(*point->part))]);
  return join(make_joint(type, std::move(name), setting));
}

PLIANT_INLINE ContactPlane& MultiBody::plane(std::string name, TimeVector point, const Vec3<double>& normal) {
  const double length = normal.norm();
  if (!(length > 0) || !std::isfinite(length))
    throw std::invalid_argument("plane '" + name + "': its normal needs a finite length > 0");
  for (const ContactPlane& other : contact.planes)
    if (other.name == name) throw std::invalid_argument("there are two planes called '" + name + "'");
  contact.active = true;
  contact.planes.push_back({std::move(name), std::move(point), normal / length});
  return contact.planes.back();
}

PLIANT_INLINE ContactObstacle& MultiBody::obstacle(std::string name, Eigen::Matrix3Xd vertices,
                                                   Eigen::Matrix3Xi triangles) {
  for (const ContactObstacle& other : contact.obstacles)
    if (other.name == name) throw std::invalid_argument("there are two obstacles called '" + name + "'");
  contact.active = true;
  contact.obstacles.push_back({std::move(name), std::move(vertices), std::move(triangles)});
  return contact.obstacles.back();
}

PLIANT_INLINE ContactObstacle& MultiBody::plate(std::string name, const Vec3<double>& middle,
                                                const Eigen::Quaterniond& orientation, double half_x,
                                                double half_y) {
  if (!(half_x > 0 && half_y > 0) || !std::isfinite(half_x + half_y))
    throw std::invalid_argument("plate '" + name + "': its half extents must be finite numbers > 0");
  // A flat tetrahedron: two triangles above, two below.
  Eigen::Matrix3Xd corners(3, 4);
  corners << -half_x, half_x, half_x, -half_x, -half_y, -half_y, half_y, half_y, 0, 0, 0, 0;
  Eigen::Matrix3Xi triangles(3, 4);
  triangles << 0, 0, 1, 1, 1, 2, 0, 3, 2, 3, 3, 2;
  return obstacle(std::move(name), (orientation.normalized().toRotationMatrix() * corners).colwise() + middle,
                  triangles);
}

PLIANT_INLINE Joint& MultiBody::ball(std::string name, Point a, Point b) {
  return join(std::move(name), Ball{}, {std::move(a), std::move(b)});
}

PLIANT_INLINE Joint& MultiBody::hinge(std::string name, Point a, Point b, const Vec3<double>& axis) {
  JointSetting setting{std::move(a), std::move(b)};
  setting.axis = axis;
  return join("hinge", std::move(name), setting);
}

PLIANT_INLINE Joint& MultiBody::weld(std::string name, Point a, Point b) {
  return join("weld", std::move(name), JointSetting{std::move(a), std::move(b)});
}

PLIANT_INLINE Part* MultiBody::find(const std::string& name) const {
  const auto found = number_of_.find(name);
  return found == number_of_.end() ? nullptr : parts_[static_cast<std::size_t>(found->second)].get();
}

PLIANT_INLINE int MultiBody::index(const Part& part) const {
  const auto found = number_of_.find(part.name());
  if (found == number_of_.end() || parts_[static_cast<std::size_t>(found->second)].get() != &part)
    throw std::invalid_argument("part '" + part.name() + "' does not belong to this MultiBody");
  return found->second;
}

}  // namespace pliant
