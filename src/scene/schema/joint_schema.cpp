#include "joint_schema.h"

#include <pliant/body/actuation/joint_coordinate.h>
#include <pliant/body/joints/ball.h>
#include <pliant/body/joints/joint_registry.h>

#include "drive_schema.h"

namespace pliant {

using namespace schema;

namespace {

/// Adds the keys of the limits of a joint of a type, if it has a coordinate.
void add_limits(const std::string& type, const Type& orientation, Record& record) {
  const int rows = coordinate_rows(type);
  if (rows == 0) return;
  const std::string unit = is_angle(type) ? "rad" : "m";
  if (rows == 1) {
    record.fields.push_back(
        optional("limits", array(number(unbounded(), unit), 2, 2),
                 std::string("Lower and upper limit of the ") + (is_angle(type) ? "angle." : "position.")));
  } else {
    record.fields.push_back(optional("max_swing", number(between(0, 3.14), unit),
                                     "Largest angle between the axes of both sides."));
    record.fields.push_back(optional("twist_limits", array(number(unbounded(), unit), 2, 2),
                                     "Lower and upper limit of the twist about the axis."));
    record.fields.push_back(optional(
        "axis", vector3("1"), "Axis of twist and swing, in the frame of the part at \"to\", or of the world.",
        "[1, 0, 0]"));
    record.fields.push_back(optional(
        "rotation", orientation,
        "Orientation of the frame at \"from\" relative to the frame at \"to\" at which twist and swing "
        "are zero. When absent, the relative orientation at time 0, with undeformed parts."));
  }
  record.fields.push_back(optional("restitution", number(between(0, 1), "1"),
                                   "Ratio of the rate after an impact on a limit to the rate before the "
                                   "impact. A slow rate does not rebound.",
                                   "0"));
}

Record ring_record() {
  return {
      "ring",
      "A ring of points in place of one point: the joint becomes `count` ball joints NAME.1, NAME.2, ... on "
      "equal circles around the points of both sides. Two points act as a hinge, three or more fix the "
      "relative orientation.",
      {required("count", integer(between(2, 1000)), "Number of points.", "3"),
       required("radius", number(above(0), "m"),
                "Radius of the circles. Their points are inside the parts, or on the surface of a shell.",
                "0.1"),
       optional("axis", vector3("1"),
                "Axis of the circles, in the frame of the part at \"to\", or of the world.", "[0, 0, 1]")}};
}

}  // namespace

Type joint_type(const Type& end_point, const Type& orientation) {
  std::vector<Record> records;
  for (const JointInfo& info : all_joints()) {
    Record record{
        info.name,
        std::string("A joint: ") + info.formula + ".",
        {optional("name", name(), "Name in the outputs."),
         required("from", end_point,
                  "First point x_0, on a part or of the world. If it moves in time, its position must be "
                  "continuous; a jump of its velocity causes an impulse.",
                  "{\"world\": [0, 0, 1]}"),
         required(
             "to", end_point,
             "Second point x_1, on a part or of the world. It may be on the part of \"from\" only if that "
             "part deforms.",
             "{\"part\": \"ball\", \"at\": {\"u\": 1.5708, \"v\": 0}}")}};
    auto add = [&](JointKey key, Field field) {
      if (info.keys.has(key)) record.fields.push_back(std::move(field));
    };
    add(JointKey::length, optional("length", number(above(0), "m"),
                                   "Length; when absent, the distance of the two points at time 0."));
    add(JointKey::axis,
        optional("axis", vector3("1"),
                 "Direction at \"to\", in the frame of the undeformed part at \"to\", or of the world.",
                 "[0, 0, 1]"));
    add(JointKey::from_axis,
        optional("from_axis", vector3("1"),
                 "Direction at \"from\", in the frame of the undeformed part at \"from\", or of the world. "
                 "When absent, it is parallel to \"axis\" in the pose of time 0, with undeformed parts."));
    add(JointKey::rotation,
        optional(
            "rotation", orientation,
            "Orientation of the frame at \"from\" relative to the frame at \"to\". When absent, the relative "
            "orientation at time 0, with undeformed parts."));
    if (const int rows = coordinate_rows(info.name); rows > 0)
      record.fields.push_back(optional(
          "drive",
          schema::record(rows == 3 ? ball_drive_record()
                                   : (is_angle(info.name) ? drive_record("angle_drive", "rad", "N m")
                                                          : drive_record("position_drive", "m", "N"))),
          "Spring, servo or motor on the coordinate of the joint."));
    add_limits(info.name, orientation, record);
    if (info.name == std::string(Ball::name))
      record.fields.push_back(optional(
          "ring", schema::record(ring_record()),
          "Several points around the given ones. \"rotation\" is then the relative orientation that they "
          "fix."));
    record.fields.push_back(
        optional("on", number(at_least(0), "s"), "Time at which the joint begins to act.", "0"));
    record.fields.push_back(
        optional("off", number(above(0), "s"), "Time at which the joint ceases to act; when absent, never."));
    records.push_back(std::move(record));
  }
  return tagged("type", std::move(records));
}

Record stabilization_record() {
  return {
      "stabilization",
      "Closing of open joints by C_ddot + 2 alpha C_dot + beta^2 C = 0, and projection of closed joints.",
      {optional(
           "rule",
           choice({{"automatic", "step_consistent for semi_implicit_euler, critical for other integrators"},
                   {"free", "alpha = stab_alpha, beta = stab_beta > 0"},
                   {"critical", "alpha = beta = rate"},
                   {"step_consistent",
                    "r = exp(-rate h), beta = (1 - r) / h, alpha = (1 - r^2) / (2 h): stable for "
                    "all steps h"}}),
           "Rule for alpha and beta.", "\"automatic\""),
       optional("rate", number(above(0), "1/s"),
                "Decay rate of a gap. A tenth of it is the unit of rates in tolerances.", "10"),
       optional("stab_alpha", number(at_least(0), "1/s"), "alpha of the rule \"free\".", "0"),
       optional("stab_beta", number(at_least(0), "1/s"),
                "beta of the rule \"free\", which needs a value above 0; otherwise no gap closes.", "0"),
       optional("speed", number(above(0), "1"),
                "Largest closing speed of a gap, in units of rate times the size of the smaller part.", "3"),
       optional(
           "assembly",
           choice({{"in_time", "open joints close during the run"},
                   {"before_start",
                    "parts are assembled before time 0 without inertia: by rigid motion first, then by the "
                    "parameters according to their stiffness"}}),
           "Phase in which open joints close.", "\"in_time\""),
       optional("projection", boolean(),
                "Whether closed joints are projected onto C = 0 and C_dot = 0 after each step.", "true")}};
}

}  // namespace pliant
