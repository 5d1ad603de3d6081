// The projection that ends a step with its error, and the list of all methods.
#include <pliant/method/integrator.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include <pliant/body/speed_scale.h>
#include <pliant/method/dop853.h>
#include <pliant/method/dormand_prince.h>
#include <pliant/method/esdirk.h>
#include <pliant/method/implicit_midpoint.h>
#include <pliant/method/linearly_implicit.h>
#include <pliant/method/rk4.h>
#include <pliant/method/semi_implicit_euler.h>
#include <pliant/project/project.h>

namespace pliant {

namespace {
template <class Method>
std::unique_ptr<Integrator> make() {
  return std::make_unique<Method>();
}

/// Returns the error of a step of h s that ends at t (s) and in which a joint closes. The unit of an error of
/// the gap is the size of a part; the unit of an error of the rate of the gap is this size times `slow`
/// (slow_rate(), 1/s). The gap decays at the rate of the stabilization (1/s) until the gap is kClosedGap
/// sizes; the projection then removes the gap at once. The time of closing within the step is unknown. The
/// error is therefore the largest change of the gap, or of the rate of the gap, during the step.
double closing_error(double rate, double slow, double h, double t) {
  const double rounding = 1e3 * std::numeric_limits<double>::epsilon() * std::abs(t);  // error of the time, s
  return kClosedGap * std::min(1.0, rate * std::max(0.0, h - rounding)) * std::max(1.0, rate / slow);
}
}  // namespace

void Integrator::project(StepContext& step) {
  const State& state = step.state;
  if (scale_ != nullptr) {
    unprojected_ = state.q;
    joints_before_ = state.joints;
  }
  project_limits(step);
  project_joints(step);
  if (scale_ == nullptr) return;
  for (std::size_t j = 0; j < joints_before_.size(); ++j)
    if (joints_before_[j] == JointMode::closing && state.joints[j] != JointMode::closing)
      return record_error(
          closing_error(step.model().body().stabilization.rate, slow_rate(step.model()), state.h, step.t) /
          scale_->tolerance());
  unprojected_ -= state.q;
  record_error(scale_->norm(unprojected_));
}

const std::vector<IntegratorInfo>& all_integrators() {
  static const std::vector<IntegratorInfo> all{
      {"semi_implicit_euler", 1, "the method of the paper: one evaluation a step; robust, first order",
       &make<SemiImplicitEuler>},
      {"rk4", 4, "classical Runge-Kutta: four evaluations a step; accurate for smooth motion", &make<Rk4>},
      {"linearly_implicit", 2,
       "ROS2: two evaluations a step; the elasticity of parts that deform locally does not limit the step",
       &make<LinearlyImplicit>},
      {"implicit_midpoint", 2, "conserves quadratic invariants: for very many steps without friction",
       &make<ImplicitMidpoint>},
      {"esdirk", 4,
       "ESDIRK 4(3): for motion with stiff springs or parameters, with error control or fixed steps",
       &make<Esdirk>},
      {"dormand_prince", 5, "Dormand-Prince 5(4): for smooth motion, with error control or fixed steps",
       &make<DormandPrince>},
      {"dop853", 8,
       "Dormand-Prince 8(5,3): for smooth motion at high accuracy, with error control or fixed steps",
       &make<Dop853>},
  };
  return all;
}

std::vector<std::string> controlled_integrators() {
  std::vector<std::string> names;
  for (const IntegratorInfo& info : all_integrators())
    if (info.make()->error_order() > 0) names.emplace_back(info.name);
  return names;
}

std::unique_ptr<Integrator> make_integrator(const std::string& name) {
  std::string names;
  for (const IntegratorInfo& info : all_integrators()) {
    if (name == info.name) return info.make();
    names += std::string(names.empty() ? "" : ", ") + info.name;
  }
  throw std::invalid_argument("no integrator '" + name + "'; there are: " + names);
}

}  // namespace pliant
