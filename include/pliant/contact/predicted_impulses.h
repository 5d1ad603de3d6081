// Predicted impulses: half of the impulse of each resting contact acts at the start of a motion, predicted
// from the contact force in the last step. The rest of the impulse acts at the end. With this division the
// error of a step of bodies that roll or slide is of third order in its length, in place of second order.
#pragma once

#include <vector>

#include <pliant/contact/contact_resolution.h>
#include <pliant/contact/free_motion.h>

namespace pliant {

/// The objects that the functions below need.
struct Prediction {
  StepContext& step;
  const ContactFinder& finder;
  const ContactResolution& resolution;
};

/// Predicts impulses of resting contacts at the start of a motion: their forces in the last step times
/// motion.force_time(). Sets Contact::predicted and Contact::lift, applies the impulses to the state, and
/// sets motion.unpredicted. Moves these contacts to the end of `resting`. README.md of this folder lists the
/// conditions for a prediction.
void apply_predicted_impulses(const Prediction& prediction, FreeMotion& motion,
                              std::vector<Contact>& resting);
/// Assigns each predicted impulse of a resting contact at the start of a motion to the nearest resting
/// contact of the same pair at its end. contacts: those at the end, in the order of ContactFinder::find(). If
/// a pair has no resting contact at the end, its impulses are removed from `resting`. Returns the contacts at
/// the start that have lost their impulses, with these impulses.
std::vector<Contact> assign_predicted_impulses(std::vector<Contact>& resting, std::vector<Contact>& contacts);
/// Subtracts predicted impulses and their displacements from the state at the end of a motion. Work::contact
/// gets the change of energy. lost: contacts at the start of the motion, from assign_predicted_impulses().
void take_back_predicted_impulses(const Prediction& prediction, const FreeMotion& motion,
                                  std::vector<Contact> lost);

}  // namespace pliant
