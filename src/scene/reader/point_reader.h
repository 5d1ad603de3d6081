// Points of a scene, on parts or of the world: names resolved to parts, places to material points.
#pragma once

#include <map>
#include <optional>
#include <string>

#include <pliant/body/points.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"
#include "time_reader.h"

namespace pliant {

/// A part that the scene names, as far as it could be made.
struct NamedPart {
  const JsonValue* name = nullptr;  ///< where it is named
  Part* part = nullptr;             ///< null when it could not be made
  bool prepared = false;            ///< its points can be resolved
};

class PointReader {
 public:
  /// parts: by name. end: of the run, s.
  PointReader(const std::map<std::string, NamedPart>& parts, double end, SceneFaults& faults)
      : parts_(parts), times_(end, faults), faults_(faults) {}

  /// The part that a key names; null, with a fault if nobody is called so.
  Part* part(const Reader& r, const char* key = "part") const;
  /// {"part", "at"}; none when it could not be resolved.
  std::optional<Point> on_part(const Reader& r) const;
  /// {"part", "at"} or {"world"}.
  std::optional<Point> anywhere(const Reader& r) const;
  /// The same under a key of a spring or joint.
  std::optional<Point> end(const Reader& r, const char* key) const;
  /// The first time of the run, after one and no later than another (s), at which a point that is moved in
  /// time jumps in place, as far as many looks tell.
  std::optional<double> jump(const Point& point, double after, double until) const;

 private:
  const NamedPart* named(const Reader& r, const char* key = "part") const;
  std::optional<Material<double>> material(const Part& part, const JsonValue& at) const;

  const std::map<std::string, NamedPart>& parts_;
  TimeReader times_;
  SceneFaults& faults_;
};

bool same_point(const Material<double>& a, const Material<double>& b);

/// Where a point is at time 0, m.
Vec3<double> position_at_start(const Point& point);

}  // namespace pliant
