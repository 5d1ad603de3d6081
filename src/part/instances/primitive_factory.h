// The factory of parts by the number of their shape.
#pragma once

#include <memory>
#include <string>
#include <tuple>

#include <pliant/part/primitive.h>
#include <pliant/shape/all_shapes.h>

namespace pliant {

/// Returns a new part of shape number I of AllShapes. CMake generates the source file of each I from
/// primitive_instance.cpp.in.
template <int I>
std::unique_ptr<Part> make_primitive(std::string name, double density, AnyChain chain);

}  // namespace pliant
