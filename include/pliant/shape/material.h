// Material points (u, v, w) of a solid primitive, section 2 of the paper: latitude u, longitude v and radial
// coordinate w in [0, 1]. A material point stores the cosines and sines of both angles. These values are
// exact at multiples of 90 degrees, so that the surface has no gap at the poles and at the seam.
#pragma once

#include <pliant/math/scalar/pack.h>
#include <pliant/math/scalar/signed_power.h>
#include <pliant/math/types.h>

namespace pliant {

/// A material point over the scalar U.
template <class U = double>
struct Material {
  Trig<U> cu, su, cv, sv;  ///< cosine and sine of u and of v
  U w{1.0};                ///< radial coordinate; 1 on the surface
};

/// Returns the material point of two angles (rad) and a radial coordinate. Cosines and sines that differ
/// from 0, 1 or -1 by rounding only are set to this number.
Material<double> material_at(double u, double v, double w = 1);

/// Returns the material point with its derivatives by u (rad), v (rad) and w.
Material<Dual<3>> material_with_tangents(double u, double v, double w);

/// Returns the material point with its derivatives along three directions that span the space of (u, v, w).
/// The derivatives are valid even if a cosine or sine underflows and only its logarithm is accurate.
Material<Dual<3>> material_with_tangents(const Material<double>& m);

/// Returns the material point with the given cosines and sines of u and v.
inline Material<double> material_from(double cu, double su, double cv, double sv, double w = 1) {
  return {trig(cu), trig(su), trig(cv), trig(sv), w};
}

/// Returns the material point with radial coordinate w and with (cos u cos v, cos u sin v, sin u) along
/// `direction`, which may have any length. For (0, 0, 0) it returns the pole u = pi/2.
Material<double> material_towards(const Vec3<double>& direction, double w = 1);

/// The coordinates of a material point, for output: u and v in [-pi, pi] (rad), w in [0, 1].
struct MaterialAngles {
  double u, v, w;
};
/// Returns the coordinates of a material point.
MaterialAngles angles(const Material<double>& m);

/// Returns the material points four[0] ... four[3] as Packs, with one point in each lane.
Material<Pack> gather(const Material<double>* four);
/// Returns the material points four[0] ... four[3] as Packs, with one point in each lane. The derivative of
/// the result is derivative number `slot` of the points.
Material<Dual<1, Pack>> gather(const Material<Dual<3>>* four, std::size_t slot);
/// Returns the four points of m with zero derivatives.
Material<Dual<1, Pack>> constant(const Material<Pack>& m);

}  // namespace pliant
