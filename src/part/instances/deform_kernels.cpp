// The kernels of all deformations, compiled once.
#include <pliant/part/instances/kernel_instances.h>

namespace pliant {

#define PLIANT_DEFINE_DEFORM(Deform) PLIANT_DEFORM_KERNELS(, Deform)
PLIANT_ALL_DEFORMS(PLIANT_DEFINE_DEFORM)

}  // namespace pliant
