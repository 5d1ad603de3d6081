#include <pliant/body/actuation/state_function.h>

#include <stdexcept>

namespace pliant {

StateFunction::StateFunction(Formula formula, std::vector<Signal> signals) {
  if (signals.size() > kMaxSignals)
    throw std::invalid_argument("a formula reads more than " + std::to_string(kMaxSignals) + " quantities");
  of_state_ = std::make_shared<const OfState>(OfState{std::move(formula), std::move(signals)});
}

const std::vector<Signal>& StateFunction::signals() const {
  static const std::vector<Signal> none;
  return of_state_ == nullptr ? none : of_state_->signals;
}

}  // namespace pliant
