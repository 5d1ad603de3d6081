// The factory of parts by the number of their shape.
#pragma once

#include <memory>
#include <string>
#include <tuple>

#include <pliant/part/primitive.h>
#include <pliant/shape/all_shapes.h>

namespace pliant {

/// Makes a part of shape number I of AllShapes. CMake generates one source file for each I from
/// primitive_instance.cpp.in.
template <int I>
std::unique_ptr<Part> make_primitive(std::string name, double density, AnyChain chain);

}  // namespace pliant
