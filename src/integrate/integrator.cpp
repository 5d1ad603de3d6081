#include <pliant/integrate/integrator.h>

#include <stdexcept>

#include <pliant/integrate/linearly_implicit.h>
#include <pliant/integrate/rk4.h>
#include <pliant/integrate/semi_implicit_euler.h>

namespace pliant {

namespace {
template <class Method>
std::unique_ptr<Integrator> make() {
  return std::make_unique<Method>();
}
}  // namespace

const std::vector<IntegratorInfo>& all_integrators() {
  static const std::vector<IntegratorInfo> all{
      {"semi_implicit_euler", 1, "the paper's: one evaluation a step; robust, first order",
       &make<SemiImplicitEuler>},
      {"rk4", 4, "classical Runge-Kutta: four evaluations a step; accurate for smooth motion", &make<Rk4>},
      {"linearly_implicit", 2,
       "ROS2: two evaluations a step; the elasticity of parts that deform locally does not limit it",
       &make<LinearlyImplicit>},
  };
  return all;
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
