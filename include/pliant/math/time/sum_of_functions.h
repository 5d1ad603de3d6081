// The sum of two functions of time.
#pragma once

#include <memory>
#include <utility>

#include <pliant/math/time_function.h>

namespace pliant {

/// f(t) + g(t). The sum has the kinks of f and of g.
class SumOfFunctions final : public TimeFunction::Impl {
 public:
  SumOfFunctions(TimeFunction f, TimeFunction g) : f_(std::move(f)), g_(std::move(g)) {}

  Taylor2<double> at(double t) const override { return f_.at(t) + g_.at(t); }
  Kink first_kink(double after, double until) const override {
    return f_.first_kink(after, until).or_sooner(g_.first_kink(after, until));
  }

 private:
  TimeFunction f_, g_;
};

/// Returns the sum of two functions of time. The sum of two constants is constant.
inline TimeFunction operator+(const TimeFunction& f, const TimeFunction& g) {
  if (f.is_constant() && g.is_constant()) return f.first_value() + g.first_value();
  return TimeFunction(std::make_shared<SumOfFunctions>(f, g));
}

}  // namespace pliant
