// DOP853: the explicit Runge-Kutta method of order 8 by Dormand and Prince with 12 stages, whose error is
// estimated by its methods of orders 5 and 3 (Hairer, Norsett & Wanner, Solving Ordinary Differential
// Equations I, section II.10; coefficients of their code DOP853).
#pragma once

#include <pliant/method/explicit_runge_kutta.h>

namespace pliant {

class Dop853 final : public ExplicitRungeKutta {
 public:
  Dop853();
};

}  // namespace pliant
