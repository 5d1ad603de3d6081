// Scratch storage of a ContactFinder. It is kept from call to call.
#pragma once

#include <map>
#include <optional>
#include <utility>
#include <vector>

#include <pliant/collision/box_contacts.h>
#include <pliant/collision/box_tree.h>
#include <pliant/collision/find_contacts.h>

#include "collision/features/feature_pair.h"
#include "collision/hull/hull_pair.h"
#include "collision/hull/touch_plane.h"
#include "collision/mesh/find_on_mesh.h"

namespace pliant {

/// Largest distance by which the surface of a part is outside the box of its sample points, in sizes of the
/// part (Part::size(), its largest half extent).
inline constexpr double kBulge = 0.05;

/// A part and its pose.
struct ContactFinder::Placed {
  Vec3<double> c;  ///< origin of the body frame, m, world
  Mat3<double> R;  ///< body frame to world
  Vec3<double> c_dot = Vec3<double>::Zero(),
               omega = Vec3<double>::Zero();  ///< velocities of the prescribed motion, m/s and rad/s, world
  double reach;                               ///< radius of a ball about c that contains the part, m
  std::optional<Vec3<double>> axes;           ///< semi-axes of an ellipsoid, m
  std::optional<Vec3<double>> half;           ///< half sizes of a box, m
  bool shape_known = false;                   ///< whether reach, axes and half have been computed
  bool points_current = false;                ///< whether Scratch::points belongs to the present parameters
  std::optional<bool> hull, convex;           ///< uses_hull() and is_convex() at the present parameters

  /// Velocity of a point (world) by the prescribed motion, m/s, world.
  Vec3<double> frame_velocity(const Vec3<double>& point) const { return c_dot + omega.cross(point - c); }
};

struct ContactFinder::Scratch {
  std::vector<ParameterValues<double>> values;  ///< parameters of each part
  std::vector<Placed> parts;
  std::vector<Eigen::Matrix3Xd> points;  ///< sample points of parts with dynamic parameters, body frame
  struct PlaneNow {
    bool acts;
    Vec3<double> point, prescribed_velocity;
  };
  std::vector<PlaneNow> planes;  ///< planes at the time of the search: a point (m) and the velocity (m/s)
  MeshSearch mesh_search;
  /// A ball that contains a part during a step.
  struct Ball {
    Vec3<double> c, c_dot;       ///< origin of the frame, m, and its velocity at the start of the step, m/s
    Vec3<double> c_dot_change;   ///< mean of c_dot over the step less c_dot at its start, m/s
    double speed, speed_change;  ///< bounds of the speed of a point relative to c, and of its increase, m/s
    double reach;                ///< radius including the motion in the step, m

    /// Bound of the speed of any point in the step, m/s.
    double fastest() const { return c_dot.norm() + c_dot_change.norm() + speed + speed_change; }
  };
  std::vector<Ball> balls;
  std::vector<Eigen::AlignedBox3d> boxes;  ///< of the smooth parts (those without local deformation), world
  BoxTree tree;
  std::vector<std::pair<int, int>> pairs;  ///< pairs of parts whose boxes are near each other
  /// Enlarged boxes of the smooth parts, and the pairs of enlarged boxes that meet. The pairs are valid while
  /// each part stays inside its enlarged box. The boxes are enlarged by wide_reach (half the largest gap of
  /// the search, m) plus a margin of at least wide_margin (m).
  std::vector<Eigen::AlignedBox3d> wide;
  std::vector<std::pair<int, int>> wide_pairs;
  double wide_reach = 0, wide_margin = 0;
  std::size_t last_count = 0;  ///< number of contacts of the last search of all parts
  std::vector<Contact> ours, theirs;
  std::vector<BoxTouch> of_boxes;
  std::vector<PairTouch> of_hulls;
  std::map<std::pair<int, int>, PatchPairs> patch_pairs;  ///< by numbers of the parts
  std::vector<CommonNormal> of_features;
  std::vector<Vec3<double>> hull_points;
  std::vector<PlaneTouch> of_plane;
  std::vector<Material<double>> material{1};
  std::vector<PointJet<double>> jets;
  std::vector<int> nodes;
  Eigen::Matrix3Xd x_dot;
};

}  // namespace pliant
