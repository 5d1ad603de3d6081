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
  double step(Integrator& method, StepContext& step, bool to_event = false);
  /// Takes a step to an event in which bodies lay on each other again, in two halves that are steps of their
  /// own, and extrapolates from both (Richardson): impulses that stand for forces over a step are wrong by
  /// O(h^2), which it tells, what is left by O(h^3). begun: where the step began, with its length; length:
  /// what was taken of it; impacts: how many had been counted before. Where it ended at one, the halves find
  /// their own end and are not extrapolated. state: where the step led, and then where the halves do.
  StepError step_by_doubling(Integrator& method, StepContext& step, const ErrorScale& scale,
                             const State& begun, double length, long impacts);

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
  struct Progress;
  struct Motion;
  Progress begin(Integrator& method, StepContext& step);
  Motion advance(Progress& progress);
  Motion predict(Progress& progress);
  [[noreturn]] void fail_too_fast(const Progress& progress) const;
  bool detect(Motion& motion, Progress& progress);
  ContactFinder::Neighbourhood look_ahead(const State& state, double now, double length, double fall,
                                          bool touch);
  bool wake_met(const std::vector<Contact>& contacts, const FreeMotion& motion, State& state);
  void record_resting(const Motion& motion, bool to_event);
  std::vector<Contact> few_impacts(const Motion& motion) const;
  bool locate_and_strike(Motion& motion, Progress& progress);
  void strike(const Motion& motion, const std::vector<Contact>& impacts, Progress& progress);
  void resolve(Motion& motion, Progress& progress);

  /// A step that is to be compared with its halves.
  struct Whole {
    const State state;                  ///< to which it led
    const double length;                ///< s
    const std::vector<Contact> rested;  ///< contacts at rest in it
    const std::size_t contacts;         ///< number of contacts that it resolved
    const bool struck;                  ///< whether it ended at an impact
  };
  struct Halves {
    double first = 0, taken = 0;     ///< lengths of the first half and of both, s
    std::size_t first_contacts = 0;  ///< number of contacts that the first half resolved
    VecX<double> falls;              ///< velocities that gravity gives parts which lost their contacts
    bool finite = false;
  };
  Halves take_halves(Integrator& method, StepContext& step, const Whole& whole, const State& begun);
  bool agree(const Whole& whole, const Halves& halves, bool struck, const State& state) const;
  double difference(const Whole& whole, const Halves& halves, bool alike, const ErrorScale& scale,
                    double start, const State& state) const;
  void extrapolate(StepContext& step, const State& once, std::size_t second);

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
