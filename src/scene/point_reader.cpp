#include "point_reader.h"

#include <algorithm>
#include <cmath>

#include <pliant/scene/point_value.h>

namespace pliant {

namespace {

/// Angles are often written with few digits, 1.5708 for a pole.
constexpr double kAngleRounding = 1e-4;

/// Places this far outside, as the inside-outside function tells it, lie near no point of the body.
constexpr double kFarOutside = 1;

/// Where the ray from the part's origin leaves its rest shape for good.
std::optional<Vec3<double>> surface_towards(const Part& part, const Vec3<double>& direction) {
  const Vec3<double> ray = direction.stableNormalized() * part.size();
  auto inside = [&](double t) { return part.inside_outside(t * ray, part.parameters().rest()) < 0; };
  constexpr int steps = 256;
  constexpr double beyond = 1.75;  // more than sqrt(3) times the largest coordinate
  for (int i = steps - 1; i >= 0; --i) {
    double in = beyond * i / steps, out = beyond * (i + 1) / steps;
    if (!inside(in)) continue;
    for (double middle = 0.5 * (in + out); middle > in && middle < out; middle = 0.5 * (in + out))
      (inside(middle) ? in : out) = middle;
    return Vec3<double>(out * ray);
  }
  return {};
}

}  // namespace

const NamedPart* PointReader::named(const Reader& r) const {
  if (!r.given("part")) return nullptr;
  const auto found = parts_.find(r.text("part"));
  if (found != parts_.end()) return &found->second;
  std::vector<std::string> names;
  for (const auto& [name, part] : parts_) names.push_back(name);
  faults_.unknown(r.at("part"), "part", names);
  return nullptr;
}

Part* PointReader::part(const Reader& r) const {
  const NamedPart* found = named(r);
  return found != nullptr ? found->part : nullptr;
}

std::optional<Point> PointReader::on_part(const Reader& r) const {
  const NamedPart* found = named(r);
  if (found == nullptr || !found->prepared || !r.given("at")) return {};
  const auto at = material(*found->part, r.at("at"));
  if (!at) return {};
  return point(*found->part, *at);
}

std::optional<Point> PointReader::anywhere(const Reader& r) const {
  if (r.record().find("world") == nullptr) return on_part(r);
  const std::optional<TimeVector> moving = times_.vector(r, "world", Needs::value_and_rate);
  if (!moving) return {};
  return world(*moving);
}

/// Resolved at the rest shape.
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
      m.w = by_direction ? value.w : std::min(m.w, 1.0);
      return m;
    }
  }
  faults_.value(
      *at.find(by_direction ? "direction" : "near"),
      "no material point of part \"" + part.name() + "\" lies there; expected a place on its rest shape");
  return {};
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
