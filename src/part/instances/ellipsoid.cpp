#include <pliant/part/primitive.h>
#include <pliant/shape/ellipsoid.h>

namespace pliant {
template class Primitive<Ellipsoid, AnyChain>;
}  // namespace pliant
