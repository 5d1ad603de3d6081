#include <pliant/scene/point_value.h>

#include <pliant/math/scalar/functions.h>
#include <pliant/scene/reader/reader.h>

namespace pliant {

namespace schema {

namespace {

/// Pi, as people write it.
constexpr double kMaxAngle = 3.1416;

Field radial() {
  return optional("w", number(between(0, 1), "1"), "Radial coordinate: 0 at the centre, 1 on the surface.",
                  "1");
}

Field patch() {
  return optional("patch", number(above(0), "m"),
                  "Of a part with local deformation: what acts here is spread over the nodes within this "
                  "radius, and the point is where their mean is. The element around it when not given.");
}

Record by_coordinates() {
  return {"point_at_coordinates",
          "A material point by its coordinates.",
          {required("u", number(between(-kMaxAngle, kMaxAngle), "rad"),
                    "Latitude of the shape, from -pi/2 to pi/2; round the tube of a torus.", "0"),
           required("v", number(between(-kMaxAngle, kMaxAngle), "rad"), "Longitude of the shape.", "0"),
           radial(), patch()}};
}

Record by_direction() {
  const Check not_zero = [](const JsonValue& value, const ReportAt& report) {
    if (read_vector3(value).isZero(0)) report(value, "expected a direction that is not zero", kWholeValue);
  };
  return {
      "point_in_direction",
      "The material point of the rest shape that lies in a direction from the origin of the part's frame: "
      "the outermost one of the surface, and with w the point inside with the same u and v.",
      {required("direction", vector3("1").checked(not_zero), "Direction in the part's frame, of any length.",
                "[0, 0, 1]"),
       radial(), patch()}};
}

Record by_place() {
  return {
      "point_near",
      "The material point at a place of the rest shape; for a place outside, at most twice as far out as the "
      "surface, the surface point with "
      "the same u and v.",
      {required("near", vector3("m"), "Place in the part's frame.", "[0, 0, 1]"), patch()}};
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
