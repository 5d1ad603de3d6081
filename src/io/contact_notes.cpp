#include <pliant/io/contact_notes.h>

#include <algorithm>
#include <array>
#include <map>

#include <pliant/body/multibody.h>
#include <pliant/io/number_text.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

/// Overlaps below this share of the size of the smaller part are told by nothing but run.json.
constexpr double kToldOverlap = 1e-3;
constexpr std::size_t kMostTold = 10;

double size_of(const Model& model, const Contact& contact) {
  const double a = model.parts()[at(contact.a.part)].part->size();
  return contact.b.part < 0 ? a : std::min(a, model.parts()[at(contact.b.part)].part->size());
}

/// "the plane 'floor'"
std::string other_side(const Model& model, const Contact& contact) {
  if (contact.b.part >= 0) return "part '" + model.parts()[at(contact.b.part)].part->name() + "'";
  if (contact.plane >= 0) return "the plane '" + model.body().contact.planes[at(contact.plane)].name + "'";
  return "the obstacle '" + model.body().contact.obstacles[at(contact.obstacle)].name + "'";
}

}  // namespace

double deepest_share(const Simulation& simulation) {
  if (simulation.contact() == nullptr) return 0;
  double deepest = 0;
  for (const Contact& contact : simulation.contact()->overlaps(simulation.state(), simulation.time()))
    deepest = std::max(deepest, -contact.gap / size_of(simulation.model(), contact));
  return deepest;
}

std::vector<std::string> overlap_notes(const Simulation& simulation) {
  if (simulation.contact() == nullptr) return {};
  const Model& model = simulation.model();
  const std::vector<Contact> overlaps = simulation.contact()->overlaps(simulation.state(), simulation.time());
  std::map<std::array<int, 4>, const Contact*> deepest;  // by sides
  for (const Contact& contact : overlaps) {
    if (!(contact.gap < -kToldOverlap * size_of(model, contact))) continue;
    const Contact*& known = deepest[{contact.a.part, contact.b.part, contact.plane, contact.obstacle}];
    if (known == nullptr || contact.gap < known->gap) known = &contact;
  }
  std::vector<const Contact*> told;
  for (const auto& entry : deepest) told.push_back(entry.second);
  std::stable_sort(told.begin(), told.end(),
                   [](const Contact* one, const Contact* other) { return one->gap < other->gap; });
  std::vector<std::string> notes;
  for (std::size_t k = 0; k < std::min(told.size(), kMostTold); ++k)
    notes.push_back("warning: at t = " + rounded_text(simulation.time()) + " s part '" +
                    model.parts()[at(told[k]->a.part)].part->name() + "' and " + other_side(model, *told[k]) +
                    " overlap by " + rounded_text(-told[k]->gap) + " m; they are parted at a bounded speed");
  if (told.size() > kMostTold)
    notes.push_back("and " + std::to_string(told.size() - kMostTold) + " pairs more overlap less");
  return notes;
}

}  // namespace pliant
