// Frames a box: the camera backs away along a fixed direction until the last corner is inside the picture.
#include <pliant/render/camera.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace pliant {

Camera automatic_camera(const Eigen::AlignedBox3d& bounds, double aspect) {
  constexpr double kDegree = 3.14159265358979323846 / 180;
  constexpr double kAzimuth = -58 * kDegree, kElevation = 20 * kDegree, kFill = 0.84;
  if (!(aspect > 0) || !std::isfinite(aspect))
    throw std::invalid_argument("a camera's aspect must be positive");

  Eigen::AlignedBox3d box = bounds;
  if (box.isEmpty()) box = Eigen::AlignedBox3d(Eigen::Vector3d(-0.5, -0.5, 0), Eigen::Vector3d(0.5, 0.5, 1));
  if (!box.min().allFinite() || !box.max().allFinite())
    throw std::invalid_argument("a camera cannot frame a box that is not finite");

  Camera camera;
  camera.target = box.center();
  const Eigen::Vector3d back(std::cos(kElevation) * std::cos(kAzimuth),
                             std::cos(kElevation) * std::sin(kAzimuth), std::sin(kElevation));
  const Eigen::Vector3d right = camera.up.cross(back).normalized(), up = back.cross(right);
  const double tan_y = kFill * std::tan(camera.field_of_view * kDegree / 2), tan_x = tan_y * aspect;
  double distance = 0;
  for (int corner = 0; corner < 8; ++corner) {
    const Eigen::Vector3d p =
        box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(corner)) - camera.target;
    distance = std::max(
        {distance, back.dot(p) + std::abs(right.dot(p)) / tan_x, back.dot(p) + std::abs(up.dot(p)) / tan_y});
  }
  const double smallest = std::max(1e-6, 1e-9 * camera.target.norm());
  camera.eye = camera.target + std::max(distance, smallest) * back;
  return camera;
}

}  // namespace pliant
