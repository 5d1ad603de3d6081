// Finds the rule of each pair of parts, planes and obstacles from the names in ContactSettings.
#include <pliant/collision/contact_rules.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

#include <pliant/body/multibody.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

[[noreturn]] void fail_number(const char* what, double value, const char* expected) {
  std::ostringstream text;
  text << "contact: " << what << " is " << value << "; expected " << expected;
  throw std::invalid_argument(text.str());
}

void check_coefficients(double friction, double restitution) {
  if (!(friction >= 0) || !std::isfinite(friction)) fail_number("friction", friction, "a number >= 0");
  if (!(restitution >= 0 && restitution <= 1))
    fail_number("restitution", restitution, "a number from 0 to 1");
}

std::pair<int, int> in_order(int a, int b) {
  return {std::min(a, b), std::max(a, b)};
}

}  // namespace

double smaller_size(const Model& model, const Contact& contact) {
  const double a = model.parts()[at(contact.a.part)].size;
  return contact.b.part < 0 ? a : std::min(a, model.parts()[at(contact.b.part)].size);
}

ContactRules::ContactRules(const Model& model)
    : model_(&model),
      n_parts_(static_cast<int>(model.parts().size())),
      n_planes_(static_cast<int>(model.body().contact.planes.size())) {
  const ContactSettings& settings = model.body().contact;
  check_coefficients(settings.friction, settings.restitution);
  if (!(settings.longest_step > 0) || !std::isfinite(settings.longest_step))
    fail_number("the longest step (s)", settings.longest_step, "a number > 0");
  if (!(settings.interval > 0) || !std::isfinite(settings.interval))
    fail_number("the interval (s) in which bodies that may meet step together", settings.interval,
                "a number > 0");
  if (const double tolerance = settings.tolerance.value_or(kMinContactTolerance);
      !(tolerance >= kMinContactTolerance && tolerance <= kMaxContactTolerance))
    fail_number("the tolerance", tolerance, "a number from 1e-14 to 0.1");
  std::map<std::string, int> numbers;
  auto add = [&](const std::string& name, const char* what) {
    if (!numbers.emplace(name, static_cast<int>(numbers.size())).second)
      throw std::invalid_argument(what + (" both called '" + name + "'"));
  };
  for (const PartModel& m : model.parts()) add(m.part->name(), "contact: two parts are");
  for (const ContactPlane& plane : settings.planes) add(plane.name, "contact: a plane and another thing are");
  for (const ContactObstacle& obstacle : settings.obstacles)
    add(obstacle.name, "contact: an obstacle and another thing are");
  const int n_things = static_cast<int>(numbers.size());
  for (const ContactGroup& group : settings.groups) add(group.name, "contact: a group and another thing are");
  auto number = [&](const std::string& name, const char* what) {
    const auto found = numbers.find(name);
    if (found == numbers.end())
      throw std::invalid_argument("contact: a pair or a group names '" + name + "', but there is no " + what +
                                  " with this name");
    return found->second;
  };
  groups_of_.resize(at(n_things));
  for (const ContactGroup& group : settings.groups)
    for (const std::string& name : group.members) {
      const int member = number(name, "part, plane or obstacle");
      if (member >= n_things)
        throw std::invalid_argument("contact: the group '" + group.name + "' contains the group '" + name +
                                    "'; expected parts, planes and obstacles as members");
      groups_of_[at(member)].push_back(number(group.name, "group"));
    }
  for (std::size_t k = 0; k < settings.pairs.size(); ++k) {
    const ContactPair& pair = settings.pairs[k];
    check_coefficients(pair.friction.value_or(0), pair.restitution.value_or(0));
    const int a = number(pair.a, "part, plane, obstacle or group"),
              b = number(pair.b, "part, plane, obstacle or group");
    if (a == b && a < n_things)
      throw std::invalid_argument("contact: a pair names '" + pair.a +
                                  "' twice; expected two things, or one group twice");
    last_pair_[in_order(a, b)] = static_cast<int>(k);
  }
  for (const JointModel& joint : model.joints())
    for (const PortRef& one : joint.at)
      for (const PortRef& other : joint.at)
        if (one.part >= 0 && other.part > one.part) joined_.insert({one.part, other.part});
}

ContactRule ContactRules::of_parts(int a, int b) const {
  const ContactPair* pair = this->pair(a, b);
  ContactRule rule = rule_of(pair);
  const bool tied = joined_.count(in_order(a, b)) > 0;
  if ((tied && number_of(a, b) < 0) || (pair == nullptr && !model_->body().contact.between_parts) ||
      (!moves(a) && !moves(b)))
    rule.touch = false;
  return rule;
}

ContactRule ContactRules::on_plane(int part, int plane) const {
  return on_fixed(part, n_parts_ + plane);
}

ContactRule ContactRules::on_obstacle(int part, int obstacle) const {
  return on_fixed(part, n_parts_ + n_planes_ + obstacle);
}

ContactRule ContactRules::on_fixed(int part, int thing) const {
  ContactRule rule = rule_of(pair(part, thing));
  if (!moves(part)) rule.touch = false;
  return rule;
}

/// Returns the pair of the settings that applies to two parts, planes or obstacles; nullptr if there is none.
/// A pair that names both of them has priority over a pair that names one of them and a group of the other. A
/// pair with one group has priority over a pair with two groups. Among pairs of equal priority the last one
/// is used.
const ContactPair* ContactRules::pair(int a, int b) const {
  if (last_pair_.empty()) return nullptr;
  const std::vector<int>&of_a = groups_of_[at(a)], &of_b = groups_of_[at(b)];
  int last = number_of(a, b);
  if (last < 0) {
    for (const int group : of_b) last = std::max(last, number_of(a, group));
    for (const int group : of_a) last = std::max(last, number_of(group, b));
  }
  if (last < 0)
    for (const int one : of_a)
      for (const int other : of_b) last = std::max(last, number_of(one, other));
  return last < 0 ? nullptr : &model_->body().contact.pairs[at(last)];
}

/// Returns the index of the last pair of the settings with exactly these two names; -1 if there is none. a,
/// b: numbers of parts, planes, obstacles or groups.
int ContactRules::number_of(int a, int b) const {
  const auto found = last_pair_.find(in_order(a, b));
  return found == last_pair_.end() ? -1 : found->second;
}

ContactRule ContactRules::rule_of(const ContactPair* pair) const {
  const ContactSettings& settings = model_->body().contact;
  if (pair == nullptr) return {true, settings.friction, settings.restitution};
  return {pair->touch, pair->friction.value_or(settings.friction),
          pair->restitution.value_or(settings.restitution)};
}

}  // namespace pliant
