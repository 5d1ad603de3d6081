#include "point_reader.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include <pliant/scene/point_value.h>

namespace pliant {

namespace {

/// Tolerance of a latitude, rad: users write rounded angles, for example 1.5708 for a pole.
constexpr double kAngleRounding = 1e-4;

/// A position outside the part is projected to the surface if w - 1 is below this number. w is the radial
/// coordinate, 1 on the surface.
constexpr double kFarOutside = 1;

/// Returns the outermost intersection (m, body frame) of the rest shape with a ray from the origin of the
/// frame, or std::nullopt if there is no intersection.
std::optional<Vec3<double>> surface_towards(const Part& part, const Vec3<double>& direction) {
  const Vec3<double> ray = direction.stableNormalized() * part.size();
  auto outside = [&](double t) {
    try {
      const double value = part.inside_outside(t * ray, part.parameters().rest());
      return std::isnan(value) ? kInfinity : value;
    } catch (const std::runtime_error&) {  // no material point maps to this position
      return kInfinity;
    }
  };
  constexpr int steps = 256;
  constexpr double spacing = 1.75 / steps;  // in sizes of the part; no point is farther than sqrt(3) sizes
  std::array<double, steps + 1> sample{};
  for (int i = 0; i <= steps; ++i) sample[static_cast<std::size_t>(i)] = outside(spacing * i);
  for (int i = steps - 1; i >= 0; --i) {
    double in = spacing * i, out = spacing * (i + 1);
    const auto at = static_cast<std::size_t>(i);
    if (!(sample[at] < 0)) {
      // Between samples that are all outside, a part thinner than the spacing can only be near a minimum of
      // outside(). A golden section search finds this minimum.
      if (i == 0 || sample[at] > sample[at - 1] || sample[at] > sample[at + 1]) continue;
      constexpr double golden = 0.6180339887498949;
      double low = spacing * (i - 1), high = out;
      while (high - low > 1e-12 && !(outside(in) < 0)) {
        const double left = high - golden * (high - low), right = low + golden * (high - low);
        if (outside(left) < outside(right))
          high = right, in = left;
        else
          low = left, in = right;
      }
      if (!(outside(in) < 0)) continue;
    }
    for (double middle = 0.5 * (in + out); middle > in && middle < out; middle = 0.5 * (in + out))
      (outside(middle) < 0 ? in : out) = middle;
    return Vec3<double>(out * ray);
  }
  return {};
}

}  // namespace

const NamedPart* PointReader::named(const Reader& r, const char* key) const {
  if (!r.given(key)) return nullptr;
  const auto found = parts_.find(r.text(key));
  if (found != parts_.end()) return &found->second;
  std::vector<std::string> names;
  for (const auto& [name, part] : parts_) names.push_back(name);
  faults_.unknown(r.at(key), "part", names);
  return nullptr;
}

Part* PointReader::part(const Reader& r, const char* key) const {
  const NamedPart* found = named(r, key);
  return found != nullptr ? found->part : nullptr;
}

std::optional<Point> PointReader::on_part(const Reader& r) const {
  const NamedPart* found = named(r);
  if (found == nullptr || !found->prepared || !r.given("at")) return {};
  const auto at = material(*found->part, r.at("at"));
  if (!at) return {};
  const double patch = read_material_point(r.at("at")).patch;
  if (patch > 0 && found->part->local() == nullptr) {
    faults_.value(*r.at("at").find("patch"), "a patch selects nodes, and part \"" + found->part->name() +
                                                 "\" has no local deformation; expected no \"patch\"");
    return {};
  }
  return point(*found->part, *at, patch);
}

std::optional<Point> PointReader::anywhere(const Reader& r) const {
  if (r.record().find("world") == nullptr) return on_part(r);
  const std::optional<TimeVector> moving = times_.vector(r, "world", Needs::value_and_rate);
  if (!moving) return {};
  return world(*moving);
}

std::optional<Point> PointReader::end(const Reader& r, const char* key) const {
  if (!r.given(key)) return {};
  return anywhere(r.object(key));
}

std::optional<double> PointReader::jump(const Point& point, double after, double until) const {
  constexpr int intervals = 256;
  const double end = std::min(until, times_.end());
  double low = after;
  for (int i = 1; i <= intervals; ++i) {
    const double high = i == intervals ? end : after + (end - after) * i / intervals;
    for (Kink kink = first_kink(point, low, high); std::isfinite(kink.time);
         kink = first_kink(point, kink.time, high))
      if (kink.jumps) return kink.time;
    low = high;
  }
  return {};
}

/// Returns the material point that a value describes, resolved at the rest shape, or std::nullopt after a
/// fault.
std::optional<Material<double>> PointReader::material(const Part& part, const JsonValue& at) const {
  using Form = MaterialPointValue::Form;
  const MaterialPointValue value = read_material_point(at);
  const bool torus = part.shape().mesh() == MeshPattern::torus;
  if (value.form == Form::kCoordinates) {
    if (torus) return material_at(value.x[0], value.x[1], value.x[2]);
    if (std::abs(value.x[0]) > kPi / 2 + kAngleRounding) {
      faults_.value(*at.find("u"), "expected a latitude in [-1.5708, 1.5708] (rad) on a " +
                                       std::string(part.shape().name()));
      return {};
    }
    return material_at(std::clamp(value.x[0], -kPi / 2, kPi / 2), value.x[1], value.x[2]);
  }
  if (value.form == Form::kDirection && torus) {
    faults_.value(
        *at.find("direction"),
        "a torus has several points in a direction; expected {\"u\", \"v\", \"w\"} or {\"near\": [x, y, z]}");
    return {};
  }
  const bool by_direction = value.form == Form::kDirection;
  const std::optional<Vec3<double>> place = by_direction ? surface_towards(part, value.x) : value.x;
  if (place) {
    Material<double> m = part.label(*place, part.parameters().rest());
    if (by_direction || m.w - 1 < kFarOutside) {
      m.w =
          by_direction ? value.w : (std::abs(m.w - 1) < kFarOutside && part.shell() ? 1 : std::min(m.w, 1.0));
      return m;
    }
  }
  faults_.value(
      *at.find(by_direction ? "direction" : "near"),
      "part \"" + part.name() + "\" has no material point there; expected a place on its rest shape");
  return {};
}

bool same_point(const Material<double>& a, const Material<double>& b) {
  return a.cu.x == b.cu.x && a.su.x == b.su.x && a.cv.x == b.cv.x && a.sv.x == b.sv.x && a.w == b.w;
}

Vec3<double> position_at_start(const Point& point) {
  if (point.part == nullptr) return point.world.value(0);
  const Part& part = *point.part;
  ParameterValues<double> values = part.parameters().rest();
  for (const int i : part.parameters().dynamic())
    values.b[static_cast<std::size_t>(i)] = part.parameters()[i].initial;
  return part.c0() + part.R0() * Vec3<double>(part.s({point.material}, values).col(0));
}

}  // namespace pliant
