// Steps with contact, for any method of integration. A step without contact is the step of the method. An
// impact is located in time, and its impulses act at that time. At resting contacts, impulses stand for
// forces that are constant over the step, so that resting and sticking bodies keep their coordinates to
// rounding. If many parts can move, or many impacts happen within one motion (the step or a part of it), the
// impacts are resolved together at the end of the motion (README.md of this folder).
#pragma once

#include <vector>

#include <pliant/collision/find_contacts.h>
#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/contact_resolution.h>
#include <pliant/contact/friction_events.h>
#include <pliant/contact/impact_sequence.h>
#include <pliant/contact/resting_contacts.h>
#include <pliant/contact/sleeping.h>
#include <pliant/method/integrator.h>
#include <pliant/method/step_error.h>

namespace pliant {

class ContactStepping {
 public:
  /// The dynamics must outlive this object. Throws std::invalid_argument, see ContactFinder and Sleeping.
  explicit ContactStepping(const Dynamics& dynamics) : ContactStepping(dynamics, nullptr) {}
  /// Makes an object for a model that contains some parts of a body. It shares surfaces with `whole`, the
  /// finder of the whole body, whose model must outlive it.
  ContactStepping(const Dynamics& dynamics, const ContactFinder& whole) : ContactStepping(dynamics, &whole) {}

  /// Begins a step with an empty record, to which several calls of step() may append. undo_step() replaces
  /// the record by that of the previous step.
  void begin_step();
  void undo_step();
  /// Wakes sleeping parts that a force, joint, plane, obstacle or prescribed motion may move within h seconds
  /// after t, s.
  void wake_driven(double t, double h, State& state) { sleeping_.begin_motion(t, h, state); }
  /// Appends the record of the last step of a cluster, a model of some parts of the same body, and moves its
  /// stage times here.
  void absorb(ContactStepping& cluster);
  /// Advances q, v, work, modes and contact cache of step.state by state.h seconds, or less with a tolerance.
  /// Returns the length of the step, s. The caller increments State::step. tolerance: the tolerance of the
  /// simulation, or 0 if it has no tolerance. With a tolerance the step ends at the first event after its
  /// start: an impact, or a change of friction (FrictionEvents). In models with few moving parts it also ends
  /// after a motion with resting contacts, or with contacts whose time was not located. If a method with
  /// implicit elasticity brings parts that deform locally near other bodies, the step is of first order; it
  /// is repeated as two halves and extrapolated (extrapolate_soft_step).
  double step(Integrator& method, StepContext& step, double tolerance = 0);
  /// Repeats a step with resting contacts, or with contacts whose time was not located, as two half steps. If
  /// both results agree in modes and contacts and the error is at most 1, extrapolates from both
  /// (Richardson). Impulses that stand for forces over a step have an error of O(h^2), which the difference
  /// of both results estimates; the error of the extrapolation is O(h^3). With a tolerance below
  /// step_doubling::kThirdsTolerance, the step is also repeated in thirds, and the extrapolation from all
  /// three results has an error of O(h^4). If the step ended at an event, the halves locate the event
  /// themselves and are not extrapolated. initial: the state at the start, with the length of the step before
  /// any event shortened it. length: the actual length of the step, s. before: the counters before the step.
  /// step.state: on input the state at the end of the step, on output the state at the end of the last
  /// repetition. Returns the error, in tolerances, and the length of the last repetition. The error is the
  /// larger of the error of contact and the error of the method. If the bodies in contact were at rest and
  /// have no prescribed motion, the error is 0 and the step is not repeated. If a repetition fails, the error
  /// is infinite.
  StepError step_by_doubling(Integrator& method, StepContext& step, const ErrorScale& scale,
                             const State& initial, double length, const StepCounters& before);

  /// Wall-clock time of all steps by stage, s.
  struct StageTimes {
    double motion = 0;      ///< steps of the method, and location of impacts
    double finding = 0;     ///< neighbourhoods and contact search
    double resolution = 0;  ///< impulses and separation of overlaps
  };
  const StageTimes& times() const { return times_; }

  const ContactFinder& finder() const { return finder_; }
  /// Returns all contacts whose sides overlap at a state and a time, s.
  std::vector<Contact> overlaps(const State& state, double t) const;
  /// Returns whether the last step had resting contacts, or contacts whose time was not located: then the
  /// error estimate of the method does not include the error of contact.
  bool has_contact_error() const { return has_unlocated_ || !resting_at_start_.empty(); }
  /// Returns whether step_by_doubling() is worth its cost: the model has few moving parts, and no contact of
  /// the last step is at nodes of a mesh.
  bool may_double() const;
  /// Return the contacts and impulses of the last whole step; empty if nothing touched.
  const ContactRecord& record() const { return record_; }
  const std::vector<Contact>& contacts() const { return record_.contacts; }
  const std::vector<Vec3<double>>& impulses() const { return record_.impulses; }

