// The explicit Runge-Kutta method of order 5 by Dormand and Prince (1980). An embedded method of order 4
// estimates its error (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I, table II.5.2).
#pragma once

#include <pliant/method/explicit_runge_kutta.h>

namespace pliant {

class DormandPrince final : public ExplicitRungeKutta {
 public:
  DormandPrince();
};

}  // namespace pliant
