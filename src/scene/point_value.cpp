#include <pliant/scene/point_value.h>

#include <pliant/math/scalar/functions.h>
#include <pliant/scene/reader/reader.h>

namespace pliant {

namespace schema {

namespace {

/// Pi rounded up, so that a rounded pi is accepted.
constexpr double kMaxAngle = 3.1416;

Field radial() {
  return optional("w", number(between(0, 1), "1"), "Radial coordinate: 0 at the centre, 1 on the surface.",
                  "1");
}

Field patch() {
  return optional("patch", number(above(0), "m"),
                  "For a part with local deformation: radius around the point. A load is spread over the "
                  "nodes within this radius, and the position of the point is their mean. When absent, the "
                  "element that contains the point is used.");
}

Record by_coordinates() {
  return {
      "point_at_coordinates",
      "A material point by its coordinates.",
      {required("u", number(between(-kMaxAngle, kMaxAngle), "rad"),
                "Latitude of the shape, from -pi/2 to pi/2; for a torus, the angle around the tube.", "0"),
       required("v", number(between(-kMaxAngle, kMaxAngle), "rad"), "Longitude of the shape.", "0"), radial(),
       patch()}};
}

Record by_direction() {
  const Check not_zero = [](const JsonValue& value, const ReportAt& report) {
    if (read_vector3(value).isZero(0)) report(value, "expected a direction that is not zero", kWholeValue);
  };
  return {"point_in_direction",
          "A material point of the rest shape, given by a direction from the origin of the part's frame: the "
          "outermost surface point in this direction; with w < 1, the interior point with the same u and v.",
          {required("direction", vector3("1").checked(not_zero),
                    "Direction in the part's frame; its length does not matter.", "[0, 0, 1]"),
           radial(), patch()}};
}

Record by_place() {
  return {"point_near",
          "A material point of the rest shape, given by its position. A position outside the part, at most "
          "twice as far out as the surface, gives the surface point with the u and v of this position.",
          {required("near", vector3("m"), "Position in the part's frame.", "[0, 0, 1]"), patch()}};
}

}  // namespace

Type material_point() {
  return one_of({record(by_coordinates()), record(by_direction()), record(by_place())})
      .expecting(
          "a material point {\"u\", \"v\", \"w\"}, {\"direction\": [x, y, z], \"w\"} or {\"near\": [x, y, "
          "z]}")
      .defined_as("material_point");
}

}  // namespace schema

MaterialPointValue read_material_point(const JsonValue& value) {
  using Form = MaterialPointValue::Form;
  const JsonValue* radius = value.find("patch");
  const double patch = radius != nullptr ? radius->number() : 0;
  if (const JsonValue* near = value.find("near")) return {Form::kNear, read_vector3(*near), 1, patch};
  const JsonValue* w = value.find("w");
  const double radial = w != nullptr ? w->number() : 1;
  if (const JsonValue* direction = value.find("direction")) {
    return {Form::kDirection, read_vector3(*direction), radial, patch};
  }
  return {Form::kCoordinates, {value.find("u")->number(), value.find("v")->number(), radial}, radial, patch};
}

}  // namespace pliant
