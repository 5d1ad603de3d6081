// The method of integration for a model and a tolerance, found by trial: each that may be the best goes on
// from the start for a few steps, and the one that comes farthest at the same cost is taken. The cost is
// counted in evaluations of the accelerations, by a fixed model, never by a clock.
#pragma once

#include <string>

#include <pliant/integrate/integrator.h>

namespace pliant {

/// Stands for the name of a method that is chosen.
inline constexpr const char* kAutomatic = "auto";
/// Tolerance where it is chosen and none is given.
inline constexpr double kStandardTolerance = 1e-6;

struct IntegratorChoice {
  std::string integrator;
  std::string why;  ///< in words
};

/// start: with joints closed that act.
IntegratorChoice choose_integrator(const Dynamics& dynamics, const ErrorScale& scale, const State& start);

}  // namespace pliant
