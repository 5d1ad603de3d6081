#include <pliant/integrate/step_path.h>

#include <pliant/integrate/advance.h>

namespace pliant {

StepPath::StepPath(const Dynamics& dynamics, const State& low, double h, const State& high)
    : model_(dynamics.model()), low_(low), high_(high), h_(h) {
  dynamics.coordinate_rates(low.q, low.v, low_rate_);
  dynamics.coordinate_rates(high.q, high.v, high_rate_);
}

void StepPath::at(double x, VecX<double>& q) const {
  const double y = 1 - x, of_high = x * x * (3 - 2 * x), of_low = 1 - of_high;
  q = of_low * low_.q + of_high * high_.q + (h_ * x * y * y) * low_rate_ - (h_ * x * x * y) * high_rate_;
  normalise_rotations(model_, q);
}

}  // namespace pliant
