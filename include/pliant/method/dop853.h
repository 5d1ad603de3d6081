// DOP853: the explicit Runge-Kutta method of order 8 with 12 stages by Dormand and Prince. Embedded methods
// of orders 5 and 3 estimate its error (Hairer, Norsett & Wanner, Solving Ordinary Differential Equations I,
// section II.10).
#pragma once

#include <pliant/method/explicit_runge_kutta.h>

namespace pliant {

class Dop853 final : public ExplicitRungeKutta {
 public:
  Dop853();
};

}  // namespace pliant
