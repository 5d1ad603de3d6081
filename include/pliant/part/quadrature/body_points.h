// Points inside a part with their masses, for integrals of any function over its mass: forces per mass, and
// the check of mass distributions. The points of mass_points.h are exact for M and g_q only.
#pragma once

#include <vector>

#include <pliant/part/part.h>

namespace pliant {

struct BodyPoints {
  std::vector<Material<double>> at;
  VecX<double> mass;  ///< kg
};

/// Returns whether the positions of the masses of a prepared part are known. They are unknown if the user
/// gave the inertia.
inline bool has_known_masses(const Part& part) {
  return part.mass_points().n_points > 0;
}

/// Returns the points of Gauss rules with n nodes in each panel (shape/panel.h) along u, v and w, twice as
/// many in a periodic panel. The masses contain Part::density() and Part::mass_distribution(), but not
/// Part::mass(). For smooth functions the error of integrals falls exponentially with n. Throws
/// std::invalid_argument if the rest shape folds over or more than two million points are needed.
BodyPoints place_body_points(const Part& part, int n);

/// Returns place_body_points() with masses that have the mass, the centre and the second moments of the part,
/// so that integrals of affine fields times affine displacements are exact. part: prepared;
/// has_known_masses() must hold. Also throws std::invalid_argument if n is too small for these moments.
BodyPoints place_matched_body_points(const Part& part, int n);

}  // namespace pliant
