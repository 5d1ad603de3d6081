// Impulses of contact: where bodies meet they are stopped, and what still overlaps is parted.
#pragma once

#include <array>
#include <set>
#include <vector>

#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/contact_problem.h>
#include <pliant/contact/resting_contacts.h>
#include <pliant/method/integrator.h>

namespace pliant {

/// What impulses did in a step: an entry for each time that they acted at a contact. Impacts within a step,
/// and parts that move far in it, have it made in several parts.
struct ContactRecord {
  std::vector<Contact> contacts;
  std::vector<Vec3<double>> impulses;  ///< on their sides a, N s, world
  std::vector<double> sliding;         ///< speeds along them afterwards, m/s
  VecX<double> joint_impulses;  ///< that equations of joints took up of them: on the parts act C_q^T of it

  void clear();
};

/// The motion that ends where contacts are resolved. `before` is the state itself for an impulse at one
/// moment.
struct ResolvedMotion {
  const State& before;
  double held;  ///< impulses on limits stand for forces over this time, s (FreeMotion::held)
  double h;     ///< length of the motion, s; 0 for an impulse at one moment
};

class ContactResolution {
 public:
  /// All must outlive it. record: what is added to.
  ContactResolution(const Dynamics& dynamics, const ContactFinder& finder, MeshFinder& meshes,
                    RestingContacts& resting, ContactRecord& record);

  /// Forgets what took something, and settles whether searches of this step begin at the supports of a state.
  void begin_step(const State& state);
  /// What took something of this step, of so many seconds, becomes the supports of a state.
  void end_step(double h, State& state) const;

  /// Applies impulses at contacts at step.t, the end of a motion, each for the time that it says, and then
  /// separates what still overlaps.
  void resolve(StepContext& step, const ResolvedMotion& motion, std::vector<Contact> contacts);
  /// Resolves the impacts of bodies that the impulses at these contacts ejected against others, in the motion
  /// of step.h seconds, and the impacts that follow from them. slow: speeds below it do not rebound, m/s.
  void resolve_chain(StepContext& step, std::vector<Contact> resolved, double slow);

  /// Projects frames and joints after velocities and places of some parts have changed.
  void reconcile(StepContext& step, const std::vector<int>& parts) const;

 private:
  double sweep(const ContactSide& side, const Vec3<double>& x, const State& state, double h) const;
  void resolve_once(StepContext& step, const ResolvedMotion& motion, std::vector<Contact> contacts,
                    bool warm);
  double largest_separation(const Contact& contact, double h) const;
  void travel(const Contact& contact, double far);
  void warm_start(const State& state, double t, double h, const std::vector<Contact>& contacts,
                  ContactProblem& problem) const;
  void note_pushed(const State& state, double t, const std::vector<Contact>& contacts,
                   const ContactProblem& problem, const std::vector<Vec3<double>>& impulses);
  Vec3<double> place(const Contact& contact, const State& state, double t) const;
  double same_within(const Contact& contact) const;
  void add_ejections(const State& state);
  double may_overlap(const Contact& contact) const;
  void keep_concerned(std::vector<Contact>& contacts, const Workspace<double>& work) const;
  void separate_overlaps(StepContext& step);

  const Dynamics& dynamics_;
  const ContactFinder& finder_;
  MeshFinder& meshes_;
  RestingContacts& resting_;
  ContactRecord& record_;
  Workspace<double> scratch_;
  /// A support whose force is still an impulse, N s, how near another is the same, m, and the number of the
  /// settlement in the step.
  struct Pushed {
    CachedContact support;
    double same_within;
    int resolution;
  };
  std::vector<Pushed> pushed_;  // of the step
  int resolutions_ = 0;
  bool cold_start_ = false;
  // Of the step: how far parts go in it towards what they meet, or are thrown, m; and what touches what, as
  // PairKey says, that was too deep to be parted wholly and has been parted by what it may.
  std::vector<double> travel_;
  VecX<double> ejected_from_;
  std::set<std::array<int, 4>> fully_separated_;
};

}  // namespace pliant
