// The coordinates of joints: the angle of a hinge, the position of a slider, the rotation of a ball joint.
// Like a joint, a coordinate is a formula of points (joints/joint.h), but it is not a constraint. The rows of
// a coordinate are in radians or metres.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/body/joints/joint.h>

namespace pliant {

/// The axes of the rotation of a ball joint, in the frame of the part of its second point, or in the world.
struct BallAxes {
  Vec3<double> axis = Vec3<double>::UnitX();  ///< axis of the twist, of any length > 0
  /// Orientation of the part of the first point, in the frame of the part of the second point, at which the
  /// rotation is zero. Default: the orientation at time 0. A point of the world has the frame of the world.
  std::optional<Eigen::Quaterniond> rotation{};
};

/// Returns the coordinate of a joint, with the name of the joint. ball: the axes; only used for a ball joint.
/// Throws std::invalid_argument unless the joint is a ball joint, a hinge or a slider.
std::unique_ptr<Joint> make_coordinate(const Joint& joint, const BallAxes& ball);

/// Return the one-sided joints that limit a coordinate, see MultiBody::limit(), limit_swing() and
/// limit_twist(). lower, upper, max: rad, or m for a slider. restitution: from 0 to 1. Throw
/// std::invalid_argument for invalid numbers, and if the function is not for coordinates of this type, for
/// example make_swing_limit() of a hinge.
std::vector<std::unique_ptr<Joint>> make_limits(const Joint& coordinate, double lower, double upper,
                                                double restitution);
std::vector<std::unique_ptr<Joint>> make_swing_limit(const Joint& coordinate, double max, double restitution);
std::vector<std::unique_ptr<Joint>> make_twist_limits(const Joint& coordinate, double lower, double upper,
                                                      double restitution);

/// Returns the number of rows of the coordinate of joints of a type ("hinge"); 0 if there is no coordinate.
int coordinate_rows(const std::string& type);
/// Returns whether the rows of the coordinate of joints of a type are angles.
bool is_angle(const std::string& type);

}  // namespace pliant
