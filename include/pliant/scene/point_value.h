// The JSON value of a material point: {"u", "v", "w"}, {"direction": [x, y, z], "w"} or {"near": [x, y, z]}.
#pragma once

#include <pliant/math/types.h>
#include <pliant/scene/json/json_value.h>
#include <pliant/scene/schema/schema.h>

namespace pliant {

/// A material point as written in a scene. PointReader resolves it at the rest shape of the part.
struct MaterialPointValue {
  enum class Form {
    kCoordinates,  ///< x = (u, v, w); u and v in rad
    kDirection,    ///< x = direction from the origin of the body frame, not zero, of arbitrary length
    kNear  ///< x = position in the body frame (m). Inside a solid: the material point there. Inside a shell,
           ///< or outside and at most twice as far out as the surface: the surface point with the same u, v.
  };
  Form form = Form::kCoordinates;
  Vec3<double> x = Vec3<double>::Zero();
  double w = 1;      ///< radial coordinate: 0 at the centre, 1 on the surface; not used by kNear
  double patch = 0;  ///< radius over which a load is spread among nodes, m; 0: no patch
};

namespace schema {

/// The type of a material point.
Type material_point();

}  // namespace schema

/// Returns the point that a validated value of type schema::material_point describes.
MaterialPointValue read_material_point(const JsonValue& value);

}  // namespace pliant
