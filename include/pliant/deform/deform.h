// The interface of a global deformation, Eq. (3). A deformation is one struct with a name, parameters b and a
// formula T(p, h; b), which is a template on its scalar. p is the position before the deformation (m, body
// frame), h the half height of the shape (m), and zeta = p_z / h.
//
//   name, formula      texts for scene files, messages and `pliant list`
//   parameters         std::array<ParameterSpec, n>, the n parameters b
//   sections           image of the planes z = const, which decides the quadrature of the mass
//   apply(p, h, b)     T(p, h; b); the identity if all parameters have their defaults
//   inverse(p, h, b)   the position whose image under apply is p
//   prepare(b)         optional: returns terms of T that depend on b alone. A deformation with prepare also
//                      needs apply(p, h, b, terms), which returns T(p, h; b)
//   amplitudes         optional: a number m <= n. If the first m parameters have their defaults, T is the
//                      identity for all values of the other parameters. Default: n
#pragma once

#include <array>
#include <type_traits>
#include <utility>

#include <pliant/math/parameter_spec.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/math/scalar/functions.h>
#include <pliant/math/types.h>

namespace pliant {

/// The image of the planes z = const (the sections of the shape) under a deformation.
enum class Sections {
  stay_affine,  ///< the map is affine in (x, y, z); quadratic functions of the position remain quadratic
  stay_plane,   ///< each plane z = const is mapped affinely into itself
  tilt,         ///< each plane z = const is mapped affinely to a tilted plane; a later link that depends on
                ///< z may curve this tilted plane
};

/// Number of parameters of a deformation.
template <class Deform>
inline constexpr int deform_size = static_cast<int>(Deform::parameters.size());

namespace detail {
template <class Deform, class = void>
inline constexpr int amplitudes_of = deform_size<Deform>;
template <class Deform>
inline constexpr int amplitudes_of<Deform, std::void_t<decltype(Deform::amplitudes)>> = Deform::amplitudes;
/// T(p, h; b) for fixed b. If the deformation has the member prepare, the constructor computes the terms that
/// depend on b alone.
template <class Deform, class T, class = void>
struct Prepared {
  explicit Prepared(const Vec<T, deform_size<Deform>>&) {}
  Vec3<T> apply(const Vec3<T>& p, const T& h, const Vec<T, deform_size<Deform>>& b) const {
    return Deform::template apply<T>(p, h, b);
  }
};
template <class Deform, class T>
struct Prepared<
    Deform, T,
    std::void_t<decltype(Deform::template prepare<T>(std::declval<Vec<T, deform_size<Deform>>>()))>> {
  decltype(Deform::template prepare<T>(std::declval<Vec<T, deform_size<Deform>>>())) terms;
  explicit Prepared(const Vec<T, deform_size<Deform>>& b) : terms(Deform::template prepare<T>(b)) {}
  Vec3<T> apply(const Vec3<T>& p, const T& h, const Vec<T, deform_size<Deform>>& b) const {
    return Deform::template apply<T>(p, h, b, terms);
  }
};
}  // namespace detail

/// The function p -> T(p, h; b) of a deformation for fixed h and b.
template <class Deform, class T>
class DeformBy {
 public:
  DeformBy(const T& h, const Vec<T, deform_size<Deform>>& b) : h_(h), b_(b), prepared_(b) {}
  Vec3<T> operator()(const Vec3<T>& p) const { return prepared_.apply(p, h_, b_); }

 private:
  T h_;
  Vec<T, deform_size<Deform>> b_;
  detail::Prepared<Deform, T> prepared_;
};

/// The member `amplitudes` of a deformation; without this member, the number of parameters.
template <class Deform>
inline constexpr int deform_amplitudes = detail::amplitudes_of<Deform>;

/// Returns whether a deformation is exactly the identity for all p and h: the first `amplitudes` parameters
/// have their defaults. b: array of all parameters. A dual number with a non-zero derivative differs from the
/// default.
template <class Deform, class P>
bool is_identity(const P* b) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(deform_amplitudes<Deform>); ++k)
    if (!is_constant(b[k], Deform::parameters[k].standard)) return false;
  return true;
}

}  // namespace pliant
