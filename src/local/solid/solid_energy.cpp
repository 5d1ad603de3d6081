// Explicit instances of SolidEnergy for every element and law.
#include <pliant/local/solid/solid_energy-inl.h>

namespace pliant {

PLIANT_SOLID_ENERGIES()

}  // namespace pliant
