// Points that joints, springs, forces and tracks refer to: material points of parts, and points of the world.
#pragma once

#include <pliant/math/time_function.h>
#include <pliant/part/part.h>

namespace pliant {

/// A material point of a part, or a point of the world, which may move in time.
struct Point {
  const Part* part = nullptr;  ///< nullptr: a point of the world
  Material<double> material;   ///< the material point of the part
  TimeVector world;            ///< position of a point of the world, m
  /// For a part that deforms by nodes: radius (m, at rest) of a patch of nodes around the material point. The
  /// position of the point is then a weighted mean over these nodes, and a force on the point is distributed
  /// to these nodes. 0: the nodes of the element around the material point.
  double patch = 0;
};

/// Returns the first kink (math/time_function.h) of the prescribed motion of a point, later than `after` and
/// no later than `until` (s). If there is no kink, the time of the result is infinite.
inline Kink first_kink(const Point& point, double after, double until) {
  if (point.part == nullptr) return point.world.first_kink(after, until);
  const PrescribedMotion* motion = point.part->motion();
  return motion == nullptr ? Kink() : motion->first_kink(after, until);
}

/// Returns a material point of a part. u, v: its angles, rad; w: from 0 at the centre to 1 on the surface.
inline Point point(const Part& part, double u, double v, double w = 1) {
  return {&part, material_at(u, v, w), {}, 0};
}
inline Point point(const Part& part, const Material<double>& material, double patch = 0) {
  return {&part, material, {}, patch};
}
/// Returns a fixed or moving point of the world, m.
inline Point world(double x, double y, double z) {
  return {nullptr, {}, TimeVector(Vec3<double>(x, y, z)), 0};
}
inline Point world(TimeVector moving) {
  return {nullptr, {}, std::move(moving), 0};
}

}  // namespace pliant
