#include <pliant/part/primitive.h>
#include <pliant/shape/superellipsoid_radial.h>

namespace pliant {
template class Primitive<SuperellipsoidRadial, AnyChain>;
}  // namespace pliant
