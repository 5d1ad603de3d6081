// The constants of a part: the quantities that Part::prepare() computes once from the description and that no
// step changes. Parts with equal descriptions can share them (constants_cache.h).
#pragma once

#include <memory>
#include <optional>

#include <pliant/part/continuum.h>
#include <pliant/part/inertia.h>
#include <pliant/part/linear_inertia.h>
#include <pliant/part/local/local_deformation.h>
#include <pliant/part/quadrature/mass_points.h>

namespace pliant {

struct PartConstants {
  MatX<double> K_s;              ///< stiffness over the dynamic parameters
  double size = 0;               ///< largest |x|, |y| or |z| of the surface at rest, body frame, m
  MassPoints mass_points;        ///< points of the sums of Eq. (11); none if the user gave the inertia
  Inertia<double> rest_inertia;  ///< inertia at rest; for a rigid part the inertia at all times
  std::optional<LinearInertia> linear_inertia;  ///< replaces the sums over mass points if s is linear in q_s
  std::unique_ptr<LocalDeformation> local;      ///< nullptr if the part does not deform locally
  std::unique_ptr<ContinuumEnergy> continuum;   ///< nullptr without elastic material or dynamic parameters
};

}  // namespace pliant
