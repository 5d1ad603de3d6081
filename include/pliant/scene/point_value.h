// Material points in a scene: {"u", "v", "w"}, {"direction": [x, y, z], "w"} or {"near": [x, y, z]}.
#pragma once

#include <pliant/math/types.h>
#include <pliant/scene/json/json_value.h>
#include <pliant/scene/schema/schema.h>

namespace pliant {

/// A point of a part as the scene names it, to be resolved at the part's rest shape.
struct MaterialPointValue {
  enum class Form {
    kCoordinates,  ///< x = (u, v, w)
    kDirection,    ///< x = a direction from the centre, of any length but zero, and w
    kNear          ///< x = a place in the body frame (m): the point there; for a place outside, the surface
                   ///< point with its u and v
  };
  Form form = Form::kCoordinates;
  Vec3<double> x = Vec3<double>::Zero();
  double w = 1;      ///< 0 at the centre, 1 on the surface
  double patch = 0;  ///< radius, m; 0: none
};

namespace schema {

Type material_point();

}  // namespace schema

/// The point that a validated value of schema::material_point names.
MaterialPointValue read_material_point(const JsonValue& value);

}  // namespace pliant
