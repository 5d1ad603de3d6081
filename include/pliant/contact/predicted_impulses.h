// Predicted impulses: half of the impulses of resting contacts in a motion act at its start, predicted from
// the forces of the last step. The impulses at its end complete them. Bodies that rest, roll or slide then
// move in the motion nearly as the contacts let them, and the error of a step is of third order in its length
// in place of second order.
#pragma once

#include <vector>

#include <pliant/contact/contact_resolution.h>
#include <pliant/contact/free_motion.h>

namespace pliant {

/// The objects that predict impulses and take them back.
struct Prediction {
  StepContext& step;
  const ContactFinder& finder;
  const ContactResolution& resolution;
};

/// Predicts the impulses of resting contacts in motion.force_time() seconds at the start of a motion, sets
/// Contact::predicted and Contact::lift of these contacts, and applies the impulses to the state. Sets
/// motion.unpredicted. Moves these contacts to the end of `resting`. README.md of this folder lists the
/// conditions for a prediction.
void apply_predicted_impulses(const Prediction& prediction, FreeMotion& motion,
                              std::vector<Contact>& resting);
/// Assigns the predicted impulses of resting contacts at the start of a motion to the nearest resting
/// contacts of the same pairs at its end, which are in the order of ContactFinder::find(). Removes the
/// impulses of pairs without such a contact, and returns these contacts at the start with their impulses.
std::vector<Contact> assign_predicted_impulses(std::vector<Contact>& resting, std::vector<Contact>& contacts);
/// Takes predicted impulses back at the end of a motion, with their displacements. Work::contact gets the
/// change of energy. lost: contacts at the start of the motion, from assign_predicted_impulses().
void take_back_predicted_impulses(const Prediction& prediction, const FreeMotion& motion,
                                  std::vector<Contact> lost);

}  // namespace pliant
