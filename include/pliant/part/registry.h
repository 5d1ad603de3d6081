// Shapes and deformations by name, from the lists AllShapes and AllDeforms.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/deform/any_chain.h>
#include <pliant/part/part.h>

namespace pliant {

/// Every shape, in the order of the list.
const std::vector<std::unique_ptr<ShapeFace>>& all_shapes();

struct DeformationInfo {
  const char* name;
  const char* formula;
  std::vector<ParameterSpec> parameters;
};
/// Every deformation, in the order of the list.
const std::vector<DeformationInfo>& all_deformations();

/// A part of the named shape with the named chain of deformations, in that order.
/// Throws std::invalid_argument listing the names there are.
std::unique_ptr<Part> make_part(const std::string& name, const std::string& shape,
                                const std::vector<std::string>& deformations, double density);

}  // namespace pliant
