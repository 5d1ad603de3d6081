// Contact resolution: impulses that satisfy Coulomb's law at the contacts, and the separation of bodies that
// still overlap.
#pragma once

#include <array>
#include <set>
#include <vector>

#include <pliant/body/step_counters.h>
#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/contact_problem.h>
#include <pliant/contact/resting_contacts.h>
#include <pliant/method/integrator.h>

namespace pliant {

/// The contact impulses of a step. A contact has one entry for each time at which an impulse acted: a step
/// with impacts, or with fast parts, consists of several motions.
struct ContactRecord {
  std::vector<Contact> contacts;
  std::vector<Vec3<double>> impulses;  ///< on the sides a, N s, world
  std::vector<double> sliding;         ///< tangential speeds after the impulses, m/s
  /// Reactions of all joints to these impulses: lambda, N s; C_q^T lambda acts on the parts.
  VecX<double> joint_impulses;
  std::vector<double> time;  ///< time in which each impulse acts: the length of the step of its bodies, s
  double overlap = 0;        ///< largest overlap after the last separation, m
  /// The worst residual of the impulses, and the worst overlap after the last separation: those with the
  /// largest ratio of ContactViolation::value to ContactViolation::tolerance.
  ContactViolation worst_residual{}, worst_overlap{};

  void clear();
};

/// The motion at whose end contacts are resolved.
struct ResolvedMotion {
  /// State at its start, after predicted impulses. For impulses at one instant (a located impact, an impact
  /// of a sequence or of a chain) it refers to step.state itself.
  const State& before;
  double force_time;  ///< Contact::since of impulses on limits and strings, s (FreeMotion::force_time)
  double h;           ///< length, s; 0 at a located impact: then nothing is cached, displaced or separated
  bool separates = true;  ///< whether overlaps are separated afterwards; another resolution follows if not
  /// Velocities at its start before predicted impulses; nullptr: there are no predicted impulses.
  const VecX<double>* v_unpredicted = nullptr;
};

/// Returns the data of a motion for the resolution at its end.
inline ResolvedMotion resolved_motion(const FreeMotion& free, bool separates = true) {
  return {free.before, free.force_time(), free.h, separates,
          free.has_predicted() ? &free.unpredicted.v : nullptr};
}

class ContactResolution {
 public:
  /// All arguments must outlive this object. record: the impulses are appended to it.
  ContactResolution(const Dynamics& dynamics, const ContactFinder& finder, MeshFinder& meshes,
                    RestingContacts& resting, ContactRecord& record);

  /// Begins a step: clears the impulses of the last step, and decides whether the contact solutions of this
  /// step start from the contact cache of the state. predicts: whether impulses are predicted; then the cache
  /// also contains contacts that share no part with others.
  void begin_step(const State& state, bool predicts);
  /// Stores the impulses of this step of h seconds in the contact cache of a state.
  void end_step(double h, State& state) const;

  /// Applies the impulses at the contacts at step.t, the end of a motion, and the displacements that these
  /// impulses cause (Contact::since). Then separates bodies that still overlap, unless motion.h is zero or
  /// motion.separates is false. contacts: must not refer to the result of RestingContacts::near(), because
  /// that list changes during the call.
  void resolve(StepContext& step, const ResolvedMotion& motion, const std::vector<Contact>& contacts);
  /// The impulses at the contacts `resolved` may have pushed bodies into others during the motion of step.h
  /// seconds. Resolves these impacts, and the impacts that follow, in at most four resolutions. If the fourth
  /// is needed, StepCounters::contact_cutoffs grows by one. Approaches and rebounds that are slower than
  /// min_impact_speed (m/s) are ignored.
  void resolve_chain(StepContext& step, std::vector<Contact> resolved, double min_impact_speed);

  /// Returns for each contact its index in the contact cache of a state, or -1 if it is not in the cache.
  std::vector<int> cached_numbers(const State& state, double t, const std::vector<Contact>& contacts) const;
  /// Sets the start values of the impulses of a problem to those of the cached forces over h seconds.
  /// Contacts that are not in the cache start from zero, and so do all contacts of a cold start.
  void warm_start(const State& state, double t, double h, const std::vector<Contact>& contacts,
                  ContactProblem& problem) const;
  /// After a change of velocities and coordinates of some parts, projects all joints and the frames of these
  /// parts if they deform locally (project_frames).
  void reconcile(StepContext& step, const std::vector<int>& parts) const;

 private:
  /// A resolved contact; CachedContact::force contains its impulse, N s. match_distance: another contact of
  /// the pair nearer than this (m) is the same contact. resolution: number of the resolution in the step.
  struct Resolved {
    CachedContact cached;
    double match_distance;
    int resolution;
  };

  double departure_from_tangent(const ContactSide& side, const Vec3<double>& x, const State& state,
                                double h) const;
  void resolve_once(StepContext& step, const ResolvedMotion& motion, const std::vector<Contact>& contacts,
                    bool warm);
  void measure_travel(const State& state, double h, const std::vector<Contact>& contacts);
  ContactSolution solve(StepContext& step, const ResolvedMotion& motion, const std::vector<Contact>& contacts,
                        bool warm, ContactProblem& problem);
  void append_to_record(const std::vector<Contact>& contacts, const ContactSolution& solution);
  double largest_separation(const Contact& contact, double h) const;
  void extend_travel(const Contact& contact, double distance);
  std::vector<bool> lasting(const ResolvedMotion& motion, const std::vector<Contact>& contacts) const;
  void record_resolved(const State& state, double t, const ResolvedMotion& motion,
                       const std::vector<Contact>& contacts, const ContactProblem& problem,
                       const std::vector<Vec3<double>>& impulses);
  Vec3<double> local_position(const Contact& contact, const State& state, double t) const;
  double match_distance(const Contact& contact) const;
  void add_ejections(const State& state);
  double allowed_overlap(const Contact& contact) const;
  void record_overlaps(const std::vector<Contact>& contacts, double t);
  void keep_affected(std::vector<Contact>& contacts, const Workspace<double>& work) const;
  bool is_separated(const std::vector<Contact>& contacts) const;
  std::vector<Contact> contacts_to_separate(const StepContext& step);
  void separate(StepContext& step, const std::vector<Contact>& contacts);
  void separate_overlaps(StepContext& step);

  const Dynamics& dynamics_;
  const ContactFinder& finder_;
  MeshFinder& meshes_;
  RestingContacts& resting_;
  ContactRecord& record_;
  Workspace<double> scratch_;
  std::vector<Resolved> resolved_;  // of this step
  int resolutions_ = 0;
  bool cold_start_ = false, predicts_ = false;
  double step_length_ = 0;  // s
  // Travel of each part since the last separation, m: the distance towards the bodies that it meets, plus its
  // displacements by impulses (ejections).
  std::vector<double> travel_;
  VecX<double> q_before_ejection_;
  // Pairs whose overlap was too deep to be separated in one step, and that have been separated by the allowed
  // distance.
  std::set<std::array<int, 4>> fully_separated_;
};

}  // namespace pliant
