// Explicit instances of AveragedLinearSolid for every element.
#include <pliant/local/solid/averaged_dilatation-inl.h>

namespace pliant {

template class AveragedLinearSolid<LinearTetrahedron>;
template class AveragedLinearSolid<QuadraticTetrahedron>;
template class AveragedLinearSolid<EnrichedTetrahedron>;

}  // namespace pliant
