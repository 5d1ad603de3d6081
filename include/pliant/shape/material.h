// Material points (u, v, w) of a solid primitive, Eq. (1): u = latitude, v = longitude, w = radius in [0, 1].
// They are stored as exact cosines and sines of the two angles, so that poles and seams close without a gap.
#pragma once

#include <pliant/math/scalar/pack.h>
#include <pliant/math/scalar/signed_power.h>
#include <pliant/math/types.h>

namespace pliant {

/// A material point over the scalar U.
template <class U = double>
struct Material {
  Trig<U> cu, su, cv, sv;  ///< cosine and sine of u and of v
  U w{1.0};
};

/// Returns the material point of two angles (rad) and a radius. Cosines and sines within rounding of 0 are
/// set to 0.
Material<double> material_at(double u, double v, double w = 1);

/// Returns the material point with its derivatives along u, v and w.
Material<Dual<3>> material_with_tangents(double u, double v, double w);

/// Returns the material point with its derivatives along three directions that span the space of (u, v, w).
/// They are valid also where a cosine or sine is so small that only its logarithm is accurate.
Material<Dual<3>> material_with_tangents(const Material<double>& m);

/// Returns the material point of exact cosine and sine pairs.
inline Material<double> material_from(double cu, double su, double cv, double sv, double w = 1) {
  return {trig(cu), trig(su), trig(cv), trig(sv), w};
}

/// Returns the material point in a direction of the material sphere, of any length; the pole for (0, 0, 0).
Material<double> material_towards(const Vec3<double>& direction, double w = 1);

/// The coordinates of a material point, for output: u in [-pi, pi] and v in [-pi, pi) (rad), w in [0, 1].
struct MaterialAngles {
  double u, v, w;
};
/// Returns the coordinates of a material point.
MaterialAngles angles(const Material<double>& m);

/// Returns four material points as the lanes of one.
Material<Pack> gather(const Material<double>* four);
/// Returns four material points as the lanes of one, with derivative number `slot` of each.
Material<Dual<1, Pack>> gather(const Material<Dual<3>>* four, std::size_t slot);
/// Returns four material points whose derivatives are zero.
Material<Dual<1, Pack>> constant(const Material<Pack>& m);

}  // namespace pliant
