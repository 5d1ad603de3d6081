// Explicit instances of Membrane for both laws.
#include <pliant/local/shell/membrane-inl.h>

namespace pliant {

template class Membrane<StVenantKirchhoffSheet>;
template class Membrane<NeoHookeanSheet>;

}  // namespace pliant
