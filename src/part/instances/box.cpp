#include <pliant/part/primitive.h>
#include <pliant/shape/box.h>

namespace pliant {
template class Primitive<Box, AnyChain>;
}  // namespace pliant
