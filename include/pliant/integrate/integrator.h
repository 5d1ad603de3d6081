// One interface for all methods of time integration, one file a method.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

/// Counts what a method did.
struct StepCounters {
  long steps = 0;
  long evaluations = 0;  ///< of the accelerations
  long limit_impulses = 0;
  long factorisations = 0;      ///< of the stiffness of nodes
  long impacts = 0;             ///< whose time in the step was found
  long contact_sweeps = 0;      ///< over all contacts
  long contact_fallbacks = 0;   ///< groups of contacts that were left with more than rounding of it
  double contact_residual = 0;  ///< the worst of them, m/s
};

class Integrator {
 public:
  virtual ~Integrator() = default;
  virtual const char* name() const = 0;
  virtual int order() const = 0;
  /// Advances q, v and work by state.h (> 0, s); the caller counts the step.
  virtual void step(const Dynamics& dynamics, State& state, Workspace<double>& work,
                    StepCounters& counters) = 0;
  /// Largest growth per step, |eigenvalue| of the step map, of x'' + D x' + K x = 0 with unit masses; the
  /// step is stable while it is at most 1.
  virtual double growth(const MatX<double>& K, const MatX<double>& D, double h) const = 0;
  /// How far a force moves a body in a step that is constant over it, in steps times what it adds to the
  /// velocity.
  virtual double reach() const { return 0.5; }
  /// Whether elasticity and damping of parts that deform locally, of their nodes and global parameters, leave
  /// the step free.
  virtual bool local_is_implicit() const { return false; }
};

struct IntegratorInfo {
  const char* name;
  int order;
  const char* description;
  std::unique_ptr<Integrator> (*make)();
};

/// All methods. A new one is its file and an entry here.
const std::vector<IntegratorInfo>& all_integrators();
/// Throws std::invalid_argument listing the names.
std::unique_ptr<Integrator> make_integrator(const std::string& name);

}  // namespace pliant
