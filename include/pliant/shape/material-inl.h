// Function bodies of material.h: material points from angles and directions, their derivatives, and Packs.
#pragma once

#include <pliant/shape/material.h>

#include <cmath>

#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

/// Returns x, or 0, 1 or -1 if x differs from this number by rounding only.
inline double snap_to_axis(double x) {
  return std::abs(x) < 4e-16 ? 0.0 : (std::abs(x) > 1 - 1e-16 ? std::copysign(1.0, x) : x);
}

/// Returns sqrt(x^2 + y^2). Calls std::hypot, which is several times slower, only if the squares could
/// overflow or underflow.
inline double planar_length(double x, double y) {
  const double square = x * x + y * y;
  return square > 1e-280 && square < 1e280 ? std::sqrt(square) : std::hypot(x, y);
}

}  // namespace detail

PLIANT_INLINE Material<double> material_at(double u, double v, double w) {
  return material_from(detail::snap_to_axis(std::cos(u)), detail::snap_to_axis(std::sin(u)),
                       detail::snap_to_axis(std::cos(v)), detail::snap_to_axis(std::sin(v)), w);
}

PLIANT_INLINE Material<Dual<3>> material_with_tangents(double u, double v, double w) {
  const Material<double> m = material_at(u, v, w);
  auto along = [](const Trig<double>& t, double slope, std::size_t slot) {
    Trig<Dual<3>> r{Dual<3>(t.x), Dual<3>(t.sign), Dual<3>(t.log_abs)};
    r.x.d[slot] = slope;
    r.log_abs.d[slot] = t.x != 0 ? slope / t.x : 0;
    return r;
  };
  return {along(m.cu, -m.su.x, 0), along(m.su, m.cu.x, 0), along(m.cv, -m.sv.x, 1), along(m.sv, m.cv.x, 1),
          Dual<3>::variable(w, 2)};
}

PLIANT_INLINE Material<Dual<3>> material_with_tangents(const Material<double>& m) {
  Material<Dual<3>> r;
  // The derivatives are by u and by v. If |cos u| or |sin u| is below 1e-30 but not 0, the derivative of the
  // logarithm could overflow; d/du is then multiplied by cos u sin u. The rule for d/dv is analogous, with v
  // in place of u.
  auto turn = [](const Trig<double>& c, const Trig<double>& s, std::size_t slot, Trig<Dual<3>>& rc,
                 Trig<Dual<3>>& rs) {
    constexpr double small = 1e-30;
    const bool corner =
        (std::abs(c.x) < small && c.log_abs > kLogZero) || (std::abs(s.x) < small && s.log_abs > kLogZero);
    auto put = [slot](Trig<Dual<3>>& to, const Trig<double>& from, double slope, double log_slope) {
      to = {Dual<3>(from.x), Dual<3>(from.sign), Dual<3>(from.log_abs)};
      to.x.d[slot] = slope;
      to.log_abs.d[slot] = log_slope;
    };
    auto over = [](double a, double b) { return b != 0 ? a / b : 0; };
    if (corner) {
      put(rc, c, -c.x * s.x * s.x, -s.x * s.x);
      put(rs, s, c.x * c.x * s.x, c.x * c.x);
    } else {
      put(rc, c, -s.x, over(-s.x, c.x));
      put(rs, s, c.x, over(c.x, s.x));
    }
  };
  turn(m.cu, m.su, 0, r.cu, r.su);
  turn(m.cv, m.sv, 1, r.cv, r.sv);
  r.w = Dual<3>::variable(m.w, 2);
  return r;
}

PLIANT_INLINE Material<double> material_towards(const Vec3<double>& direction, double w) {
  const double ring = detail::planar_length(direction[0], direction[1]);
  const double size = detail::planar_length(ring, direction[2]);
  if (size == 0) return material_from(0, 1, 1, 0, w);
  const double cv = ring > 0 ? direction[0] / ring : 1.0, sv = ring > 0 ? direction[1] / ring : 0.0;
  return material_from(ring / size, direction[2] / size, cv, sv, w);
}

PLIANT_INLINE MaterialAngles angles(const Material<double>& m) {
  return {std::atan2(m.su.x, m.cu.x), std::atan2(m.sv.x, m.cv.x), m.w};
}

PLIANT_INLINE Material<Pack> gather(const Material<double>* four) {
  Material<Pack> m;
  for (int i = 0; i < Pack::kLanes; ++i) {
    const Material<double>& one = four[i];
    auto put = [i](Trig<Pack>& to, const Trig<double>& from) {
      to.x.set(i, from.x);
      to.sign.set(i, from.sign);
      to.log_abs.set(i, from.log_abs);
    };
    put(m.cu, one.cu);
    put(m.su, one.su);
    put(m.cv, one.cv);
    put(m.sv, one.sv);
    m.w.set(i, one.w);
  }
  return m;
}

PLIANT_INLINE Material<Dual<1, Pack>> gather(const Material<Dual<3>>* four, std::size_t slot) {
  Material<Dual<1, Pack>> m;
  for (int i = 0; i < Pack::kLanes; ++i) {
    const Material<Dual<3>>& one = four[i];
    auto put = [i, slot](Dual<1, Pack>& to, const Dual<3>& from) {
      to.v.set(i, from.v);
      to.d[0].set(i, from.d[slot]);
    };
    auto put_trig = [&put](Trig<Dual<1, Pack>>& to, const Trig<Dual<3>>& from) {
      put(to.x, from.x);
      put(to.sign, from.sign);
      put(to.log_abs, from.log_abs);
    };
    put_trig(m.cu, one.cu);
    put_trig(m.su, one.su);
    put_trig(m.cv, one.cv);
    put_trig(m.sv, one.sv);
    put(m.w, one.w);
  }
  return m;
}

PLIANT_INLINE Material<Dual<1, Pack>> constant(const Material<Pack>& m) {
  using D = Dual<1, Pack>;
  auto trig = [](const Trig<Pack>& t) { return Trig<D>{D(t.x), D(t.sign), D(t.log_abs)}; };
  return {trig(m.cu), trig(m.su), trig(m.cv), trig(m.sv), D(m.w)};
}

}  // namespace pliant
