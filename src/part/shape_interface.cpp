// Material points and gauge gradients of shapes that have no label function (shape_interface.h).
#include <cmath>
#include <stdexcept>

#include <Eigen/LU>

#include <pliant/part/shape_interface.h>

namespace pliant {

namespace {

/// Returns the derivatives [e_u e_v e_w] at uvw = (u, v, w). e: output, the position there.
Mat3<double> tangents_at(const ShapeInterface& shape, const Vec3<double>& uvw, ShapeParameters a,
                         Vec3<double>& e) {
  const Vec3<Dual<3>> at = shape.tangents(material_with_tangents(uvw[0], uvw[1], uvw[2]), a);
  Mat3<double> E;
  for (int r = 0; r < 3; ++r) {
    e[r] = at[r].v;
    for (int c = 0; c < 3; ++c) E(r, c) = at[r].d[static_cast<std::size_t>(c)];
  }
  return E;
}

/// Angle (rad) from a pole. Nearer to a pole, derivatives are evaluated at this angle from the pole.
constexpr double kOffPole = 1e-7;

}  // namespace

Material<double> generic_label(const ShapeInterface& shape, const Vec3<double>& x, ShapeParameters a) {
  const double size = x.norm();
  if (size == 0) return material_from(0, 1, 1, 0, 0);
  Material<double> guess = material_towards(x);
  const double reach = shape.e(guess, a).norm();
  const MaterialAngles start = angles(guess);
  if (std::hypot(x[0], x[1]) <= kOffPole * size) {  // on the axis the direction gives u and v
    guess.w = size / reach;
    return guess;
  }
  constexpr double kMaxAngleStep = 0.3;  // rad
  Vec3<double> uvw(start.u, start.v, size / reach), e;
  for (int iteration = 0; iteration < 50; ++iteration) {
    const Mat3<double> E = tangents_at(shape, uvw, a, e);
    const Vec3<double> miss = x - e;
    if (miss.norm() <= 1e-14 * size) break;
    Vec3<double> step = E.partialPivLu().solve(miss);
    const double angle = std::max(std::abs(step[0]), std::abs(step[1]));
    if (angle > kMaxAngleStep) step *= kMaxAngleStep / angle;
    uvw += step;
  }
  if (!((x - e).norm() <= 1e-9 * size))
    throw std::runtime_error(
        std::string("shape '") + shape.name() +
        "': Newton's method finds no material point at a position; give the shape a label function");
  return material_at(uvw[0], uvw[1], uvw[2]);
}

Vec3<double> generic_gauge_gradient(const ShapeInterface& shape, const Vec3<double>& x, ShapeParameters a) {
  const MaterialAngles at = angles(generic_label(shape, x, a));
  const double pole = kPi / 2 - kOffPole;
  Vec3<double> e;
  const Mat3<double> E = tangents_at(shape, {std::min(std::max(at.u, -pole), pole), at.v, at.w}, a, e);
  return E.inverse().row(2);
}

}  // namespace pliant
