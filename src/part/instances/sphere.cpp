#include <pliant/part/primitive.h>
#include <pliant/shape/sphere.h>

namespace pliant {
template class Primitive<Sphere, AnyChain>;
}  // namespace pliant
