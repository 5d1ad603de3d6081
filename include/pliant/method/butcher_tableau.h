// The coefficients of an explicit Runge-Kutta method with an estimate of its error, and of its continuous
// extension.
#pragma once

namespace pliant {

/// What makes a step of a Runge-Kutta method a polynomial of the place x in it, from 0 to 1 (Hairer, Norsett
/// & Wanner, Solving Ordinary Differential Equations I, section II.6):
///   u(x) = u_0 + x (u_1 - u_0 + y (a + x (b + y (h d_0 k + x (h d_1 k + y (...))))))),   y = 1 - x,
/// with a = h k_0 - (u_1 - u_0), b = u_1 - u_0 - h k_end - a, as by cubic Hermite interpolation.
struct ContinuousExtension {
  int stages;       ///< more than the method has, after the rates at the end
  const double* a;  ///< of these, row by row: of all k before, with that at the end
  const double* c;
  int terms;        ///< d_0, d_1, ...
  const double* d;  ///< row by row: of all k
};

struct ButcherTableau {
  const char* name;
  int order, stages;
  const double *a, *b, *c;  ///< a: row by row what lies below its diagonal, from the second row on
  /// k_i times these is the error of a method of lower order; second: of one of an even lower, nullptr for
  /// none. They have an entry more where the rates at the end of the step count.
  const double *error, *second_error;
  int error_order;    ///< the estimate is O(h^(error_order + 1))
  bool rates_at_end;  ///< whether they count
  const ContinuousExtension* between = nullptr;
};

}  // namespace pliant
