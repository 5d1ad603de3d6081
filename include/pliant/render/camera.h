// Where a picture is taken from.
#pragma once

#include <Eigen/Geometry>

namespace pliant {

/// World frame, metres. The picture's vertical field of view is given; the horizontal one follows from its
/// aspect.
struct Camera {
  Eigen::Vector3d eye = {4, -6, 3};
  Eigen::Vector3d target = {0, 0, 0};
  Eigen::Vector3d up = {0, 0, 1};
  double field_of_view = 32;  ///< degrees, from bottom to top
};

/// A three-quarter view, slightly from above, that holds the whole box with a margin. aspect = width /
/// height; field_of_view in degrees. An empty box is taken as the unit cube on the origin. Throws
/// std::invalid_argument when the box is not finite, aspect is not positive or field_of_view is not in (0,
/// 180).
Camera automatic_camera(const Eigen::AlignedBox3d& bounds, double aspect,
                        double field_of_view = Camera().field_of_view);

}  // namespace pliant
