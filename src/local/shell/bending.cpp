// Explicit instances of MidEdgeBending for both kinds of hinges.
#include <pliant/local/shell/bending-inl.h>

namespace pliant {

template class MidEdgeBending<LinearHinges>;
template class MidEdgeBending<FoldingHinges>;

}  // namespace pliant
