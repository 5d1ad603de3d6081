// Steps of bodies that touch, around any method of integration. A step that meets nothing is the method's
// own. Where surfaces meet that were apart, the time of the impact is found and the impulses act there; where
// they lie on each other, the impulses of a step act as forces do that are constant over it, so that what
// rests or sticks does so to the last bit. Many impacts in one step are taken at its end.
#pragma once

#include <vector>

#include <pliant/collision/find_contacts.h>
#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/contact_resolution.h>
#include <pliant/contact/resting_contacts.h>
#include <pliant/contact/sleeping.h>
#include <pliant/method/integrator.h>
#include <pliant/method/step_error.h>

namespace pliant {

class ContactStepping {
 public:
  /// dynamics: must outlive it. Throws std::invalid_argument, see ContactFinder.
  explicit ContactStepping(const Dynamics& dynamics);

  /// A new step begins, which may come in parts; the one that began last counts for nothing.
  void begin_step();
  void undo_step();
  /// Advances q, v and work by state.h and returns by how much; the caller counts the step. to_event: it ends
  /// at the first impact that is told in time, and where bodies that lie on each other have gone as far as
  /// one motion may take them.
  double step(Integrator& method, State& state, Workspace<double>& work, StepCounters& counters,
              bool to_event = false);
  /// Takes a step to an event in which bodies lay on each other again, in two halves that are steps of their
  /// own, and extrapolates from both (Richardson): impulses that stand for forces over a step are wrong by
  /// O(h^2), which it tells, what is left by O(h^3). begun: where the step began, with its length; length:
  /// what was taken of it; impacts: how many had been counted before. Where it ended at one, the halves find
  /// their own end and are not extrapolated. state: where the step led, and then where the halves do.
  StepError step_by_doubling(Integrator& method, const ErrorScale& scale, const State& begun, double length,
                             long impacts, State& state, Workspace<double>& work, StepCounters& counters);

  /// What the steps so far took, by stages, s of the clock.
  struct StageTimes {
    double motion = 0;      ///< the method's steps, contacts aside, and telling impacts in time
    double finding = 0;     ///< what is near, and where it touches
    double resolution = 0;  ///< impulses, and overlaps taken back
  };
  const StageTimes& times() const { return times_; }

  const ContactFinder& finder() const { return finder_; }
  /// All contacts whose sides are in each other at a state and a time, s.
  std::vector<Contact> overlaps(const State& state, double t) const;
  /// Whether some of what touched in the last step did so for a time, or was not met at its time; and
  /// whether that is little enough for step_by_doubling.
  bool any_resting() const { return meets_late_ || !rested_.empty(); }
  bool few_resting() const;
  /// Of the last whole step; empty where nothing touched.
  const ContactRecord& record() const { return record_; }
  const std::vector<Contact>& contacts() const { return record_.contacts; }
  const std::vector<Vec3<double>>& impulses() const { return record_.impulses; }

 private:
  class StageClock;
  ContactFinder::Neighbourhood look_ahead(const State& state, double now, double whole, double fall,
                                          bool touch);
  bool wake_met(const std::vector<Contact>& contacts, const FreeMotion& motion, State& state);
  std::vector<Contact> few_impacts(const std::vector<Contact>& contacts,
                                   const std::vector<Contact>& resting) const;
  void extrapolate(const State& once, std::size_t second, double t, double h, State& state,
                   Workspace<double>& work, StepCounters& counters);
  void strike(const FreeMotion& motion, const std::vector<Contact>& resting,
              const std::vector<Contact>& impacts, State& state, Workspace<double>& work,
              StepCounters& counters, StageClock& clock);

  const Dynamics& dynamics_;
  ContactFinder finder_;
  MeshFinder meshes_;
  RestingContacts resting_;
  ContactRecord record_, record_before_;
  ContactResolution resolution_;
  Sleeping sleeping_;
  Workspace<double> scratch_;
  bool few_parts_ = false;  ///< so that impacts are told in time
  // Of the last step: what lay on each other at the start of a motion, and whether something met that was not
  // told in time.
  std::vector<Contact> rested_;
  bool meets_late_ = false;
  StageTimes times_;
};

}  // namespace pliant
