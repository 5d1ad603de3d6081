#include <pliant/part/primitive.h>
#include <pliant/shape/cone.h>

namespace pliant {
template class Primitive<Cone, AnyChain>;
}  // namespace pliant
