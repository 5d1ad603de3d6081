// Energies of solids chosen at run time, by law and by the nodes of an element.
#pragma once

#include <memory>

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>

namespace pliant {

enum class SolidLaw { linear, averaged_linear, st_venant_kirchhoff, neo_hookean, corotated };

/// rest: positions of the nodes, m. elements: 4, 10 or 15 rows. Throws std::invalid_argument as the energies
/// do.
std::unique_ptr<NodalEnergy> make_solid_energy(SolidLaw law, const Nodes& rest,
                                               const Eigen::MatrixXi& elements, const Elasticity& material);

}  // namespace pliant
