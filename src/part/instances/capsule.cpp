#include <pliant/part/primitive.h>
#include <pliant/shape/capsule.h>

namespace pliant {
template class Primitive<Capsule, AnyChain>;
}  // namespace pliant
