// Makes a part of the shape number I of AllShapes. Each is defined in a file of its own
// (primitive_instance.cpp.in).
#pragma once

#include <memory>
#include <string>
#include <tuple>

#include <pliant/part/primitive.h>
#include <pliant/shape/all_shapes.h>

namespace pliant {

template <int I>
std::unique_ptr<Part> make_primitive(std::string name, double density, AnyChain chain);

}  // namespace pliant
