// The list of global deformations. A new deformation needs its own file and an entry here. The registry, the
// schema, `pliant list` and the law tests follow from this list.
#pragma once

#include <tuple>

#include <pliant/deform/bend.h>
#include <pliant/deform/bend_offset.h>
#include <pliant/deform/shear.h>
#include <pliant/deform/taper.h>
#include <pliant/deform/twist.h>

namespace pliant {

using AllDeforms = std::tuple<Taper, Twist, Shear, Bend, BendOffset>;

}  // namespace pliant
