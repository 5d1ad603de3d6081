// The camera of a picture, and an automatic camera that shows a box.
#pragma once

#include <Eigen/Geometry>

namespace pliant {

/// Positions are in the world frame, m. The vertical field of view is given; the horizontal field of view
/// follows from the aspect of the picture.
struct Camera {
  Eigen::Vector3d eye = {4, -6, 3};
  Eigen::Vector3d target = {0, 0, 0};
  Eigen::Vector3d up = {0, 0, 1};
  double field_of_view = 32;  ///< degrees, from bottom to top
};

/// Returns a camera that looks at the box obliquely, slightly from above, and shows the whole box with a
/// margin. The z axis points upwards. aspect: width / height; field_of_view: degrees. An empty box is
/// replaced by the unit cube that stands on the origin. Throws std::invalid_argument if the box is not
/// finite, aspect is not positive or field_of_view is not in (0, 180).
Camera automatic_camera(const Eigen::AlignedBox3d& bounds, double aspect,
                        double field_of_view = Camera().field_of_view);

}  // namespace pliant
