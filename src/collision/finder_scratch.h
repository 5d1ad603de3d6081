// What a ContactFinder works with from call to call.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include <pliant/collision/box_contacts.h>
#include <pliant/collision/box_tree.h>
#include <pliant/collision/find_contacts.h>
#include <pliant/collision/mesh/find_on_mesh.h>

namespace pliant {

/// How far the surface may be outside the box of its points, in sizes of the part.
inline constexpr double kBulge = 0.05;

/// A part where it is.
struct ContactFinder::Placed {
  Vec3<double> c;
  Mat3<double> R;
  Vec3<double> c_dot = Vec3<double>::Zero(), omega = Vec3<double>::Zero();  ///< of a prescribed motion, world
  double reach;                      ///< radius of a ball about c that it is in, m
  std::optional<Vec3<double>> axes;  ///< of an ellipsoid
  std::optional<Vec3<double>> half;  ///< sizes of a box
  bool has_points = false;           ///< whether those of Scratch are of its parameters now

  Vec3<double> carries(const Vec3<double>& point) const { return c_dot + omega.cross(point - c); }
};

struct ContactFinder::Scratch {
  std::vector<ParameterValues<double>> values;  ///< of each part
  std::vector<Placed> parts;
  std::vector<Eigen::Matrix3Xd> points;  ///< of parts that change, body frame
  struct PlaneNow {
    bool acts;
    Vec3<double> point, carried;
  };
  std::vector<PlaneNow> planes;
  MeshSearch mesh_search;
  struct Ball {
    Vec3<double> c, c_dot;
    Vec3<double> c_dot_gained;  ///< in the mean of a step, m/s
    double speed, gained;       ///< of any point against the frame's origin, m/s
    double reach;               ///< the ball and the way, m

    /// Of any point, m/s.
    double fastest() const { return c_dot.norm() + c_dot_gained.norm() + speed + gained; }
  };
  std::vector<Ball> balls;
  std::vector<Eigen::AlignedBox3d> boxes;
  BoxTree tree;
  std::vector<std::pair<int, int>> pairs;
  std::vector<Eigen::AlignedBox3d> wide;  ///< of the smooth parts, in which their boxes may move
  std::vector<std::pair<int, int>> wide_pairs;
  double wide_reach = 0, wide_margin = 0;  ///< what they were made wider by: to find so far, and at least
  std::vector<Contact> ours, theirs;
  std::vector<BoxTouch> of_boxes;
  std::vector<Material<double>> material{1};
  std::vector<PointJet<double>> jets;
  std::vector<int> nodes;
  Eigen::Matrix3Xd x_dot;
};

}  // namespace pliant
