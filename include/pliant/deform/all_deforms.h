// The list of global deformations. A new deformation needs its own file, included here, and an entry in
// PLIANT_ALL_DEFORMS. The registry, the explicit instances, the schema, `pliant list` and the law tests
// follow from this list.
#pragma once

#include <tuple>

#include <pliant/deform/bend.h>
#include <pliant/deform/bend_offset.h>
#include <pliant/deform/shear.h>
#include <pliant/deform/taper.h>
#include <pliant/deform/twist.h>

namespace pliant {

/// Expands X(Deform) for each deformation of the list.
#define PLIANT_ALL_DEFORMS(X) \
  X(Taper)                    \
  X(Twist)                    \
  X(Shear)                    \
  X(Bend)                     \
  X(BendOffset)

#define PLIANT_AS_TUPLE(Deform) std::tuple<Deform>(),
using AllDeforms = decltype(std::tuple_cat(PLIANT_ALL_DEFORMS(PLIANT_AS_TUPLE) std::tuple<>()));
#undef PLIANT_AS_TUPLE

}  // namespace pliant