 private:
  ContactStepping(const Dynamics& dynamics, const ContactFinder* whole);
  class StageClock;
  struct Progress;
  struct Motion;
  double step_once(Integrator& method, StepContext& step, double tolerance);
  Progress begin(Integrator& method, StepContext& step, double tolerance);
  Motion advance(Progress& progress);
  Motion predict(Progress& progress);
  [[noreturn]] void fail_too_fast(const Progress& progress) const;
  bool detect(Motion& motion, Progress& progress);
  bool complete_prediction(Motion& motion, Progress& progress);
  ContactFinder::Neighbourhood look_ahead(const State& state, double now, double length, double fall,
                                          bool touch);
  bool wake_touched(const std::vector<Contact>& contacts, const FreeMotion& motion, State& state);
  void cut_at_friction_event(Motion& motion, Progress& progress, double tolerance);
  void record_resting(const Motion& motion, double tolerance);
  std::vector<Contact> impacts_to_locate(const Motion& motion) const;
  bool locate_and_apply_impact(Motion& motion, Progress& progress);
  void apply_impact(const Motion& motion, const std::vector<Contact>& impacts, Progress& progress);
  void resolve_resting(const Motion& motion, StepContext& step, StageClock& clock);
  void resolve_sequence(Motion& motion, StepContext& step);
  bool is_sequential() const { return dynamics_.model().body().contact.impacts == ImpactOrder::sequential; }
  void resolve(Motion& motion, Progress& progress);

  /// A whole step that is compared with its repetition in equal parts.
  struct Whole {
    const State state;                   ///< state at the end of the step
    const double length;                 ///< s
    const std::vector<Contact> resting;  ///< resting contacts in the step
    const std::size_t contacts;          ///< number of contacts that the step resolved
    const bool has_event;                ///< whether the step ended at an event
  };
  /// A step that was repeated in equal parts, the last of which may be shorter or longer.
  struct Fractions {
    double length = 0;              ///< of all parts, s
    bool even = true;               ///< whether all parts but the last had their full length
    bool equal_contacts = true;     ///< whether all but the last part have as many contacts as the whole step
    std::size_t last_contacts = 0;  ///< number of the first contact of the last part in the record
    /// Velocities that gravity adds in the whole step to the parts of pairs that have lost all contacts; n_v.
    VecX<double> gravity_velocities;
    bool finite = false;  ///< whether the state at the end is finite
  };
  Fractions step_fractions(int n, Integrator& method, StepContext& step, const Whole& whole,
                           const State& initial, double tolerance);
  bool agree(const Whole& whole, const Fractions& fractions, bool has_event, const State& state) const;
  /// A difference of the coordinates and velocities of two results.
  struct Difference {
    VecX<double> q, v;
  };
  double difference(const Whole& whole, const Fractions& fractions, bool agreed, const ErrorScale& scale,
                    double start, const State& state) const;
  double measure(const Difference& difference, double length, const Fractions& fractions, bool jumped,
                 const ErrorScale& scale, const State& state) const;
  /// Returns whether the step has ended at an event. before: the counters before the step.
  bool has_event(const StepContext& step, const StepCounters& before) const {
    return step.counters.impacts > before.impacts || at_friction_event_;
  }
  void restart_step(StepContext& step, const State& initial, const StepCounters& before);
  /// A result with longer steps, which is needed to extrapolate from the finest result.
  struct Coarse {
    State state;   ///< its coordinates and velocities; nodes may have the values of the finest result
    double share;  ///< the extrapolation adds this multiple of (finest result - state)
    const State& computed;  ///< the unchanged result, with its works
  };
  StepError step_by_thirds(Integrator& method, StepContext& step, const ErrorScale& scale, const Whole& whole,
                           const State& initial, const StepCounters& before, double error_of_halves);
  void extrapolate_rigid(StepContext& step, const std::vector<Coarse>& from, const Fractions& finest,
                         const State& initial);
  void include_openings(std::size_t first, double t, double h, State& state) const;
  State extrapolated(const State& finest, const std::vector<Coarse>& from,
                     const std::vector<int>& parts) const;
  void extrapolate(StepContext& step, const std::vector<Coarse>& from, std::size_t last,
                   const std::vector<int>& parts);
  bool has_deep_nodes(const State& state);
  bool copy_deep_nodes(double t, const State& full, const State& halves, State& coarse);
  void keep_momenta(double t, const std::vector<Vec3<double>>& momenta, const std::vector<int>& parts,
                    State& state);
  Coarse soft_extrapolation(double t, const State& start, const State& halves, const State& whole,
                            const std::vector<int>& parts);
  /// Values at the start of a step that may be repeated.
  struct Before {
    State state;
    ContactRecord record;
    double recorded;  ///< s
    StepCounters counters;
  };
  void extrapolate_soft_step(Integrator& method, StepContext& step, const Before& before, double length,
                             double tolerance);

  const Dynamics& dynamics_;
  ContactFinder finder_;
  MeshFinder meshes_;
  RestingContacts resting_;
  ContactRecord record_, record_before_;
  double recorded_ = 0;  ///< time since begin_step(), s
  ContactResolution resolution_;
  ImpactSequence impact_sequence_;
  Sleeping sleeping_;
  FrictionEvents friction_events_;
  Workspace<double> scratch_;
  bool few_parts_ = false;  ///< whether the model has so few moving parts that impacts are located
  // Of the last step: the contacts that rested at the start of a motion (only with a tolerance and few moving
  // parts), and whether there were other resting contacts, or contacts whose time was not located.
  std::vector<Contact> resting_at_start_;
  bool has_unlocated_ = false;
  bool at_friction_event_ = false;  ///< whether the last step ended at a change of friction
  /// Whether in the last step a part that deforms locally could touch something.
  bool soft_may_touch_ = false;
  StageTimes times_;
};

}  // namespace pliant
