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

class ContactResolution {
 public:
  /// All must outlive it. record: what is added to.
  ContactResolution(const Dynamics& dynamics, const ContactFinder& finder, MeshFinder& meshes,
                    RestingContacts& resting, ContactRecord& record);

  /// Forgets what took something, and settles whether searches of this step begin at the supports of a state.
  void begin_step(const State& state);
  /// What took something of this step, of so many seconds, becomes the supports of a state.
  void end_step(double h, State& state) const;

  /// Impulses at contacts at the end of a step of h seconds from a state before, each as long ago as it says;
  /// then what still overlaps is parted.
  void resolve(const State& before, double since_of_limits, double h, State& state, double t,
               std::vector<Contact> contacts, Workspace<double>& work, StepCounters& counters);
  /// Impulses of a step of h seconds at some contacts throw bodies against others that were out of their way:
  /// these impacts are of the same step, and so are those that follow from them.
  void resolve_chain(std::vector<Contact> resolved, double h, double slow, State& state, double t,
                     Workspace<double>& work, StepCounters& counters);

  /// After velocities and places of some parts have changed: frames follow the nodes, joints hold.
  void reconcile(const std::vector<int>& parts, State& state, double t, Workspace<double>& work,
                 StepCounters& counters) const;

 private:
  double sweep(const ContactSide& side, const Vec3<double>& x, const State& state, double h) const;
  void resolve_once(const State& before, double since_of_limits, double h, State& state, double t,
                    std::vector<Contact> contacts, bool begins, Workspace<double>& work,
                    StepCounters& counters);
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
  void separate_overlaps(double h, State& state, double t, Workspace<double>& work, StepCounters& counters);

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
