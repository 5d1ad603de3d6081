// The list of joints. A new one is its file and an entry here; registry, schema, `pliant list` and the law
// tests follow.
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
