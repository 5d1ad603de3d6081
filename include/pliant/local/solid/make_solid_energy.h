// Factory of solid energies: the law and the number of nodes of an element are chosen at run time.
#pragma once

#include <memory>

#include <pliant/local/elasticity.h>
#include <pliant/local/nodal_energy.h>

namespace pliant {

enum class SolidLaw { linear, averaged_linear, st_venant_kirchhoff, neo_hookean, neo_hookean_log, corotated };

/// Returns the energy of a solid. rest: positions of the nodes at rest, m. elements: 4, 10 or 15 node numbers
/// in each column. Throws std::invalid_argument for another number of rows, and the errors of the
/// constructors of SolidEnergy and AveragedLinearSolid.
std::unique_ptr<NodalEnergy> make_solid_energy(SolidLaw law, const Nodes& rest,
                                               const Eigen::MatrixXi& elements, const Elasticity& material);

}  // namespace pliant
