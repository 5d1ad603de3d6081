// The list of global deformations. To add a deformation, include its file here and add its struct to
// PLIANT_ALL_DEFORMS. The registry, the explicit instantiations, the JSON Schema, `pliant list` and the tests
// of all deformations use this list.
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
