// Reading points of a scene, on parts or of the world. Part names are resolved to parts, and directions and
// positions to material points.
#pragma once

#include <map>
#include <optional>
#include <string>

#include <pliant/body/points.h>
#include <pliant/scene/reader/reader.h>

#include "scene/scene_faults.h"
#include "time_reader.h"

namespace pliant {

/// A name of a part in the scene, and the part if it could be made.
struct NamedPart {
  const JsonValue* name = nullptr;  ///< the value of its key "name"
  Part* part = nullptr;             ///< null if the part could not be made
  bool prepared = false;            ///< whether points on the part can be resolved
};

class PointReader {
 public:
  /// parts: the parts by name. end: end of the run, s.
  PointReader(const std::map<std::string, NamedPart>& parts, double end, SceneFaults& faults)
      : parts_(parts), times_(end, faults), faults_(faults) {}

  /// Returns the part that a key names, or null. An unknown name is reported.
  Part* part(const Reader& r, const char* key = "part") const;
  /// Returns the point {"part", "at"}, or std::nullopt if it cannot be resolved; faults are reported.
  std::optional<Point> on_part(const Reader& r) const;
  /// Returns the point {"part", "at"} or {"world"}, or std::nullopt if it cannot be resolved; faults are
  /// reported.
  std::optional<Point> anywhere(const Reader& r) const;
  /// Returns the point under a key of a spring or joint, read by anywhere(), or std::nullopt if the key is
  /// absent or faulty.
  std::optional<Point> end(const Reader& r, const char* key) const;
  /// Returns the first time in (after, until] and within the run (s) at which the position of a moving point
  /// of the world jumps, or std::nullopt. The path is searched in 256 intervals.
  std::optional<double> jump(const Point& point, double after, double until) const;

 private:
  const NamedPart* named(const Reader& r, const char* key = "part") const;
  std::optional<Material<double>> material(const Part& part, const JsonValue& at) const;

  const std::map<std::string, NamedPart>& parts_;
  TimeReader times_;
  SceneFaults& faults_;
};

/// Returns whether two material points are identical.
bool same_point(const Material<double>& a, const Material<double>& b);

/// Returns the position of a point at time 0 (m, world) with the initial parameters of its part. Local
/// deformation is ignored.
Vec3<double> position_at_start(const Point& point);

}  // namespace pliant
