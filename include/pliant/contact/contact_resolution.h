// Resolution of contacts: impulses, then separation of the overlaps that remain.
#pragma once

#include <array>
#include <set>
#include <vector>

#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/contact_problem.h>
#include <pliant/contact/resting_contacts.h>
#include <pliant/method/integrator.h>

namespace pliant {

/// The impulses of a step, one entry for each time that an impulse acted at a contact. Impacts within a step,
/// and fast parts, divide the step into several motions.
struct ContactRecord {
  std::vector<Contact> contacts;
  std::vector<Vec3<double>> impulses;  ///< on side a, N s, world
  std::vector<double> sliding;         ///< tangential speeds afterwards, m/s
  VecX<double> joint_impulses;  ///< reactions of the joints, on their rows: C_q^T of it acts on the parts

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
  /// All arguments must outlive the object. record: receives the contacts and impulses.
  ContactResolution(const Dynamics& dynamics, const ContactFinder& finder, MeshFinder& meshes,
                    RestingContacts& resting, ContactRecord& record);

  /// Begins a step: decides whether its resolutions warm-start from the contact cache of the state.
  void begin_step(const State& state);
  /// Stores the mean forces of the step, of h seconds, as the contact cache of the state.
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
  /// A cached contact with its impulse in place of a force, N s; the distance within which another contact is
  /// the same, m; and the number of the resolution in the step.
  struct Pushed {
    CachedContact support;
    double same_within;
    int resolution;
  };
  std::vector<Pushed> pushed_;  // in this step
  int resolutions_ = 0;
  bool cold_start_ = false;
  // In this step: how far parts travel towards contacts, or are ejected, m; and the pairs that were too deep
  // for a whole separation and have been separated as far as allowed.
  std::vector<double> travel_;
  VecX<double> ejected_from_;
  std::set<std::array<int, 4>> fully_separated_;
};

}  // namespace pliant
