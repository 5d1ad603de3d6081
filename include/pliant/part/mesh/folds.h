// Folds: a deformation that is too strong for the body turns a piece of the body inside out. In this piece
// the determinant of the gradient of the chain is negative. Only the surface is sampled, because there each
// deformation has its extreme determinants.
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// Returns the smallest determinant of the gradient of the chain over a sample of the surface; 1 for an empty
/// chain. The determinant is 1 where the chain keeps volume, 0 at the tip of a full taper, and negative where
/// the chain folds the body over.
double min_volume_ratio(const Part& part, const ParameterValues<double>& values);

/// Returns whether a piece of the surface is turned inside out: min_volume_ratio() is below -1e-12 or NaN.
bool folds(const Part& part, const ParameterValues<double>& values);

/// Throws std::invalid_argument if folds() is true at these values. which: "rest" or "initial", for the
/// message.
void throw_if_folded(const Part& part, const ParameterValues<double>& values, const char* which);
/// Throws the error of throw_if_folded().
[[noreturn]] void throw_folded(const Part& part, const char* which);

}  // namespace pliant
