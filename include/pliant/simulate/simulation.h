// Simulation: a model, its state and a method of integration. simulation-inl.h lists the stages of a step.
#pragma once

#include <functional>
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
#include <pliant/simulate/progress_watch.h>
#include <pliant/simulate/step_length.h>

namespace pliant {

class Clusters;         // simulate/clusters.h
class ContactStepping;  // contact/contact_stepping.h

class Simulation {
 public:
  /// Prepares the body, which must outlive the simulation, and starts at time 0. Parts are assembled if
  /// Stabilization::assemble_first is set. Joints with a small gap become closed, and impulses change the
  /// velocities so that these joints stay closed.
  /// integrator: the name of a method, or kAutomatic. threads: number of threads. tolerance: largest error of
  /// a step (method/error_scale.h); it determines the length of the steps. With tolerance 0 the caller gives
  /// the length of the steps; with kAutomatic, tolerance 0 means kStandardTolerance. Throws
  /// std::invalid_argument for an invalid model, method or tolerance, and for a tolerance with a method that
  /// has no error estimate. Throws UnsatisfiableModel if joints contradict each other, and NumericalFailure
  /// if the initial state cannot be evaluated or projected. stop: called during the trials of kAutomatic; the
  /// constructor throws ChoiceStopped if stop() returns true.
  explicit Simulation(MultiBody& body, const std::string& integrator = "semi_implicit_euler", int threads = 1,
                      double tolerance = 0, const std::function<bool()>& stop = {});
  ~Simulation();
  Simulation(const Simulation&) = delete;  // dynamics_ refers to model_
  Simulation& operator=(const Simulation&) = delete;

  /// Advances by h seconds (> 0 and finite). Without a tolerance the advance is one step, which is divided at
  /// the times of Model::switch_times() and at the kinks of Model::next_kink(). With a tolerance the advance
  /// consists of as many steps as the tolerance requires. Throws std::invalid_argument for an invalid
  /// h. Throws NumericalFailure or UnsatisfiableModel if a step fails, and restores the state before this
  /// step.
  void step(double h);
  /// Advances by one step of the length that the tolerance allows, or by one interval of the clusters. The
  /// step ends at the time `until` (s) at the latest. Throws std::invalid_argument unless `until` is finite
  /// and later than time(), std::logic_error without a tolerance, and the errors of step() if the step fails.
  void step_up_to(double until);

  const Model& model() const { return model_; }
  const Dynamics& dynamics() const { return dynamics_; }
  const Integrator& integrator() const { return *integrator_; }
  /// Returns the choice of kAutomatic with its reason; both texts are empty for a named method.
  const IntegratorChoice& choice() const { return choice_; }
  /// Returns the tolerance of the error of a step; 0 if the error is not controlled.
  double tolerance() const { return scale_ ? scale_->tolerance() : 0; }
  const State& state() const { return state_; }
  /// Continues from another state of this model. Forgets the contacts of the last step, and the impulses of
  /// joints after the time of the new state. Throws std::invalid_argument if the state does not fit the
  /// model.
  void set_state(State state);
  double time() const { return state_.time(); }
  /// Computes the inputs of the body (MultiBody::input) from the time t (s) and the state.
  using Controller = std::function<void(double t, const State& state, Eigen::Ref<VecX<double>> inputs)>;
  /// Sets a controller, which is called at the start of each step, or of each interval of the clusters. The
  /// inputs are constant in the step. With a tolerance, steps end at multiples of the sampling time of a
  /// digital controller if the caller advances by step(sampling time). Recordings do not contain the inputs.
  void set_controller(Controller controller) { controller_ = std::move(controller); }

  /// Returns the values of the sensors at the state, in the order of MultiBody::sensors(); for controllers
  /// and output.
  VecX<double> sensors();

  /// Returns energies, works, momenta and the balance error since the first state.
  Ledger ledger();
  /// Calls evaluate(workspace) for output. The workspace is that of the steps, and a step overwrites the
  /// results, with one exception: a method that reuses the accelerations at the end of the last step keeps
  /// the dependent rows of joints that this evaluation found (RankRule::keep). counters() omits these
  /// evaluations.
  template <class Evaluate>
  void evaluate_output(Evaluate&& evaluate) {
    const Counters before = counters();
    evaluate(work_);
    output_counters_ += counters() - before;
  }
  /// The energy of the first state, J, to which the balance refers. A resumed run sets it.
  double start_energy() const { return start_energy_; }
  void set_start_energy(double energy) { start_energy_ = energy; }

