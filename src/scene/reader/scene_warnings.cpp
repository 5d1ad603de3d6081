#include "scene_warnings.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/math/types.h>

namespace pliant {
namespace {

/// Largest ratio of the sizes of two parts without a warning.
constexpr double kMaxSizeRatio = 1e6;

void warn_about_sizes(const Scene& scene, const Reader& root, SceneFaults& faults) {
  const auto& parts = scene.body.parts();
  if (parts.empty()) return;
  const auto [smallest, largest] =
      std::minmax_element(parts.begin(), parts.end(),
                          [](const auto& one, const auto& other) { return one->size() < other->size(); });
  const double ratio = (*largest)->size() / (*smallest)->size();
  if (!(ratio > kMaxSizeRatio)) return;
  const std::vector<Reader> readers = root.objects("parts");
  faults.warn(readers[static_cast<std::size_t>(largest - parts.begin())].at("name"),
              "the size of this part, " + brief((*largest)->size()) + " m, is " + brief(ratio) +
                  " times that of part \"" + (*smallest)->name() + "\"; lengths are in metres");
}

/// Returns whether a ball is outside the cone that encloses the view of the camera. Such a ball is not in the
/// picture. The scene must give eye and target of the camera.
bool is_outside(const Scene& scene, const Vec3<double>& centre, double radius) {
  const Vec3<double> forward = (*scene.camera.target - *scene.camera.eye).normalized(),
                     to = centre - *scene.camera.eye;
  const double ahead = to.dot(forward), aside = (to - ahead * forward).norm();
  const double aspect = static_cast<double>(scene.width) / scene.height,
               half = 0.5 * scene.camera.field_of_view * kPi / 180,
               corner = std::atan(std::tan(half) * std::hypot(1, aspect));  // the widest angle of the picture
  return ahead + radius < 0 || aside * std::cos(corner) - ahead * std::sin(corner) > radius;
}

void warn_about_camera(const Scene& scene, const Reader& root, SceneFaults& faults) {
  if (!scene.camera.eye || !scene.camera.target) return;
  const auto& parts = scene.body.parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (!scene.appearance[i].visible || parts[i]->motion() != nullptr) continue;
    if (!is_outside(scene, parts[i]->c0(), 2 * parts[i]->size())) continue;
    const std::vector<Reader> readers = root.objects("parts");
    faults.warn(readers[i].at("name"), "the camera does not see this part at time 0");
    return;
  }
}

}  // namespace

void add_warnings(const Scene& scene, const Reader& root, SceneFaults& faults) {
  warn_about_sizes(scene, root, faults);
  warn_about_camera(scene, root, faults);
}

}  // namespace pliant
