// The list of shapes. A new shape needs its own file and an entry here. The registry, the explicit instances,
// the schema, `pliant list` and the law tests follow from this list.
#pragma once

#include <tuple>

#include <pliant/shape/box.h>
#include <pliant/shape/capsule.h>
#include <pliant/shape/cone.h>
#include <pliant/shape/cylinder.h>
#include <pliant/shape/ellipsoid.h>
#include <pliant/shape/sphere.h>
#include <pliant/shape/superellipsoid.h>
#include <pliant/shape/superellipsoid_radial.h>
#include <pliant/shape/supertoroid.h>

namespace pliant {

using AllShapes = std::tuple<Superellipsoid, SuperellipsoidRadial, Ellipsoid, Sphere, Cylinder, Cone,
                             Supertoroid, Capsule, Box>;

}  // namespace pliant
