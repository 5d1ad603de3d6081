// Factory of solid energies by law and number of nodes of an element.
#include <pliant/local/solid/make_solid_energy.h>

#include <stdexcept>
#include <string>

#include <pliant/local/solid/averaged_dilatation.h>
#include <pliant/local/solid/solid_energy.h>

namespace pliant {

namespace {

template <class Element>
std::unique_ptr<NodalEnergy> make(SolidLaw law, const Nodes& rest, const Eigen::MatrixXi& elements,
                                  const Elasticity& material) {
  switch (law) {
    case SolidLaw::linear:
      return std::make_unique<LinearSolid<Element>>(rest, elements, LinearLaw(material));
    case SolidLaw::averaged_linear:
      return std::make_unique<AveragedLinearSolid<Element>>(rest, elements, material);
    case SolidLaw::st_venant_kirchhoff:
      return std::make_unique<SolidEnergy<Element, StVenantKirchhoff>>(rest, elements,
                                                                       StVenantKirchhoff(material));
    case SolidLaw::neo_hookean:
      return std::make_unique<SolidEnergy<Element, NeoHookean>>(rest, elements, NeoHookean(material));
    case SolidLaw::neo_hookean_log:
      return std::make_unique<SolidEnergy<Element, NeoHookeanLog>>(rest, elements, NeoHookeanLog(material));
    case SolidLaw::corotated:
      return std::make_unique<SolidEnergy<Element, Corotated>>(rest, elements, Corotated(material));
  }
  throw std::logic_error("make_solid_energy: unknown law of solids");
}

}  // namespace

std::unique_ptr<NodalEnergy> make_solid_energy(SolidLaw law, const Nodes& rest,
                                               const Eigen::MatrixXi& elements, const Elasticity& material) {
  if (elements.rows() == LinearTetrahedron::n_nodes)
    return make<LinearTetrahedron>(law, rest, elements, material);
  if (elements.rows() == QuadraticTetrahedron::n_nodes)
    return make<QuadraticTetrahedron>(law, rest, elements, material);
  if (elements.rows() == EnrichedTetrahedron::n_nodes)
    return make<EnrichedTetrahedron>(law, rest, elements, material);
  throw std::invalid_argument("elements have " + std::to_string(elements.rows()) +
                              " nodes; solids need elements with 4, 10 or 15");
}

}  // namespace pliant
