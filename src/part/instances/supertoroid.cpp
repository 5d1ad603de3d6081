#include <pliant/part/primitive.h>
#include <pliant/shape/supertoroid.h>

namespace pliant {
template class Primitive<Supertoroid, AnyChain>;
}  // namespace pliant
