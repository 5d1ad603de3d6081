// Finds the smallest distance along a fixed direction at which all corners of a box are inside the picture,
// with a margin.
#include <pliant/render/camera.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace pliant {

Camera automatic_camera(const Eigen::AlignedBox3d& bounds, double aspect, double field_of_view) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  constexpr double kAzimuth = -58 * kDegree, kElevation = 20 * kDegree, kFill = 0.84;
  if (!(aspect > 0) || !std::isfinite(aspect))
    throw std::invalid_argument("camera: the aspect is " + std::to_string(aspect) +
                                "; expected a number > 0");
  if (!(field_of_view > 0 && field_of_view < 180))
    throw std::invalid_argument("camera: the field of view is " + std::to_string(field_of_view) +
                                " degrees; expected a number between 0 and 180");

  Eigen::AlignedBox3d box = bounds;
  if (box.isEmpty()) box = Eigen::AlignedBox3d(Eigen::Vector3d(-0.5, -0.5, 0), Eigen::Vector3d(0.5, 0.5, 1));
  if (!box.min().allFinite() || !box.max().allFinite())
    throw std::invalid_argument("camera: the box to be shown is not finite");

  Camera camera;
  camera.field_of_view = field_of_view;
  camera.target = box.center();
  const Eigen::Vector3d back(std::cos(kElevation) * std::cos(kAzimuth),
                             std::cos(kElevation) * std::sin(kAzimuth), std::sin(kElevation));
  const Eigen::Vector3d right = camera.up.cross(back).normalized(), up = back.cross(right);
  const double tan_y = kFill * std::tan(camera.field_of_view * kDegree / 2), tan_x = tan_y * aspect;
  // A corner at (x, y, z) in the axes right, up, back is inside if |x - cx| <= tan_x (d - z) and
  // |y - cy| <= tan_y (d - z). d is the distance of the eye, and (cx, cy) the shift of the target. These are
  // four bounds for each corner, linear in d, cx and cy.
  double right_bound = 0, left_bound = 0, top_bound = 0, bottom_bound = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p =
        box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - camera.target;
    const double x = right.dot(p), y = up.dot(p), z = back.dot(p);
    right_bound = std::max(right_bound, tan_x * z + x);
    left_bound = std::max(left_bound, tan_x * z - x);
    top_bound = std::max(top_bound, tan_y * z + y);
    bottom_bound = std::max(bottom_bound, tan_y * z - y);
  }
  const double distance =
      std::max((right_bound + left_bound) / (2 * tan_x), (top_bound + bottom_bound) / (2 * tan_y));
  camera.target += (right_bound - left_bound) / 2 * right + (top_bound - bottom_bound) / 2 * up;
  const double smallest = std::max(1e-6, 1e-9 * camera.target.norm());
  camera.eye = camera.target + std::max(distance, smallest) * back;
  return camera;
}

}  // namespace pliant
