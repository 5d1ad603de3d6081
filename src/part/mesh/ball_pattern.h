// The pattern that covers balls: the lattice of a cube of 2m x 2m x 2m cells, its upper and lower faces bent
// to concentric rings, so that rims, edges and coordinate planes fall on mesh lines. A lattice point (i, j,
// k) of the shell r = max(|i|, |j|, |k|) points where it would in the pattern of r.
#pragma once

#include <algorithm>
#include <array>
#include <cstdlib>
#include <map>
#include <vector>

#include <pliant/math/types.h>

namespace pliant {

using LatticePoint = std::array<int, 3>;

inline int ball_shell(const LatticePoint& p) {
  return std::max({std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
}

/// Direction of a lattice point other than the centre.
Vec3<double> ball_direction(const LatticePoint& p);

/// The shell of m with its triangles, which turn counter-clockwise seen from outside; their diagonals run
/// away from the middles of the faces.
struct BallSurface {
  explicit BallSurface(int m);
  std::vector<LatticePoint> points;
  std::map<LatticePoint, int> index;  ///< of points
  std::vector<std::array<int, 3>> triangles;
};

}  // namespace pliant
