#include <pliant/part/primitive.h>
#include <pliant/shape/cylinder.h>

namespace pliant {
template class Primitive<Cylinder, AnyChain>;
}  // namespace pliant
