// One interface for all methods of time integration, one file a method.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/step_context.h>
#include <pliant/method/error_scale.h>
#include <pliant/method/step_path.h>

namespace pliant {

class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual const char* name() const = 0;
  virtual int order() const = 0;
  /// Advances q, v and work of the state by step.h (> 0, s) from step.t on; step.t becomes the end of the
  /// step. The caller counts the step.
  virtual void step(StepContext& step) = 0;
  /// Largest growth per step, |eigenvalue| of the step map, of x'' + D x' + K x = 0 with unit masses; the
  /// step is stable while it is at most 1.
  virtual double growth(const MatX<double>& K, const MatX<double>& D, double h) const = 0;
  /// How far a force moves a body in a step that is constant over it, in steps times what it adds to the
  /// velocity.
  virtual double reach() const { return 0.5; }
  /// In the steps from here on parts that deform locally may touch something, or not.
  virtual void expect_touch(bool) {}
  /// Makes what pushes parts do to them what it does over the step taken last, where that is not M^-1
  /// (LocalResponse), or takes that away; an evaluation needs it away. work: of the end of the step.
  virtual void set_responses(const Model&, bool, Workspace<double>&) const {}
  /// Whether elasticity and damping of parts that deform locally, of their nodes and global parameters, leave
  /// the step free.
  virtual bool local_is_implicit() const { return false; }

  /// What the step that was taken last, of h seconds between two states, is in between: as well as the method
  /// knows, which may take some evaluations; else without one.
  virtual StepPath path(const Dynamics& dynamics, const State& low, double h, const State& high,
                        StepCounters&) {
    return {dynamics, low, h, high};
  }

  /// The error that is estimated of a step is O(h^(this + 1)); 0: none is.
  virtual int error_order() const { return 0; }
  /// From here on errors of steps are measured in this; nullptr: they are not.
  void measure(const ErrorScale* scale) { scale_ = scale; }
  /// The largest error of the steps since it was asked last, in tolerances.
  double take_error() { return std::exchange(error_, 0); }

 protected:
  const ErrorScale* scale() const { return scale_; }
  void note_error(double error) {
    if (!(error <= error_)) error_ = error;
  }
  /// What every method does with a state that it has brought to the end of a step, at time t (s): it keeps to
  /// limits, strings and joints. What that moves is an error of the step too; of joints that close the time
  /// is.
  void project(StepContext& step);

 private:
  VecX<double> unprojected_;
  std::vector<JointMode> joints_before_;
  const ErrorScale* scale_ = nullptr;
  double error_ = 0;
};

/// While it lives, pushes do what they do over a step.
class StepResponses {
 public:
  StepResponses(const Integrator& method, const Model& model, Workspace<double>& work)
      : method_(method), model_(model), work_(work) {
    method_.set_responses(model_, true, work_);
  }
  ~StepResponses() { method_.set_responses(model_, false, work_); }
  StepResponses(const StepResponses&) = delete;
  StepResponses& operator=(const StepResponses&) = delete;

 private:
  const Integrator& method_;
  const Model& model_;
  Workspace<double>& work_;
};

struct IntegratorInfo {
  const char* name;
  int order;
  const char* description;
  std::unique_ptr<Integrator> (*make)();
};

/// All methods. A new one is its file and an entry here.
const std::vector<IntegratorInfo>& all_integrators();
/// Names of those that tell the error of their steps.
std::vector<std::string> controlled_integrators();
/// Throws std::invalid_argument listing the names.
std::unique_ptr<Integrator> make_integrator(const std::string& name);

}  // namespace pliant
