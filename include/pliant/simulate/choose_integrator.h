// The method of integration for a model and a tolerance. Where nothing is elastic or damped it is an explicit
// one of high order; else it is found by trial: each that may be the best goes on from the start for some
// steps, and the one is taken that comes farthest at the same cost, once its steps have grown. The cost is
// counted in evaluations of the accelerations, by a fixed model, never by a clock.
#pragma once

#include <string>

#include <pliant/method/integrator.h>

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
