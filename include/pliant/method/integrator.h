// The interface of all methods of integration; each method has a file of its own. README.md of this folder
// lists the methods and explains how to add one.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <pliant/body/step_context.h>
#include <pliant/math/max_or_nan.h>
#include <pliant/method/error_scale.h>
#include <pliant/method/step_path.h>

namespace pliant {

class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual const char* name() const = 0;
  virtual int order() const = 0;
  /// Advances q, v and work of step.state by its step length h (> 0, s), and sets step.t to the end of the
  /// step. The caller increments State::step.
  virtual void step(StepContext& step) = 0;
  /// Returns the largest growth in a step, |eigenvalue| of the step map, for x'' + D x' + K x = 0 with unit
  /// masses. A step of h is stable if the growth is at most 1. K: 1/s^2, D: 1/s, n x n each; h: s.
  virtual double growth(const MatX<double>& K, const MatX<double>& D, double h) const = 0;
  /// Returns the displacement that a constant force causes in a step of length h, divided by h and by the
  /// change of velocity that the force causes.
  virtual double reach() const { return 0.5; }
  /// Sets whether parts that deform locally may touch something in the next steps. Only
  /// linearly_implicit uses this.
  virtual void expect_touch(bool) {}
  /// If the flag is true, replaces M^-1 of each implicit part (implicit/implicit_part.h) in work. The
  /// replacement is the response of the part to impulses over the last step (LocalResponse). If the flag is
  /// false, restores M^-1, which an evaluation needs. work: the evaluation at the end of the step.
  virtual void set_responses(const Model&, bool, Workspace<double>&) const {}
  /// Returns the largest number of velocities of one part for which the method can solve its equations.
  virtual Eigen::Index max_velocities() const { return std::numeric_limits<Eigen::Index>::max(); }
  /// Returns whether elasticity and damping of parts that deform locally are implicit. They then do not limit
  /// the length of a step.
  virtual bool local_is_implicit() const { return false; }

  /// Returns the coordinates between two states `low` and `high` of the last step, h seconds apart: the dense
  /// output of the method, which may cost evaluations, or cubic Hermite interpolation if there is none.
  virtual StepPath path(const Dynamics& dynamics, const State& low, double h, const State& high,
                        StepCounters&) {
    return {dynamics, low, h, high};
  }

  /// Returns p if the estimated error of a step is O(h^(p + 1)), or 0 if the method has no error estimate.
  virtual int error_order() const { return 0; }
  /// Measures the errors of the next steps by this scale, which must outlive these steps; nullptr: no
  /// measurement.
  void measure(const ErrorScale* scale) { scale_ = scale; }
  /// Returns the largest error of the steps since the last call, in tolerances, or NaN if one of the errors
  /// is NaN. Resets the error to 0.
  double pop_error() { return std::exchange(error_, 0); }

 protected:
  const ErrorScale* scale() const { return scale_; }
  /// Includes an error, in tolerances, in the next result of pop_error().
  void record_error(double error) { error_ = max_or_nan(error, error_); }
  /// Projects limits, strings and joints at the end of a step, for all methods that do not apply impulses
  /// before the coordinates move. The error of the step includes the displacement by the projection or, if a
  /// joint closes in the step, the effect of the unknown time of closing.
  void project(StepContext& step);

 private:
  VecX<double> unprojected_;
  std::vector<JointMode> joints_before_;
  const ErrorScale* scale_ = nullptr;
  double error_ = 0;
};

/// While the object exists, implicit parts respond to impulses as they do over a whole step
/// (Integrator::set_responses).
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

/// One entry of the list of methods.
struct IntegratorInfo {
  const char* name;
  int order;
  const char* description;  ///< for users: `pliant list` and the schema of scenes
  std::unique_ptr<Integrator> (*make)();
};

/// Returns all methods. A new method needs its own file and an entry in this list.
const std::vector<IntegratorInfo>& all_integrators();
/// Returns the names of the methods with an error estimate.
std::vector<std::string> controlled_integrators();
/// Returns a new method of this name. Throws std::invalid_argument, with all names, if there is none.
std::unique_ptr<Integrator> make_integrator(const std::string& name);

}  // namespace pliant
