// The list of joints. A new one is its file and an entry here; the law tests follow.
#pragma once

#include <tuple>

#include <pliant/body/joints/ball.h>
#include <pliant/body/joints/rod.h>
#include <pliant/body/joints/string.h>

namespace pliant {

using AllJoints = std::tuple<Ball, Rod, String>;

}  // namespace pliant