  /// Returns the report of the assembly before time 0; a default report unless Stabilization::assemble_first.
  const AssemblyReport& assembly() const { return assembly_; }
  /// Returns the contacts (contact/contact_stepping.h); nullptr if contact is not active in the body.
  const ContactStepping* contact() const { return contact_.get(); }
  /// Returns the clusters (simulate/clusters.h); nullptr if all parts step together.
  const Clusters* clusters() const { return clusters_.get(); }
  const StepCounters& step_counters() const { return step_counters_; }
  /// Returns the first steps that hardly advanced; std::nullopt if there were no such steps. ProgressWatch
  /// compares the advance of many steps with an interval. Without a tolerance, this interval is the length of
  /// one call of step(). With a tolerance, the interval is the time from the first state, or from that of the
  /// last set_state(), to the argument of the last step_up_to().
  const std::optional<SlowProgress>& slow_progress() const { return slow_progress_; }
  /// Returns the impulses of joints at the times at which joints engaged and at kinks of prescribed paths, in
  /// the order of time. Impulses as small as rounding errors are omitted.
  const std::vector<ImpulseOnEngage>& engage_impulses() const { return switching_.impulses(); }
  /// Returns the numbers of evaluations by kind (part/counters.h) in steps, summed over parts.
  Counters counters() const;
  /// Returns the names of the parameters ("part.parameter") and of the velocities of frames ("part.omega.x")
  /// that had no inertia in at least one step and were fixed in that step.
  std::set<std::string> velocities_without_inertia() const;

 private:
  friend class Clusters;
  /// Makes the simulation of a cluster: of some parts of the body of the simulation `whole`, which must
  /// outlive this simulation.
  Simulation(const Simulation& whole, const std::vector<int>& parts);
  template <class Advance>
  void with_rollback(double h, Advance&& step);
  void advance(double h);
  double integrate();
  void controlled_step(double end);
  void advance_clusters(double end);
  void absorb(Simulation& cluster);
  void forget_counters();
  void forget_evaluations();
  void set_method(std::unique_ptr<Integrator> method);
  StepError try_step();
  void estimate_contact_error(const StepCounters& before, StepError& result);
  void fail_to_meet_tolerance();
  void watch_progress(double start, const StepCounters& before);
  bool shorter_steps_pass(double h);
  void begin_step();
  void reject_step();
  void end_step();
  [[noreturn]] void fail_by(const std::string& fault);
  double stable_step_at_start();
  NumericalFailure completed(const std::string& what, double t, double h);
  StepContext context();
  void switch_joints(double t, double tolerance);
  void follow_paths(double kink, double tolerance);
  void switch_springs(double kink, double tolerance);
  void record_contact_errors();
  void record_without_inertia();

  Model model_;
  std::unique_ptr<ThreadPool> pool_;
  Dynamics dynamics_;
  JointSwitching switching_;
  std::unique_ptr<Integrator> integrator_;
  std::optional<ErrorScale> scale_;  ///< only with a tolerance
  IntegratorChoice choice_;
  std::unique_ptr<ContactStepping> contact_;  ///< nullptr if contact is not active
  std::unique_ptr<Clusters> clusters_;        ///< nullptr if all parts step together
  Controller controller_;
  State state_, last_good_, attempt_start_;
  State first_;  ///< the state at the start, or the state of the last set_state()
  Workspace<double> work_;
  StepCounters step_counters_;
  ProgressWatch watch_;
  double interval_ = 0;  ///< the interval with which watch_ compares the advance of steps, s
  std::optional<SlowProgress> slow_progress_;
  AssemblyReport assembly_;
  std::vector<bool> without_inertia_;  ///< whether each velocity had no inertia in at least one step
  Counters absorbed_counters_;         ///< evaluations of clusters
  Counters output_counters_;           ///< evaluations in work_ by evaluate_output()
  double start_energy_ = 0;
};

/// Returns the largest step (s) for which the method keeps the motion about the state bounded; infinite if
/// nothing limits the step. The step is limited by
///   - the eigenvalues of the linearised equations of motion, with elasticity, damping, springs and joints,
///   - Baumgarte's terms with constant gains, if a joint is open or not projected,
///   - a rotation of half a radian per step,
///   - one radian of phase per step of each mode, if impacts or springs can excite the mode.
/// If the method integrates local elasticity implicitly, only springs, drag and rotation limit the parts that
/// deform locally.
double largest_stable_step(const Simulation& simulation);

}  // namespace pliant
