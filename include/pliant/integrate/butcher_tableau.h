// The coefficients of an explicit Runge-Kutta method with an estimate of its error.
#pragma once

namespace pliant {

struct ButcherTableau {
  const char* name;
  int order, stages;
  const double *a, *b, *c;  ///< a: row by row what lies below its diagonal, from the second row on
  /// k_i times these is the error of a method of lower order; second: of one of an even lower, nullptr for
  /// none. They have an entry more where the rates at the end of the step count.
  const double *error, *second_error;
  int error_order;    ///< the estimate is O(h^(error_order + 1))
  bool rates_at_end;  ///< whether they count
};

}  // namespace pliant
