#include <pliant/shape/material.h>

#include <cmath>

namespace pliant {

namespace {
double snap(double x) {
  return std::abs(x) < 4e-16 ? 0.0 : (std::abs(x) > 1 - 1e-16 ? std::copysign(1.0, x) : x);
}
}  // namespace

Material<double> material_at(double u, double v, double w) {
  return material_from(snap(std::cos(u)), snap(std::sin(u)), snap(std::cos(v)), snap(std::sin(v)), w);
}

Material<Dual<3>> material_with_tangents(double u, double v, double w) {
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

Material<double> material_towards(const Vec3<double>& direction, double w) {
  const double ring = std::hypot(direction[0], direction[1]);
  const double size = std::hypot(ring, direction[2]);
  if (size == 0) return material_from(0, 1, 1, 0, w);
  const double cv = ring > 0 ? direction[0] / ring : 1.0, sv = ring > 0 ? direction[1] / ring : 0.0;
  return material_from(ring / size, direction[2] / size, cv, sv, w);
}

MaterialAngles angles(const Material<double>& m) {
  return {std::atan2(m.su.x, m.cu.x), std::atan2(m.sv.x, m.cv.x), m.w};
}

Material<Pack> gather(const Material<double>* four) {
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

}  // namespace pliant
