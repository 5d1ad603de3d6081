#include "drive_schema.h"

#include <utility>

#include <pliant/scene/time_value.h>

namespace pliant {

using namespace schema;

namespace {

/// stiffness: the field of the stiffness. force: unit of the force; per: unit of the coordinate.
Record drive_of(std::string name, std::string what, Field target, Field rate, Field stiffness,
                const std::string& force, const std::string& per) {
  return {
      std::move(name),
      "A spring, servo or motor on " + what +
          ": force = stiffness (target - x) + damping (rate - rate of x) + force. With constants only, its "
          "energy is that of a spring; otherwise the ledger has its work as actuation.",
      {std::move(target), std::move(rate), std::move(stiffness),
       optional("damping", state_function(force + " s/" + per, at_least(0)), "Damping.", "0"),
       optional("force", state_function(force, unbounded()), "Force in addition.", "0"),
       optional("max_force", number(above(0), force),
                "Bound on the magnitude of the force; when absent, there is none.")}};
}

Field target_of(const std::string& unit) {
  return optional("target", state_function(unit, unbounded()), "Target of x.", "0");
}

Field rate_of(const std::string& unit) {
  return optional("rate", state_function(unit + "/s", unbounded()),
                  "Target of the rate of x; when absent, the rate of a target that is a function of t, "
                  "otherwise 0.");
}

Field stiffness_of(const std::string& unit) {
  return optional("stiffness", state_function(unit, at_least(0)), "Stiffness.", "0");
}

}  // namespace

Record drive_record(std::string name, const std::string& unit, const std::string& force) {
  return drive_of(std::move(name), "a coordinate x of a joint", target_of(unit), rate_of(unit),
                  stiffness_of(force + "/" + unit), force, unit);
}

Record parameter_drive_record() {
  return drive_of(
      "parameter_drive", "a parameter x", target_of(""), rate_of(""),
      optional("stiffness", state_function("/", unbounded()),
               "Stiffness, in addition to that of the parameter. A negative one makes the parameter softer.",
               "0"),
      "", "");
}

Record ball_drive_record() {
  return drive_of("ball_drive", "the rotation of a ball joint (twist, swing_y, swing_z)",
                  optional("target", state_vector("rad"), "Target of twist and swing.", "[0, 0, 0]"),
                  optional("rate", state_vector("rad/s"),
                           "Target of its rate; when absent, the rate of a target that is a function of t, "
                           "otherwise 0."),
                  stiffness_of("N m/rad"), "N m", "rad");
}

}  // namespace pliant
