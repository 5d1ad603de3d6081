#include <pliant/view/orbit.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <pliant/math/scalar/functions.h>

namespace pliant {
namespace {

constexpr double kDegree = kPi / 180, kLeastSlope = kDegree;

/// The axes of a camera, unit vectors.
struct Axes {
  Vec3<double> right, up, back;
};
Axes axes_of(const Camera& camera) {
  const Vec3<double> back = (camera.eye - camera.target).normalized();
  const Vec3<double> right = camera.up.cross(back).normalized();
  return {right, back.cross(right), back};
}

double tan_half_height(const Camera& camera) {
  return std::tan(0.5 * kDegree * camera.field_of_view);
}

}  // namespace

void orbit(Camera& camera, double dx, double dy) {
  const Vec3<double> up = camera.up.normalized();
  Vec3<double> arm = Eigen::AngleAxisd(-kPi * dx, up) * (camera.eye - camera.target);
  const double distance = arm.norm(), slope = std::acos(std::clamp(arm.dot(up) / distance, -1.0, 1.0));
  const double wanted = std::clamp(slope + kPi * dy, kLeastSlope, kPi - kLeastSlope);
  arm = Eigen::AngleAxisd(wanted - slope, up.cross(arm).normalized()) * arm;
  camera.eye = camera.target + arm;
}

void pan(Camera& camera, double dx, double dy) {
  const Axes axes = axes_of(camera);
  const double height = 2 * tan_half_height(camera) * (camera.eye - camera.target).norm();
  const Vec3<double> travel = -height * (dx * axes.right + dy * axes.up);
  camera.eye += travel;
  camera.target += travel;
}

void zoom(Camera& camera, double factor) {
  camera.eye = camera.target + (camera.eye - camera.target) / factor;
}

Ray ray_at(const Camera& camera, double x, double y, int width, int height) {
  const Axes axes = axes_of(camera);
  const double unit = 2 * tan_half_height(camera) / height;
  const Vec3<double> through =
      unit * (x - 0.5 * width) * axes.right + unit * (0.5 * height - y) * axes.up - axes.back;
  return {camera.eye, through.normalized()};
}

Vec3<double> in_view_plane(const Camera& camera, const Ray& ray, const Vec3<double>& point) {
  const Vec3<double> back = axes_of(camera).back;
  return ray.origin + (point - ray.origin).dot(back) / ray.direction.dot(back) * ray.direction;
}

Vec3<double> place_in_window(const Camera& camera, const Vec3<double>& point, int width, int height) {
  const Axes axes = axes_of(camera);
  const Vec3<double> p = point - camera.eye;
  const double depth = -p.dot(axes.back), scale = height / (2 * tan_half_height(camera) * depth);
  return {0.5 * width + scale * p.dot(axes.right), 0.5 * height - scale * p.dot(axes.up), depth};
}

}  // namespace pliant
