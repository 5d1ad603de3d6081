// The choice of the points that define a material frame.
#pragma once

#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <pliant/body/material_frame.h>
#include <pliant/math/header_only.h>

namespace pliant {

namespace detail {

/// Returns material points around m, the nearest ones first. For a shell, all points are on its surface.
inline std::vector<Material<double>> points_around(const Material<double>& m, const Part& part) {
  constexpr double step = 0.3;
  const bool ring = part.shape().mesh() == MeshPattern::torus;
  MaterialAngles at = angles(m);
  std::vector<Material<double>> all;
  if (part.shell()) at.w = 1;
  for (const double sign : {-1.0, 1.0}) {
    all.push_back(material_at(at.u + sign * step, at.v, at.w));
    all.push_back(material_at(at.u, at.v + sign * step, at.w));
    if (!part.shell() && at.w + sign * step >= 0 && at.w + sign * step <= 1)
      all.push_back(material_at(at.u, at.v, at.w + sign * step));
  }
  // More points are needed where a change of an angle does not move the point: v at a pole, both angles at
  // the centre, and u on the core of a ring.
  if (ring && at.w + step <= 1)
    for (const double turn : {kPi / 2, kPi}) all.push_back(material_at(at.u + turn, at.v, at.w + step));
  if (!ring)
    for (int k = 0; k < 3; ++k)
      for (const double sign : {-1.0, 1.0})
        all.push_back(material_towards(sign * Vec3<double>::Unit(k), at.w < 0.5 ? step : at.w));
  return all;
}

}  // namespace detail

PLIANT_INLINE FramedPoint framed(const Point& at, const Mat3<double>& axes) {
  if (at.part == nullptr)
    return {std::vector<Point>(MaterialFrame::points, at), {Mat3<double>::Zero(), axes}};
  const Part& part = *at.part;
  std::vector<Material<double>> around = detail::points_around(at.material, part);
  around.push_back(at.material);
  const Eigen::Matrix3Xd x = part.s(around, part.parameters().rest());
  // Choose the three points whose unit directions from x_0 span the largest volume. A later choice replaces
  // an earlier choice only if its volume is more than 5 % larger.
  const int n = static_cast<int>(x.cols()) - 1;
  auto difference = [&](int i) -> Vec3<double> { return x.col(i) - x.col(n); };
  double best = 1e-3;
  std::array<int, 3> chosen{-1, -1, -1};
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j)
      for (int k = j + 1; k < n; ++k) {
        Mat3<double> D;
        D << difference(i).stableNormalized(), difference(j).stableNormalized(),
            difference(k).stableNormalized();
        const double volume = std::abs(D.determinant());
        if (!(volume > best * 1.05)) continue;
        best = volume;
        chosen = {i, j, k};
      }
  if (chosen[0] < 0)
    throw std::invalid_argument(
        "part '" + part.name() +
        "': the material points around the point of a joint are almost in one plane, so they define no axes; "
        "expected another point");
  FramedPoint framed{{at}, {}};
  Mat3<double> D;
  for (int k = 0; k < 3; ++k) {
    const int i = chosen[static_cast<std::size_t>(k)];
    framed.points.push_back(point(part, around[static_cast<std::size_t>(i)], at.patch));
    D.col(k) = difference(i);
  }
  framed.frame.K = D.inverse() * axes;
  return framed;
}

PLIANT_INLINE Mat3<double> axes_along(const Vec3<double>& direction) {
  Mat3<double> axes;
  axes.col(0) = direction.stableNormalized();
  axes.col(1) = axes.col(0).unitOrthogonal();
  axes.col(2) = axes.col(0).cross(axes.col(1));
  return axes;
}

}  // namespace pliant
