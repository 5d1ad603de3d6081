// Steps of bodies in contact, around any method of integration. A step without contact is a step of the
// method. The time of an impact is located and its impulses act there. The impulses of resting contacts act
// like constant forces over the step, so that resting and sticking bodies stay to the last bit. Many impacts
// in one step are resolved at its end. README.md of this folder lists the stages of step().
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
  /// The dynamics must outlive the object. Throws std::invalid_argument as ContactFinder does.
  explicit ContactStepping(const Dynamics& dynamics);

  /// begin_step() begins a step, which may consist of several calls of step(); undo_step() discards it.
  void begin_step();
  void undo_step();
  /// Advances the state by step.h and returns the length of the step, s; the caller counts it. to_event: the
  /// step ends early at the first located impact, and after one motion if bodies rest on each other.
  double step(Integrator& method, StepContext& step, bool to_event = false);
  /// Repeats a step to an event, in which bodies rested on each other, as two halves, and extrapolates from
  /// both (Richardson): impulses that act as forces over a step have an error of O(h^2), which is the
  /// estimate; O(h^3) remains. begun: state at the start, with the length of the step; length: the length
  /// taken, s; impacts: their number before the step. A step that ended at an impact is not extrapolated. The
  /// state of the step is the end of the step, then the end of its halves.
  StepError step_by_doubling(Integrator& method, StepContext& step, const ErrorScale& scale,
                             const State& begun, double length, long impacts);

  /// Time of the stages in all steps so far, s.
  struct StageTimes {
    double motion = 0;      ///< steps of the method, and location of impacts
    double finding = 0;     ///< search for near bodies and contacts
    double resolution = 0;  ///< impulses, and separation of overlaps
  };
  const StageTimes& times() const { return times_; }

  const ContactFinder& finder() const { return finder_; }
  /// Returns all contacts with overlap at a state and a time, s.
  std::vector<Contact> overlaps(const State& state, double t) const;
  /// any_resting(): whether a contact of the last step lasted, or was not located. few_resting(): whether
  /// step_by_doubling applies to it.
  bool any_resting() const { return meets_late_ || !rested_.empty(); }
  bool few_resting() const;
  /// Contacts and impulses of the last whole step.
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
  bool few_parts_ = false;  ///< few enough to locate impacts
  // Of the last step: contacts at rest at the start of a motion, and whether contacts were resolved that were
  // not located.
  std::vector<Contact> rested_;
  bool meets_late_ = false;
  StageTimes times_;
};

}  // namespace pliant
