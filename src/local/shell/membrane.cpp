// Explicit instances of Membrane for all laws.
#include <pliant/local/shell/membrane-inl.h>

namespace pliant {

template class Membrane<StVenantKirchhoffSheet>;
template class Membrane<NeoHookeanSheet>;
template class Membrane<NeoHookeanLogSheet>;

}  // namespace pliant
