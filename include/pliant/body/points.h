// Points that forces, springs and tracks attach to: material points of parts, and points of the world.
#pragma once

#include <pliant/math/time_function.h>
#include <pliant/part/part.h>

namespace pliant {

/// A material point of a part, or a point of the world that may move in time.
struct Point {
  const Part* part = nullptr;  ///< nullptr: the world
  Material<double> material;
  TimeVector world;  ///< m; used when part is nullptr
  /// Of a part that deforms locally: what acts here is spread over the nodes within this radius (m, at rest),
  /// and the point is where their mean is; 0: the element around it.
  double patch = 0;
};

/// The first kink, of times later than one and no later than another (s), of how hands move a point: one of
/// the world, or of a part that moves as prescribed.
inline Kink first_kink(const Point& point, double after, double until) {
  if (point.part == nullptr) return point.world.first_kink(after, until);
  const PrescribedMotion* motion = point.part->motion();
  return motion == nullptr ? Kink() : motion->first_kink(after, until);
}

/// A material point by its angles (rad) and radius; w = 1 is the surface.
inline Point point(const Part& part, double u, double v, double w = 1) {
  return {&part, material_at(u, v, w), {}, 0};
}
inline Point point(const Part& part, const Material<double>& material, double patch = 0) {
  return {&part, material, {}, patch};
}
/// A fixed or moving point of the world.
inline Point world(double x, double y, double z) {
  return {nullptr, {}, TimeVector(Vec3<double>(x, y, z)), 0};
}
inline Point world(TimeVector moving) {
  return {nullptr, {}, std::move(moving), 0};
}

}  // namespace pliant
