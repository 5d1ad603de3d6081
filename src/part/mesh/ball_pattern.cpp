// The mesh pattern of balls.
#include <pliant/part/mesh/ball_pattern.h>

#include <cmath>

#include <pliant/shape/material.h>

namespace pliant {

namespace {

/// Returns the azimuth (rad) of lattice point (i, j) on the square ring of half side `ring`. Neighbouring
/// points of the ring differ by equal steps of azimuth.
double azimuth(int i, int j, int ring) {
  if (ring == 0) return 0;
  if (i == ring && std::abs(j) < ring) return kPi / 4 * j / ring;
  if (j == ring) return kPi / 2 - kPi / 4 * i / ring;
  if (i == -ring) return kPi - kPi / 4 * j / ring;
  if (j == -ring) return -kPi / 2 + kPi / 4 * i / ring;
  return kPi / 4 * j / ring;
}

/// Returns x, or 0 if x differs from 0 by rounding only.
double exact(double x) {
  return std::abs(x) < 1e-15 ? 0.0 : x;
}

}  // namespace

Vec3<double> ball_direction(const LatticePoint& p) {
  const auto [i, j, k] = p;
  const int m = ball_shell(p), ring = std::max(std::abs(i), std::abs(j));
  // The elevation u is from 45 to 90 degrees on the upper face, from -90 to -45 on the lower face, and from
  // -45 to 45 on the sides.
  const double u = std::abs(k) == m ? (k > 0 ? 1 : -1) * (kPi / 2 - kPi / 4 * ring / m) : kPi / 4 * k / m;
  const double v = azimuth(i, j, ring);
  double c = exact(std::cos(u)), s = exact(std::sin(u));
  if (std::abs(k) == m && ring == m) {  // on the rim, u is exactly 45 or -45 degrees
    c = std::sqrt(0.5);
    s = k > 0 ? c : -c;
  }
  double cv = exact(std::cos(v)), sv = exact(std::sin(v));
  if (std::abs(i) == std::abs(j) && ring > 0) {  // exact diagonals
    cv = std::copysign(std::sqrt(0.5), i);
    sv = std::copysign(std::sqrt(0.5), j);
  }
  return {c * cv, c * sv, s};
}

BallSurface::BallSurface(int m, const std::array<int, 3>& spacing) {
  auto vertex = [&](const LatticePoint& p) {
    const auto [at, is_new] = index.try_emplace(p, static_cast<int>(points.size()));
    if (is_new) points.push_back(p);
    return at->second;
  };
  for (int face = 0; face < 6; ++face) {
    // A face of the cube: its outward axis, and two axes that are counter-clockwise seen from outside.
    const int axis = face / 2, sign = face % 2 == 0 ? 1 : -1;
    const int right = (axis + 1) % 3, up = (axis + 2) % 3;
    auto at = [&](int a, int b) {
      LatticePoint p{};
      p[static_cast<std::size_t>(axis)] = sign * m;
      p[static_cast<std::size_t>(right)] = sign * a;
      p[static_cast<std::size_t>(up)] = b;
      return vertex(p);
    };
    auto quad = [&](int a, int b, int c, int d) {
      triangles.push_back({a, b, c});
      triangles.push_back({a, c, d});
    };
    const int width = spacing[static_cast<std::size_t>(right)],
              height = spacing[static_cast<std::size_t>(up)];
    for (int a = -m; a < m; a += width)
      for (int b = -m; b < m; b += height) {
        const int low = at(a, b), right_of = at(a + width, b), high = at(a + width, b + height),
                  above = at(a, b + height);
        if ((a >= 0) == (b >= 0))
          quad(low, right_of, high, above);
        else
          quad(right_of, high, above, low);
      }
  }
}

}  // namespace pliant
