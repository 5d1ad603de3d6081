#include "joint_reader.h"

#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/joints/joint_registry.h>

#include "direction_reader.h"
#include "joint_ring.h"

namespace pliant {

JointSolver::Choice joint_solver(const std::string& name) {
  using Choice = JointSolver::Choice;
  if (name == "blocks") return Choice::blocks;
  return name == "augmented" ? Choice::augmented : Choice::automatic;
}

Stabilization read_stabilization(const Reader& r, SceneFaults& faults) {
  Stabilization rule;
  static constexpr std::array<std::pair<const char*, BaumgarteRule>, 4> rules{
      {{"automatic", BaumgarteRule::automatic},
       {"free", BaumgarteRule::free},
       {"critical", BaumgarteRule::critical},
       {"step_consistent", BaumgarteRule::step_consistent}}};
  for (const auto& [name, value] : rules)
    if (r.text("rule") == name) rule.rule = value;
  rule.rate = r.number("rate");
  rule.stab_alpha = r.number("stab_alpha");
  rule.stab_beta = r.number("stab_beta");
  rule.speed = r.number("speed");
  rule.assemble_first = r.text("assembly") == "before_start";
  rule.projection = r.boolean("projection");
  if (rule.rule == BaumgarteRule::free && rule.stab_beta == 0 && !r.faulty("stab_beta"))
    faults.place(r.json(),
                 "the rule \"free\" closes no gap without \"stab_beta\"; expected a number > 0 (1/s)");
  return rule;
}

namespace {

/// Returns whether a joint constrains no motion: both ends are immobile, are the same point, or are on the
/// same rigid part. If so, reports the fault.
bool constrains_nothing(const Reader& r, const Point& from, const Point& to, SceneFaults& faults) {
  auto moves = [](const Point& point) { return point.part != nullptr && !point.part->fixed(); };
  if (!moves(from) && !moves(to)) {
    faults.place(r.json(), "neither end is on a part that moves; expected at least one");
    return true;
  }
  if (from.part != to.part) return false;
  if (same_point(from.material, to.material)) {
    faults.place(r.at("to"), "this is the same point as \"from\"; expected another");
    return true;
  }
  if (!from.part->rigid()) return false;
  faults.place(r.json(), "both ends are on part \"" + from.part->name() +
                             "\", which does not deform; expected two parts, or a part with a dynamic "
                             "parameter or local deformation");
  return true;
}

/// Returns whether the prescribed path of an end has a jump in position while the joint acts. If so, reports
/// the fault.
bool jumps(const Reader& r, const char* key, const Point& end, const PointReader& points,
           SceneFaults& faults) {
  const double on = r.given("on") ? r.number("on") : 0;
  const double off = r.given("off") ? r.number("off") : std::numeric_limits<double>::infinity();
  const std::optional<double> time = points.jump(end, on, off);
  if (!time) return false;
  faults.place(r.at(key),
               "its position jumps at t = " + brief(*time) +
                   " s, and no part can follow; expected a continuous path, for example key frames");
  return true;
}

/// Reads the keys that the type of a joint uses into `setting`. Returns false if there are faults.
bool read_setting(const Reader& r, JointKeys keys, JointSetting& setting, SceneFaults& faults) {
  const std::size_t before = faults.errors();
  if (keys.has(JointKey::length)) {
    if (r.faulty("length")) return false;
    setting.length = r.given("length")
                         ? r.number("length")
                         : (position_at_start(setting.from) - position_at_start(setting.to)).norm();
    if (!(setting.length > 0))
      faults.place(r.json(), "its points are at the same place at time 0; expected a \"length\"");
  }
  if (keys.has(JointKey::axis)) setting.axis = read_direction(r.at("axis"), faults);
  if (keys.has(JointKey::from_axis) && r.given("from_axis"))
    setting.from_axis = read_direction(r.at("from_axis"), faults);
  if (keys.has(JointKey::rotation) && r.given("rotation"))
    setting.rotation = read_orientation(r.object("rotation"), faults);
  if (r.given("off") && !(r.number("on") < r.number("off")))
    faults.value(r.at("off"), "expected a time after \"on\", which is " + brief(r.number("on")) + " s");
  return faults.errors() == before;
}

/// Reads the setting of the joint, or of each joint of its ring. The result is empty if there are faults.
std::vector<JointSetting> read_settings(const Reader& r, JointKeys keys, JointSetting setting,
                                        SceneFaults& faults) {
  if (!read_setting(r, keys, setting, faults)) return {};
  if (!has_ring(r)) return {setting};
  if (r.faulty("ring")) return {};
  for (const char* key : {"axis", "drive", "max_swing", "twist_limits"}) {
    if (!r.given(key)) continue;
    faults.place(r.at(key), "the points of a ring have no rotation; expected no \"" + std::string(key) +
                                "\" beside \"ring\"");
    return {};
  }
  if (r.given("rotation")) setting.rotation = read_orientation(r.object("rotation"), faults);
  return ring_of_joints(r.object("ring"), setting, faults);
}

}  // namespace

bool has_ring(const Reader& r) {
  return r.record().find("ring") != nullptr && r.json().find("ring") != nullptr;
}

std::vector<std::string> ring_names(const Reader& r) {
  if (!has_ring(r) || !r.given("ring") || !r.object("ring").given("count")) return {};
  std::vector<std::string> names;
  for (int k = 1; k <= r.object("ring").integer("count"); ++k)
    names.push_back(r.text("name") + "." + std::to_string(k));
  return names;
}

std::vector<Joint*> read_joint(const Reader& r, const PointReader& points, SceneFaults& faults,
                               MultiBody& body) {
  const std::optional<Point> from = points.end(r, "from"), to = points.end(r, "to");
  if (!from || !to || !r.complete() || constrains_nothing(r, *from, *to, faults)) return {};
  if (jumps(r, "from", *from, points, faults) || jumps(r, "to", *to, points, faults)) return {};
  const auto info = std::find_if(all_joints().begin(), all_joints().end(),
                                 [&](const JointInfo& i) { return i.name == r.name(); });
  const std::string entry = name_of(r, info->name, body.joints().size());
  std::vector<Joint*> joints;
  for (const JointSetting& setting : read_settings(r, info->keys, JointSetting{*from, *to}, faults)) {
    std::string name = has_ring(r) ? entry + "." + std::to_string(joints.size() + 1) : entry;
    while (body.has_joint(name)) name += "'";  // another joint of the scene may have the generated name
    try {
      Joint& joint = body.join(info->make(std::move(name), setting));
      if (r.given("off"))
        joint.during(r.number("on"), r.number("off"));
      else if (r.given("on"))
        joint.during(r.number("on"));
      joints.push_back(&joint);
    } catch (const std::invalid_argument& e) {
      faults.place(r.json(), e.what());
      return {};
    }
  }
  return joints;
}

}  // namespace pliant
