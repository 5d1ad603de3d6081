// Steps of bodies that touch, around any method of integration. A step that meets nothing is the method's
// own. Where surfaces meet that were apart, the time of the impact is found and the impulses act there; where
// they lie on each other, the impulses of a step act as forces do that are constant over it, so that what
// rests or sticks does so to the last bit. Many impacts in one step are taken at its end.
#pragma once

#include <optional>
#include <vector>

#include <pliant/contact/contact_problem.h>
#include <pliant/contact/find_contacts.h>
#include <pliant/contact/mesh_finder.h>
#include <pliant/integrate/integrator.h>

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

class ContactStepping {
 public:
  /// dynamics: must outlive it. Throws std::invalid_argument, see ContactFinder.
  explicit ContactStepping(const Dynamics& dynamics);

  /// A new step begins, which may come in parts; the one that began last counts for nothing.
  void begin_step();
  void undo_step();
  /// Advances q, v and work by state.h, or to the first impact that is told in time where the step is to end
  /// there, and returns by how much; the caller counts the step.
  double step(Integrator& method, State& state, Workspace<double>& work, StepCounters& counters,
              bool to_impact = false);

  const ContactFinder& finder() const { return finder_; }
  /// Whether some of what touched in the last step did so for a time, or was not met at its time.
  bool any_lasts() const;
  /// Of the last whole step; empty where nothing touched.
  const ContactRecord& record() const { return record_; }
  const std::vector<Contact>& contacts() const { return record_.contacts; }
  const std::vector<Vec3<double>>& impulses() const { return record_.impulses; }

 private:
  double resting_gap(const Contact& contact) const;
  bool rests(const Contact& contact, double gap, double velocity, double slow) const;
  bool rested(const Contact& contact, const State& before, const State& state, double reach,
              double slow) const;
  std::vector<Contact> resting_at(const State& state, double t, double slow);
  std::optional<double> locate(Integrator& method, const State& before, double t, double h,
                               const std::vector<Contact>& impacts, State& state, Workspace<double>& work,
                               StepCounters& counters) const;
  void time_impacts(const State& before, const State& state, double reach, double h, double slow,
                    std::vector<Contact>& contacts) const;
  void settle(const State& before, double since_of_limits, double h, State& state, double t,
              std::vector<Contact> contacts, Workspace<double>& work, StepCounters& counters);
  void reconcile(const std::vector<int>& parts, State& state, double t, Workspace<double>& work,
                 StepCounters& counters) const;
  const std::vector<Contact>& near(const State& state, double t);
  void settle_chain(std::vector<Contact> settled, double h, double slow, State& state, double t,
                    Workspace<double>& work, StepCounters& counters);
  void part_overlaps(double most, State& state, double t, Workspace<double>& work, StepCounters& counters);
  bool driven(const std::vector<int>& parts) const;
  std::vector<int> parts_touched(const std::vector<Contact>& contacts) const;
  void evaluate(const State& state, double t, const std::vector<Contact>& contacts,
                Workspace<double>& work) const;
  void move(const ContactProblem& problem, const Workspace<double>& work, State& state) const;

  const Dynamics& dynamics_;
  ContactFinder finder_;
  MeshFinder meshes_;
  double resting_gap_ = 0;  ///< of the largest part, m
  bool few_parts_ = false;  ///< so that impacts are told in time
  // What lies near each other in a state that was looked at last.
  VecX<double> last_q_;
  double last_t_ = 0;
  std::vector<Contact> last_;
  ContactRecord record_, record_before_;
};

}  // namespace pliant
