// Folds: a deformation that is too strong for the body turns some of it inside out, where the determinant of
// the chain's gradient is negative. The determinants of the deformations are extreme on the surface, where
// they are sampled.
#pragma once

#include <pliant/part/part.h>

namespace pliant {

/// The least determinant of the chain's gradient over a sample of the surface: 1 where the chain keeps
/// volume, 0 at the tip of a full taper, negative where it folds.
double least_volume_ratio(const Part& part, const ParameterValues<double>& values);

/// Whether some of the surface is turned inside out.
bool folds(const Part& part, const ParameterValues<double>& values);

/// Throws std::invalid_argument if the part folds over at these values. which: "rest" or "initial", for the
/// message.
void refuse_folds(const Part& part, const ParameterValues<double>& values, const char* which);
/// What it throws.
[[noreturn]] void throw_folded(const Part& part, const char* which);

}  // namespace pliant
