#include "drive_schema.h"

#include <utility>

#include <pliant/scene/time_value.h>

namespace pliant {

using namespace schema;

namespace {

/// The units of a drive on a coordinate.
struct Units {
  std::string coordinate, rate, stiffness, damping, force;
};

Units units_of(const std::string& coordinate, const std::string& force) {
  return {coordinate, coordinate + "/s", force + "/" + coordinate, force + " s/" + coordinate, force};
}

Field stiffness_of(const Units& units) {
  return optional("stiffness", state_function(units.stiffness, at_least(0)), "Stiffness.", "0");
}

Record drive_of(std::string name, const std::string& what, Field target, Field rate, Field stiffness,
                const Units& units) {
  return {
      std::move(name),
      "A spring, servo or motor on " + what +
          ": force = stiffness (target - x) + damping (rate - rate of x) + force. With constants only, the "
          "drive has the energy of a spring; otherwise the ledger counts its work as actuation.",
      {std::move(target), std::move(rate), std::move(stiffness),
       optional("damping", state_function(units.damping, at_least(0)), "Damping.", "0"),
       optional("force", state_function(units.force, unbounded()), "Force in addition.", "0"),
       optional("max_force", number(above(0), units.force),
                "Bound on the magnitude of the whole force; when absent, there is none.")}};
}

Field target_of(const Units& units) {
  return optional("target", state_function(units.coordinate, unbounded()), "Target of x.", "0");
}

constexpr const char* kRateText =
    "Target of the rate of x; when absent, the rate of a target that is a function of t, otherwise 0.";

}  // namespace

Record drive_record(std::string name, const std::string& unit, const std::string& force) {
  const Units units = units_of(unit, force);
  return drive_of(std::move(name), "a coordinate x of a joint", target_of(units),
                  optional("rate", state_function(units.rate, unbounded()), kRateText), stiffness_of(units),
                  units);
}

Record parameter_drive_record() {
  const Units units{"m, rad or 1", "m/s, rad/s or 1/s", "N/m for a length, else N m",
                    "N s/m for a length, else N m s", "N for a length, else N m"};
  return drive_of("parameter_drive", "a parameter x", target_of(units),
                  optional("rate", state_function(units.rate, unbounded()), kRateText),
                  optional("stiffness", state_function(units.stiffness, unbounded()),
                           "Stiffness, in addition to the stiffness of the parameter. A negative value makes "
                           "the parameter softer; a negative sum makes the parameter unstable.",
                           "0"),
                  units);
}

Record ball_drive_record() {
  const Units units = units_of("rad", "N m");
  return drive_of("ball_drive", "the rotation of a ball joint (twist, swing_y, swing_z)",
                  optional("target", state_vector("rad"), "Target of twist and swing.", "[0, 0, 0]"),
                  optional("rate", state_vector("rad/s"),
                           "Target of the rates of twist and swing; when absent, the rate of a target that "
                           "is a function of t, otherwise 0."),
                  stiffness_of(units), units);
}

}  // namespace pliant
