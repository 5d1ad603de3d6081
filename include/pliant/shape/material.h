// Material points of a solid primitive (design 1.1): u = latitude, v = longitude, w = radius in [0, 1], kept
// as the exact cosines and sines of the two angles, so that poles and seams close without a gap.
#pragma once

#include <pliant/math/scalar/pack.h>
#include <pliant/math/scalar/signed_power.h>
#include <pliant/math/types.h>

namespace pliant {

template <class U = double>
struct Material {
  Trig<U> cu, su, cv, sv;
  U w{1.0};
};

/// From angles (rad). Cosines and sines that are zero but for rounding are taken as zero.
Material<double> material_at(double u, double v, double w = 1);

/// The same with its derivatives along u, v and w.
Material<Dual<3>> material_with_tangents(double u, double v, double w);

/// A material point with its derivatives along three directions that span what u, v and w do; they are of use
/// where cosines or sines are so small that only their logarithms tell.
Material<Dual<3>> material_with_tangents(const Material<double>& m);

/// From exact cosine and sine pairs.
inline Material<double> material_from(double cu, double su, double cv, double sv, double w = 1) {
  return {trig(cu), trig(su), trig(cv), trig(sv), w};
}

/// From a direction of the material sphere, not necessarily of unit length; the pole for (0, 0, 0).
Material<double> material_towards(const Vec3<double>& direction, double w = 1);

/// The angles of a material point, for people: u in [-pi, pi], v in [-pi, pi).
struct MaterialAngles {
  double u, v, w;
};
MaterialAngles angles(const Material<double>& m);

/// Four material points as one.
Material<Pack> gather(const Material<double>* four);
/// The same along direction number `slot` of their derivatives.
Material<Dual<1, Pack>> gather(const Material<Dual<3>>* four, std::size_t slot);
/// Material points that stay.
Material<Dual<1, Pack>> constant(const Material<Pack>& m);

}  // namespace pliant
