// Simulation: a model, its state, and a method that steps it.
#pragma once

#include <memory>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <pliant/body/step_failure.h>
#include <pliant/method/error_scale.h>
#include <pliant/method/integrator.h>
#include <pliant/method/step_error.h>
#include <pliant/project/assemble.h>
#include <pliant/project/joint_switching.h>
#include <pliant/simulate/choose_integrator.h>
#include <pliant/simulate/step_length.h>

namespace pliant {

class ContactStepping;  // contact/contact_stepping.h

class Simulation {
 public:
  /// Prepares the body (which must outlive the simulation) and starts at time 0: joints with a small gap are
  /// closed, and the velocities made to agree with them. integrator: the name of a method, or kAutomatic.
  /// tolerance: of the error of a step, which then finds its own length (integrate/error_scale.h says what it
  /// is a part of); 0: steps are as long as they are asked to be, or kStandardTolerance with kAutomatic.
  /// Throws std::invalid_argument, UnsatisfiableModel.
  explicit Simulation(MultiBody& body, const std::string& integrator = "semi_implicit_euler", int threads = 1,
                      double tolerance = 0);
  ~Simulation();
  Simulation(const Simulation&) = delete;  // its dynamics refer to its own model
  Simulation& operator=(const Simulation&) = delete;

  /// Goes on by h seconds (> 0 and finite): by one step, made in several where joints begin or cease to act
  /// within it; with a tolerance by as many as that needs. Throws NumericalFailure, UnsatisfiableModel,
  /// std::invalid_argument.
  void step(double h);
  /// With a tolerance: one step of the length that it allows, which ends at a time (s, later than now) at the
  /// latest, and then exactly there. Throws as step() does, std::logic_error without a tolerance.
  void step_up_to(double until);

  const Model& model() const { return model_; }
  const Dynamics& dynamics() const { return dynamics_; }
  const Integrator& integrator() const { return *integrator_; }
  /// Which method was chosen with kAutomatic, and why; empty without.
  const IntegratorChoice& choice() const { return choice_; }
  /// Of the error of a step; 0: it is not controlled.
  double tolerance() const { return scale_ ? scale_->tolerance() : 0; }
  const State& state() const { return state_; }
  /// Goes on from another state of the same model.
  void set_state(State state);
  double time() const { return state_.time(); }

  /// Energies, works, momenta and the balance since the simulation's first state.
  Ledger ledger();
  /// The energy that the balance refers to: at the first state. Set on resuming a recorded run.
  double start_energy() const { return start_energy_; }
  void set_start_energy(double energy) { start_energy_ = energy; }

  /// What assembly before time 0 did, when it was asked for.
  const AssemblyReport& assembly() const { return assembly_; }
  /// What touches; nullptr where nothing can.
  const ContactStepping* contact() const { return contact_.get(); }
  const StepCounters& step_counters() const { return step_counters_; }
  /// The impulses of joints that took hold of moving parts, or of which a path's rate jumped, in the order of
  /// time; those that are mere rounding are left out.
  const std::vector<ImpulseOnEngage>& engage_impulses() const { return switching_.impulses(); }
  /// Work of the kernels, summed over parts.
  Counters counters() const;
  /// Parameters that once had no inertia and were held: "part.parameter".
  std::set<std::string> held() const;

 private:
  template <class Advance>
  void guarded(double h, Advance&& step);
  void advance(double h);
  double take_step();
  void set_method(std::unique_ptr<Integrator> method);
  StepError try_step();
  void step_in_contact(long impacts, StepError& result);
  void fail_to_meet_tolerance();
  bool shorter_steps_pass(double h);
  void begin_step();
  void reject_step();
  void end_step();
  [[noreturn]] void fail_not_finite(const std::string& where);
  StepContext context();
  void switch_joints(double t, double near);
  void follow_paths(double kink, double near);
  void record_held();

  Model model_;
  std::unique_ptr<ThreadPool> pool_;
  Dynamics dynamics_;
  JointSwitching switching_;
  std::unique_ptr<Integrator> integrator_;
  std::optional<ErrorScale> scale_;  ///< with a tolerance
  IntegratorChoice choice_;
  std::unique_ptr<ContactStepping> contact_;  ///< where anything touches
  State state_, last_good_, begun_;
  Workspace<double> work_, output_work_;
  StepCounters step_counters_;
  AssemblyReport assembly_;
  std::vector<bool> held_;  ///< by velocity
  double start_energy_ = 0;
};

/// The largest step (s) for which the method keeps the motion about a state bounded, by the linearised
/// elasticity and damping of global parameters and springs, by how fast parts with joints sway, by
/// Baumgarte's terms where a gap is left to them, and by the turning of the parts (half a radian a step);
/// infinite when nothing is stiff and nothing turns. Parts tied by springs are taken together, as far as that
/// is cheap; beyond, one by one, each spring counted twice. Elasticity counts as if there were no joints,
/// which only slow it down. Both are on the safe side. A method that takes local elasticity implicitly is
/// bounded by neither that nor the stiffness of global parameters of such parts, but by springs at their
/// nodes as if these were free.
double largest_stable_step(const Simulation& simulation);

}  // namespace pliant
