// Distributed forces f(u, t) of Eq. (11): forces per area on the surface of a part, and forces per mass in
// its body. Their formulas may read the point at which they act.
#pragma once

#include <string>
#include <vector>

#include <pliant/body/actuation/state_function.h>

namespace pliant {

class Part;

/// A force that acts on all points of a part.
struct DistributedForce {
  enum class Domain {
    surface,  ///< per area of the present surface; of a shell, the outer side only
    body,     ///< per mass
  };
  std::string name;
  const Part* part = nullptr;
  Domain domain = Domain::surface;
  StateVector density;     ///< N/m^2 on the surface, N/kg in the body; world
  StateFunction pressure;  ///< N/m^2; its force is along the inward normal. Domain::surface only
  /// On the surface: the resolution of the triangles (part/mesh/surface.h), from 1 to kMaxResolution. In the
  /// body: the number of points in each panel (part/quadrature/body_points.h), from 3 to kMaxResolution. A
  /// part that deforms at nodes or by modes has the triangles and nodes of its mesh. 0: the default.
  int resolution = 0;
  static constexpr int kSurfaceResolution = 6, kBodyResolution = 4, kMaxResolution = 64;  ///< 6, 4: defaults
};

/// Returns the names of the quantities at a point that the formulas of a distributed force may read, in the
/// order of Signal::index: the point x, y, z (m, world), its velocity vx, vy, vz (m/s), its place at rest X,
/// Y, Z (m, body frame) and, on a surface, the unit outward normal nx, ny, nz (world) and the velocity along
/// it, vn (m/s).
const std::vector<std::string>& quantities_at_points(DistributedForce::Domain domain);

}  // namespace pliant
