// Signals: the quantities of the state that formulas read, for example the height of a part, the angle of a
// hinge or the length of a spring.
#pragma once

#include <pliant/body/joints/joint.h>
#include <pliant/body/points.h>

namespace pliant {

struct Sensor;

/// A quantity of the state. Positions and velocities are in the world; the angular velocity is in the body
/// frame.
struct Signal {
  enum class Kind {
    position,          ///< of the origin of the body frame of `part`, component `index`, m
    velocity,          ///< rate of the position, m/s
    angular_velocity,  ///< of `part`, component `index`, rad/s
    parameter,         ///< dynamic parameter `index` of `part`, in the order of q_s
    parameter_rate,    ///< rate of the parameter, per second
    point,             ///< position of point a, component `index`, m
    point_rate,        ///< velocity of point a, component `index`, m/s
    distance,          ///< distance of the points a and b, m
    distance_rate,     ///< rate of the distance, m/s
    coordinate,        ///< row `index` of `coordinate`, rad or m
    coordinate_rate,   ///< rate of the row, per second
    sensor,            ///< the value of `sensor`
    input,             ///< input `index` of the state (State::inputs)
    at_point           ///< quantity `index` of quantities_at_points(), for distributed forces only
  };
  Kind kind = Kind::position;
  const Part* part = nullptr;
  Point a, b;
  const Joint* coordinate = nullptr;  ///< a coordinate of MultiBody::coordinates()
  const Sensor* sensor = nullptr;
  int index = 0;
};

}  // namespace pliant
