// Shapes and deformations by name, from the lists AllShapes (shape/all_shapes.h) and AllDeforms
// (deform/all_deforms.h).
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/deform/any_chain.h>
#include <pliant/part/part.h>

namespace pliant {

/// Returns every shape, in the order of AllShapes.
const std::vector<std::unique_ptr<ShapeInterface>>& all_shapes();

struct DeformationInfo {
  const char* name;
  const char* formula;
  std::vector<ParameterSpec> parameters;
};
/// Returns every deformation, in the order of AllDeforms.
const std::vector<DeformationInfo>& all_deformations();

/// Returns a new part with the named shape and a chain of the named deformations, applied in this order.
/// density: kg/m^3 of a solid, kg/m^2 of a shell. Throws std::invalid_argument if the name of the shape or of
/// a deformation is unknown; the message lists the known names.
std::unique_ptr<Part> make_part(const std::string& name, const std::string& shape,
                                const std::vector<std::string>& deformations, double density);

}  // namespace pliant
