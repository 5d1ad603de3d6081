// View, light and ground of a frame: a perspective projection with the far plane at infinity, an orthographic
// box around the bodies along the key light (shadow map), a second orthographic box from below (contact map),
// and the grid.
#include "frame_block.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "srgb.h"

namespace pliant {
namespace {

using Eigen::AlignedBox3f;
using Eigen::Matrix4d;
using Eigen::Matrix4f;
using Eigen::Vector3d;
using Eigen::Vector3f;
using Eigen::Vector4f;

constexpr double kDegree = 3.14159265358979323846 / 180;
constexpr double kNear = 0.01;       // distance of the near plane / distance between eye and target
constexpr double kShadowReach = 12;  // largest half size of the shadow map / distance between eye and target

// The filter of the shadow map extends 4 texels to each side and 5.7 texels to its corners. Lookups are
// therefore offset by this number of texels along the normal of the body, so that a plane does not shadow
// itself.
constexpr double kLift = 6;

Vector4f with(const Vector3f& xyz, float w) {
  return {xyz[0], xyz[1], xyz[2], w};
}

void require(bool good, const char* what) {
  if (!good) throw std::invalid_argument(std::string("picture: ") + what);
}

Vector4f color(const Vector3f& srgb, const char* name, float strength = 1, float w = 0) {
  if (!((srgb.array() >= 0).all() && (srgb.array() <= 1).all()))
    throw std::invalid_argument(std::string("picture: ") + name + " must have channels in [0, 1]");
  return {linear_light(srgb[0]) * strength, linear_light(srgb[1]) * strength,
          linear_light(srgb[2]) * strength, w};
}

Matrix4d view_projection(const Camera& camera, double aspect) {
  const Vector3d eye = camera.eye - camera.target;
  const Vector3d back = eye.normalized(), right = camera.up.cross(back).normalized(), up = back.cross(right);
  Matrix4d view = Matrix4d::Identity();
  view.row(0) << right.transpose(), -right.dot(eye);
  view.row(1) << up.transpose(), -up.dot(eye);
  view.row(2) << back.transpose(), -back.dot(eye);
  const double f = 1 / std::tan(camera.field_of_view * kDegree / 2);
  Matrix4d projection = Matrix4d::Zero();
  projection(0, 0) = f / aspect;
  projection(1, 1) = f;
  projection(2, 2) = -1;
  projection(2, 3) = -2 * kNear * eye.norm();
  projection(3, 2) = -1;
  return projection * view;
}

// Returns the matrix that maps the box from `low` to `high` (in the axes r, u, -b) to the unit cube.
Matrix4f to_unit(const Vector3d& r, const Vector3d& u, const Vector3d& b, const Vector3d& low,
                 const Vector3d& high) {
  Matrix4d m = Matrix4d::Identity();
  const Vector3d size = high - low;
  m.row(0) << r.transpose() / size[0], -low[0] / size[0];
  m.row(1) << u.transpose() / size[1], -low[1] / size[1];
  m.row(2) << -b.transpose() / size[2], -low[2] / size[2];
  return m.cast<float>();
}

// Rounds a size up to an integer power of 2^(1/4). Small changes of a box then do not change the texels of
// the shadow map and of the contact map, so that shadows do not flicker.
double steady_size(double size) {
  return std::exp2(std::ceil(4 * std::log2(size)) / 4);
}

// Fits the shadow map to the bodies. distance: from the eye to the target, m. Sets shadow and to_key[3].
void fit_shadow(FrameBlock& frame, const std::vector<AlignedBox3f>& boxes, double distance, int shadow_side) {
  const Vector3d b = frame.to_key.head<3>().cast<double>();
  const Vector3d r = (std::abs(b[2]) < 0.9 ? Vector3d::UnitZ() : Vector3d::UnitX()).cross(b).normalized();
  const Vector3d u = b.cross(r);
  Eigen::AlignedBox3d fit;
  for (const AlignedBox3f& box : boxes)
    for (int corner = 0; corner < 8; ++corner) {
      const Vector3d p = box.corner(static_cast<AlignedBox3f::CornerType>(corner)).cast<double>();
      fit.extend(Vector3d(r.dot(p), u.dot(p), -b.dot(p)));
    }
  if (fit.isEmpty()) fit.extend(Vector3d::Zero());
  Vector3d low = fit.min(), high = fit.max();
  for (int i = 0; i < 2; ++i) {
    low[i] = std::clamp(low[i], -kShadowReach * distance, kShadowReach * distance);
    high[i] = std::clamp(high[i], -kShadowReach * distance, kShadowReach * distance);
  }
  const double needed = std::max({high[0] - low[0], high[1] - low[1], 1e-3 * distance});
  const double side = steady_size(needed * (1 + 24.0 / shadow_side)), texel = side / shadow_side;
  for (int i = 0; i < 2; ++i) {
    low[i] = std::floor((0.5 * (low[i] + high[i]) - 0.5 * side) / texel) * texel;
    high[i] = low[i] + side;
  }
  const double margin = 0.01 * (high[2] - low[2]) + 4 * texel;
  low[2] -= margin;
  high[2] += margin;
  frame.shadow = to_unit(r, u, b, low, high);
  frame.to_key[3] = static_cast<float>(kLift * texel);
}

// Fits the contact map to a square around the bodies, seen from below. Sets contact, fade[2], fade[3] and
// sky[3].
void fit_contact(FrameBlock& frame, const std::vector<AlignedBox3f>& boxes, double distance,
                 int contact_side) {
  AlignedBox3f fit;
  double size = 0;
  for (const AlignedBox3f& box : boxes) {
    fit.extend(box);
    size += box.diagonal().norm();
  }
  size = boxes.empty() ? distance : std::min(size / static_cast<double>(boxes.size()), distance);
  Eigen::Vector2d low(-1, -1), high(1, 1);
  if (!fit.isEmpty()) {
    low = fit.min().head<2>().cast<double>();
    high = fit.max().head<2>().cast<double>();
  }
  const double reach = kShadowReach * distance;
  low = low.cwiseMax(-reach).cwiseMin(reach);
  high = high.cwiseMax(-reach).cwiseMin(reach);
  const Eigen::Vector2d middle = 0.5 * (low + high);
  const double side = steady_size(std::max((high - low).maxCoeff() + 1.6 * size, 1e-3 * distance));
  const double texel = side / contact_side, height = 2 * size, z = frame.ground[3];
  const double x = std::floor((middle[0] - 0.5 * side) / texel) * texel;
  const double y = std::floor((-middle[1] - 0.5 * side) / texel) * texel;
  frame.contact = to_unit(Vector3d::UnitX(), -Vector3d::UnitY(), -Vector3d::UnitZ(), Vector3d(x, y, z),
                          Vector3d(x + side, y + side, z + height));
  frame.fade[2] = static_cast<float>(texel);
  frame.fade[3] = static_cast<float>(height);
  frame.sky[3] = static_cast<float>(0.4 * size);
}

// Returns 1, 2 or 5 times a power of ten near an eighth of the height of the view at the target, m.
double automatic_spacing(double view_height) {
  const double wanted = view_height / 8, decade = std::pow(10.0, std::floor(std::log10(wanted)));
  const double m = wanted / decade;
  return decade * (m < 1.5 ? 1 : m < 3.5 ? 2 : m < 7.5 ? 5 : 10);
}

// Throws std::invalid_argument for a setting that is out of range. eye: relative to the target, m.
void check_settings(const Picture& picture, const Vector3d& eye) {
  const Camera& camera = picture.camera;
  const Picture::Ground& floor = picture.ground;
  const Picture::Lights& lights = picture.lights;
  const double distance = eye.norm();
  require(camera.eye.allFinite() && camera.target.allFinite() && camera.up.allFinite(),
          "the camera is not finite");
  require(distance > 0 && std::isfinite(distance), "the eye and the target of the camera are at one point");
  require(camera.up.normalized().cross(eye / distance).norm() > 1e-6,
          "the view is along the up direction of the camera");
  require(camera.field_of_view >= 0.1 && camera.field_of_view <= 170,
          "camera.field_of_view must be in [0.1, 170] degrees");
  require(lights.to_key.allFinite() && lights.to_key.norm() > 0, "lights.to_key must be finite and not zero");
  require(lights.key_strength >= 0 && lights.key_strength <= 100, "lights.key_strength must be in [0, 100]");
  require(lights.ambient_strength >= 0 && lights.ambient_strength <= 100,
          "lights.ambient_strength must be in [0, 100]");
  require(std::isfinite(floor.height), "the height of the ground is not finite");
  require(floor.spacing >= 0 && std::isfinite(floor.spacing),
          "the spacing of the grid must be positive, or 0 for automatic");
}

}  // namespace

FrameBlock frame_block(const Picture& picture, const std::vector<AlignedBox3f>& boxes,
                       const PassSizes& sizes) {
  const Camera& camera = picture.camera;
  const Picture::Ground& floor = picture.ground;
  const Picture::Lights& lights = picture.lights;
  const Vector3d eye = camera.eye - camera.target;
  const double distance = eye.norm();
  check_settings(picture, eye);

  FrameBlock frame;
  const double aspect = static_cast<double>(sizes.width) / sizes.height;
  frame.view_projection = view_projection(camera, aspect).cast<float>();
  frame.eye = with(eye.cast<float>(), static_cast<float>(kNear * distance));
  frame.to_key = with(lights.to_key.normalized(), 0);
  frame.key = color(lights.key, "lights.key", lights.key_strength);
  frame.sky = color(lights.sky, "lights.sky", lights.ambient_strength);
  frame.bounce = color(lights.bounce, "lights.bounce", lights.ambient_strength);
  frame.background_top = color(picture.background.top, "background.top");
  frame.background_bottom = color(picture.background.bottom, "background.bottom");
  frame.ground = color(floor.color, "ground.color", 1, static_cast<float>(floor.height - camera.target[2]));
  frame.grid_color = color(floor.grid_color, "ground.grid_color");
  const Vector4f lit = frame.key * std::max(frame.to_key[2], 0.0f) + frame.sky;
  for (int i = 0; i < 4; ++i) frame.ground_ambient[i] = lit[i] > 0 ? frame.sky[i] / lit[i] : 1;

  const double view_height = 2 * distance * std::tan(camera.field_of_view * kDegree / 2);
  const double spacing = floor.spacing > 0 ? floor.spacing : automatic_spacing(view_height);
  for (int i = 0; i < 2; ++i)
    frame.grid[i] = static_cast<float>(std::remainder(camera.target[i], 5 * spacing) / spacing);
  frame.grid[2] = static_cast<float>(spacing);
  frame.grid[3] = 0;

  double radius = 0;
  for (const AlignedBox3f& box : boxes)
    radius = std::max<double>(radius, box.min().cwiseAbs().cwiseMax(box.max().cwiseAbs()).head<2>().norm());
  const double outer = std::max(3.4 * distance, std::min(1.5 * radius, kShadowReach * distance));
  frame.fade << static_cast<float>(0.22 * outer), static_cast<float>(outer), 0, 0;
  const auto samples = static_cast<float>(sizes.samples);
  frame.viewport << samples * static_cast<float>(sizes.width), samples * static_cast<float>(sizes.height),
      1.0f / static_cast<float>(sizes.shadow_side), 0.5f * samples;
  fit_shadow(frame, boxes, distance, sizes.shadow_side);
  fit_contact(frame, boxes, distance, sizes.contact_side);
  return frame;
}

}  // namespace pliant
