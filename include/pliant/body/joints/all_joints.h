// The list of joints. A new joint needs its file and an entry here; the registry, the schema, `pliant list`
// and the tests of the formulas (tests/body/joints.cpp) use this list.
#pragma once

#include <tuple>

#include <pliant/body/joints/ball.h>
#include <pliant/body/joints/hinge.h>
#include <pliant/body/joints/line.h>
#include <pliant/body/joints/plane.h>
#include <pliant/body/joints/rod.h>
#include <pliant/body/joints/slider.h>
#include <pliant/body/joints/string.h>
#include <pliant/body/joints/weld.h>

namespace pliant {

using AllJoints = std::tuple<Ball, Rod, String, Plane, Line, Hinge, Slider, Weld>;

}  // namespace pliant
