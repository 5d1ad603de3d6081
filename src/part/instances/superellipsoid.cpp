#include <pliant/part/primitive.h>
#include <pliant/shape/superellipsoid.h>

namespace pliant {
template class Primitive<Superellipsoid, AnyChain>;
}  // namespace pliant
