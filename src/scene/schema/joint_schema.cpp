#include "joint_schema.h"

#include <pliant/body/joints/joint_registry.h>

namespace pliant {

using namespace schema;

Type joint_type(const Type& end_point, const Type& orientation) {
  std::vector<Record> records;
  for (const JointInfo& info : all_joints()) {
    Record record{
        info.name,
        std::string("A joint: ") + info.formula + ".",
        {optional("name", name(), "Name in the outputs."),
         required("from", end_point,
                  "Its first point, x_0: on a part, or of the world. Where it is moved in time its "
                  "rate may jump, which takes an impulse; its place may not.",
                  "{\"world\": [0, 0, 1]}"),
         required("to", end_point, "Its second point, x_1, likewise; on the same part only if that deforms.",
                  "{\"part\": \"ball\", \"at\": {\"u\": 1.5708, \"v\": 0}}")}};
    auto add = [&](JointKey key, Field field) {
      if (info.keys.has(key)) record.fields.push_back(std::move(field));
    };
    add(JointKey::length, optional("length", number(above(0), "m"),
                                   "Its length; the distance of its points at time 0 when not given."));
    add(JointKey::axis,
        optional("axis", vector3("1"),
                 "Direction at \"to\", in the frame of its part at rest or of the world.", "[0, 0, 1]"));
    add(JointKey::from_axis, optional("from_axis", vector3("1"),
                                      "The axis at \"from\" likewise; as \"axis\" stands at time 0 when not "
                                      "given, the parts undeformed."));
    add(JointKey::rotation,
        optional("rotation", orientation,
                 "Orientation of the frame at \"from\" in that at \"to\"; as they stand at time 0 "
                 "when not given, the parts undeformed."));
    record.fields.push_back(optional("on", number(at_least(0), "s"), "When it begins to act.", "0"));
    record.fields.push_back(
        optional("off", number(above(0), "s"), "When it ceases to; never when not given."));
    records.push_back(std::move(record));
  }
  return tagged("type", std::move(records));
}

Record stabilization_record() {
  return {
      "stabilization",
      "How open joints close, C_ddot + 2 alpha C_dot + beta^2 C = 0, and how closed ones are kept so.",
      {optional("rule",
                choice({{"automatic", "step_consistent for semi_implicit_euler, critical for all others"},
                        {"free", "stab_alpha and stab_beta as given, the latter > 0"},
                        {"critical", "alpha = beta = rate"},
                        {"step_consistent",
                         "r = exp(-rate h), beta = (1 - r) / h, alpha = (1 - r^2) / (2 h): stable for "
                         "any step"}}),
                "Where alpha and beta come from.", "\"automatic\""),
       optional("rate", number(above(0), "1/s"), "Decay rate of a gap.", "10"),
       optional("stab_alpha", number(at_least(0), "1/s"), "alpha of the rule \"free\".", "0"),
       optional("stab_beta", number(at_least(0), "1/s"),
                "beta of the rule \"free\", which needs it: no gap closes without.", "0"),
       optional("speed", number(above(0), "1"),
                "Most speed at which a gap closes, in units of rate times the size of the smaller part.",
                "3"),
       optional("assembly",
                choice({{"in_time", "open joints close while time runs"},
                        {"before_start",
                         "parts are brought together before time 0 without inertia: rigid motion first, "
                         "parameters as far as their stiffness says"}}),
                "When open joints close.", "\"in_time\""),
       optional("projection", boolean(),
                "Whether closed joints are projected onto C = 0 and C_dot = 0 after each step.", "true")}};
}

}  // namespace pliant
