// Coefficients of an explicit Runge-Kutta method, of its error estimate and of its dense output.
#pragma once

namespace pliant {

/// Dense output of a Runge-Kutta method: a polynomial in the fraction x of the step, from 0 to 1 (Hairer,
/// Norsett & Wanner, Solving Ordinary Differential Equations I, section II.6):
///   u(x) = u_0 + x (u_1 - u_0 + y (a + x (b + y (h d_0 k + x (h d_1 k + y (...))))))),   y = 1 - x,
/// with u_0 and u_1 at the start and at the end of the step, a = h k_0 - (u_1 - u_0) and b = u_1 - u_0 - h
/// k_end - a, as in cubic Hermite interpolation. k_i are the rates at all stages, at the end of the step and
/// at the additional stages, in this order. k_end are the rates at the end of the step. d_j k = sum_i d_ji
/// k_i.
struct ContinuousExtension {
  int stages;       ///< number of additional stages, which follow the rates at the end of the step
  const double* a;  ///< row by row, one row for each additional stage: weights of all k_i before it
  const double* c;  ///< one node for each additional stage
  int terms;        ///< number of the terms d_0, d_1, ...
  const double* d;  ///< row by row, one row for each term: weights of all k_i
};

struct ButcherTableau {
  const char* name;
  int order, stages;
  /// a: row by row the entries below the diagonal, from the second row on; b: weights; c: nodes.
  const double *a, *b, *c;
  /// error: h sum error_i k_i is the difference from a method of lower order. second_error: the difference
  /// from a method of still lower order. Each is nullptr if there is no such method. Otherwise each has one
  /// entry for each stage, and one more for the end of the step if rates_at_end is true.
  const double *error, *second_error;
  int error_order;    ///< the estimate is O(h^(error_order + 1))
  bool rates_at_end;  ///< whether the estimate uses the rates at the end of the step
  const ContinuousExtension* extension = nullptr;  ///< dense output; nullptr: cubic Hermite interpolation
};

}  // namespace pliant
