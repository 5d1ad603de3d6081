// The list of shapes. To add a shape, include its file here and add its struct to PLIANT_ALL_SHAPES. The
// registry, the explicit instantiations, the JSON Schema, `pliant list` and the tests of all shapes use this
// list.
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

/// Expands X(Shape) for each shape of the list.
#define PLIANT_ALL_SHAPES(X) \
  X(Superellipsoid)          \
  X(SuperellipsoidRadial)    \
  X(Ellipsoid)               \
  X(Sphere)                  \
  X(Cylinder)                \
  X(Cone)                    \
  X(Supertoroid)             \
  X(Capsule)                 \
  X(Box)

#define PLIANT_AS_TUPLE(Shape) std::tuple<Shape>(),
using AllShapes = decltype(std::tuple_cat(PLIANT_ALL_SHAPES(PLIANT_AS_TUPLE) std::tuple<>()));
#undef PLIANT_AS_TUPLE

}  // namespace pliant
