// What a global deformation is (design 1.1): one struct with its names, its parameters and its formula T(p,
// h; b), Eq. (3), templated on its scalar. p is the incoming point (m), h the half height of the shape, zeta
// = p_z / h.
//
//   name, formula      for people and scene files
//   parameters         std::array<ParameterSpec, n>
//   sections           what becomes of the planes z = const, which decides the quadrature of the mass
//   apply(p, h, b)     T(p, h; b); the identity when all parameters are at their defaults
//   inverse(p, h, b)   the point that apply takes to p
//   prepare(b)         optional: what T takes of the parameters alone; apply(p, h, b, that) is then T as well
//   amplitudes         optional: how many parameters, from the first, make it the identity while at their
//                      defaults, whatever the others are; all of them unless it says
#pragma once

#include <array>
#include <type_traits>
#include <utility>

#include <pliant/math/parameter_spec.h>
#include <pliant/math/scalar/dual.h>
#include <pliant/math/scalar/functions.h>
#include <pliant/math/types.h>

namespace pliant {

enum class Sections {
  stay_affine,  ///< the map is affine in (x, y, z): a quadratic in the rest position stays one
  stay_plane,   ///< planes z = const stay where they are and move affinely within themselves
  tilt,         ///< planes z = const move affinely, out of their plane: nothing after it may read z
};

template <class Deform>
inline constexpr int deform_size = static_cast<int>(Deform::parameters.size());

namespace detail {
template <class Deform, class = void>
inline constexpr int amplitudes_of = deform_size<Deform>;
template <class Deform>
inline constexpr int amplitudes_of<Deform, std::void_t<decltype(Deform::amplitudes)>> = Deform::amplitudes;
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
  decltype(Deform::template prepare<T>(std::declval<Vec<T, deform_size<Deform>>>())) of_b;
  explicit Prepared(const Vec<T, deform_size<Deform>>& b) : of_b(Deform::template prepare<T>(b)) {}
  Vec3<T> apply(const Vec3<T>& p, const T& h, const Vec<T, deform_size<Deform>>& b) const {
    return Deform::template apply<T>(p, h, b, of_b);
  }
};
}  // namespace detail

/// T(.; b) of a deformation at given h and b, for many points.
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

/// How many parameters of a deformation, from the first, make it the identity while at their defaults.
template <class Deform>
inline constexpr int deform_amplitudes = detail::amplitudes_of<Deform>;

/// Whether a deformation with parameters b is the identity, to the last bit.
template <class Deform, class P>
bool is_identity(const P* b) {
  for (std::size_t k = 0; k < static_cast<std::size_t>(deform_amplitudes<Deform>); ++k)
    if (!is_constant(b[k], Deform::parameters[k].standard)) return false;
  return true;
}

}  // namespace pliant
