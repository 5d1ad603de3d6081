// The instances that scenes use, Primitive<Shape, AnyChain>, are compiled once in the library: one file a shape.
#pragma once

#include <pliant/part/primitive.h>
#include <pliant/shape/all_shapes.h>

namespace pliant {

extern template class Primitive<Superellipsoid, AnyChain>;
extern template class Primitive<SuperellipsoidRadial, AnyChain>;
extern template class Primitive<Ellipsoid, AnyChain>;
extern template class Primitive<Sphere, AnyChain>;
extern template class Primitive<Cylinder, AnyChain>;
extern template class Primitive<Cone, AnyChain>;
extern template class Primitive<Supertoroid, AnyChain>;
extern template class Primitive<Capsule, AnyChain>;
extern template class Primitive<Box, AnyChain>;

}  // namespace pliant
