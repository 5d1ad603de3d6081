#include <pliant/contact/contact_stepping.h>
#include <pliant/io/run/contact_notes.h>

#include <algorithm>
#include <map>

#include <pliant/body/multibody.h>
#include <pliant/collision/contact_rules.h>
#include <pliant/io/format/number_text.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

constexpr std::size_t kMaxReported = 10;  // largest number of pairs that are reported per state

// The subjects of the notes of violation_notes(), by which is_violation_note() finds them.
constexpr const char* kResidualText = "velocities at contacts violated the laws of contact";
constexpr const char* kOverlapText = "bodies still overlapped after their separation";

/// Returns the kind and the name of the second side of a contact, for example "the plane 'floor'".
std::string other_side(const Model& model, const Contact& contact) {
  if (contact.b.part >= 0) return "part '" + model.parts()[at(contact.b.part)].part->name() + "'";
  if (contact.plane >= 0) return "the plane '" + model.body().contact.planes[at(contact.plane)].name + "'";
  return "the obstacle '" + model.body().contact.obstacles[at(contact.obstacle)].name + "'";
}

/// Returns ", unless hinge 'arm' prevents it" for the first closed or closing joint that ties a part of a
/// contact to the world or to an immobile part, or an empty text if there is none.
std::string holding_joint(const Simulation& simulation, const Contact& contact) {
  const Model& model = simulation.model();
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const JointModel& joint = model.joints()[j];
    const JointMode mode = simulation.state().joints[j];
    if (mode != JointMode::closed && mode != JointMode::closing) continue;
    const bool anchored = std::any_of(joint.at.begin(), joint.at.end(), [&](const PortRef& port) {
      return port.part < 0 || model.parts()[at(port.part)].q0 < 0;
    });
    if (!anchored) continue;
    for (const JointSide& side : joint.sides)
      if (side.part == contact.a.part || side.part == contact.b.part)
        return ", unless " + std::string(joint.joint->type()) + " '" + joint.joint->name() + "' prevents it";
  }
  return {};
}

}  // namespace

double deepest_share(const Simulation& simulation) {
  if (simulation.contact() == nullptr) return 0;
  double deepest = 0;
  for (const Contact& contact : simulation.contact()->overlaps(simulation.state(), simulation.time()))
    deepest = std::max(deepest, -contact.gap / smaller_size(simulation.model(), contact));
  return deepest;
}

std::vector<std::string> overlap_notes(const Simulation& simulation, std::set<TouchingPair>& reported) {
  if (simulation.contact() == nullptr) return {};
  const Model& model = simulation.model();
  const std::vector<Contact> overlaps = simulation.contact()->overlaps(simulation.state(), simulation.time());
  std::map<TouchingPair, const Contact*> deepest;
  for (const Contact& contact : overlaps) {
    const TouchingPair pair{contact.a.part, contact.b.part, contact.plane, contact.obstacle};
    if (!(contact.gap < -kReportedOverlap * smaller_size(model, contact)) || reported.count(pair) > 0)
      continue;
    const Contact*& known = deepest[pair];
    if (known == nullptr || contact.gap < known->gap) known = &contact;
  }
  std::vector<const Contact*> now;
  for (const auto& entry : deepest) {
    now.push_back(entry.second);
    reported.insert(entry.first);
  }
  std::stable_sort(now.begin(), now.end(),
                   [](const Contact* one, const Contact* other) { return one->gap < other->gap; });
  std::vector<std::string> notes;
  for (std::size_t k = 0; k < std::min(now.size(), kMaxReported); ++k)
    notes.push_back("warning: at t = " + rounded_text(simulation.time()) + " s part '" +
                    model.parts()[at(now[k]->a.part)].part->name() + "' and " + other_side(model, *now[k]) +
                    " overlap by " + rounded_text(-now[k]->gap) + " m, which is " +
                    rounded_text(-now[k]->gap / smaller_size(model, *now[k]), 2) +
                    " of the size of the smaller part; contact separates them at a bounded speed" +
                    holding_joint(simulation, *now[k]));
  if (now.size() > kMaxReported)
    notes.push_back(std::to_string(now.size() - kMaxReported) + " more pairs overlap by less");
  return notes;
}

std::vector<std::string> violation_notes(const StepCounters& counters, const ContactSettings& settings) {
  const std::string share =
      settings.tolerance ? rounded_text(*settings.tolerance) : std::string("a thousandth");
  auto text = [](const ContactViolation& violation, const char* what, const char* unit) {
    return "warning: at t = " + rounded_text(violation.time) + " s " + what + " by " +
           rounded_text(violation.value) + " " + unit + ". The tolerance there is " +
           rounded_text(violation.tolerance) + " " + unit;
  };
  std::vector<std::string> notes;
  if (const ContactViolation& worst = counters.worst_residual; !worst.is_allowed())
    notes.push_back(
        text(worst, kResidualText, "m/s") + ", " + share +
        " of the speed that the impulses stopped. Check whether a joint or a prescribed motion "
        "presses bodies into each other, or whether a light body carries much heavier ones." +
        (settings.tolerance ? " A larger \"tolerance\" of \"contact\" accepts such violations." : ""));
  if (const ContactViolation& worst = counters.worst_overlap; !worst.is_allowed())
    notes.push_back(text(worst, kOverlapText, "m") +
                    ". Contact separates bodies at a bounded speed. Place bodies apart at the start, and "
                    "check whether a joint or a prescribed motion presses them into each other.");
  return notes;
}

bool is_violation_note(const std::string& note) {
  return note.find(kResidualText) != std::string::npos || note.find(kOverlapText) != std::string::npos;
}

}  // namespace pliant
