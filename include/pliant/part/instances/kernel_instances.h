// Explicit instances of the kernels of all shapes and deformations in the lists PLIANT_ALL_SHAPES and
// PLIANT_ALL_DEFORMS. src/part compiles each instance once; programs and the other sources of the library
// only declare the instances. A program compiles the kernels of its own shapes itself.
#pragma once

#include <pliant/deform/all_deforms.h>
#include <pliant/deform/chain.h>
#include <pliant/part/shape_interface.h>
#include <pliant/part/shape_jets.h>
#include <pliant/shape/all_shapes.h>

namespace pliant {

/// Declares (Linkage is extern) or defines (Linkage is empty) the instances of one shape.
#define PLIANT_SHAPE_KERNELS(Linkage, Shape)                                                            \
  Linkage template void shape_jets<Shape, double, Pack, Pack>(const LinkParameters<double>&,            \
                                                              const Material<Pack>*, JetBatch<Pack>&);  \
  Linkage template void shape_jets<Shape, Dual<1>, Dual<1, Pack>, Dual<1, Pack>>(                       \
      const LinkParameters<Dual<1>>&, const Material<Dual<1, Pack>>*, JetBatch<Dual<1, Pack>>&);        \
  Linkage template HalfHeight<double> half_height_jet<Shape, double>(const LinkParameters<double>&);    \
  Linkage template HalfHeight<Dual<1>> half_height_jet<Shape, Dual<1>>(const LinkParameters<Dual<1>>&); \
  Linkage template class ShapeInterfaceOf<Shape>;

/// Declares (Linkage is extern) or defines (Linkage is empty) the instances of one deformation.
#define PLIANT_DEFORM_KERNELS(Linkage, Deform)                                                            \
  Linkage template void apply_link<Deform, double, Pack>(const HalfHeight<double>&,                       \
                                                         const LinkParameters<double>&, JetBatch<Pack>&); \
  Linkage template void apply_link<Deform, Dual<1>, Dual<1, Pack>>(                                       \
      const HalfHeight<Dual<1>>&, const LinkParameters<Dual<1>>&, JetBatch<Dual<1, Pack>>&);              \
  Linkage template Vec3<double> link_inverse<Deform>(const Vec3<double>&, double, const double*);

#define PLIANT_EXTERN_SHAPE(Shape) PLIANT_SHAPE_KERNELS(extern, Shape)
#define PLIANT_EXTERN_DEFORM(Deform) PLIANT_DEFORM_KERNELS(extern, Deform)
PLIANT_ALL_SHAPES(PLIANT_EXTERN_SHAPE)
PLIANT_ALL_DEFORMS(PLIANT_EXTERN_DEFORM)
#undef PLIANT_EXTERN_SHAPE
#undef PLIANT_EXTERN_DEFORM

}  // namespace pliant
