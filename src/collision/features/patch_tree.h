// Patches of the surface of a part, and a tree over them. The bound of a patch is a ball that contains its
// points and a cone that contains their outward normals. Two parts can have a common normal n at two patches
// on two conditions. n is in the cone of one patch and -n in the cone of the other. n has the direction of a
// line between their balls.
#pragma once

#include <utility>
#include <vector>

#include "part_features.h"

namespace pliant {

/// Returns the angle between two unit vectors, rad.
double angle_between(const Vec3<double>& a, const Vec3<double>& b);

/// A ball and a cone of directions.
struct PatchBound {
  Vec3<double> centre = Vec3<double>::Zero();  ///< m
  double radius = 0;                           ///< m
  Vec3<double> axis = Vec3<double>::Zero();    ///< axis of the cone, unit vector
  double angle = 0;                            ///< half opening angle of the cone, at most pi, rad
  double cosine = 1, sine = 0;                 ///< of `angle`
  void set_angle(double half_angle);
};

/// A patch of a feature. The derivatives are those at its middle.
struct Patch {
  FeaturePoint middle;
  FeatureJet jet;
  PatchBound bound;
};

/// The pose of a part in the frame of another part.
struct RelativePose {
  Mat3<double> R = Mat3<double>::Identity();
  Vec3<double> d = Vec3<double>::Zero();  ///< origin, m
  Vec3<double> operator()(const Vec3<double>& p) const { return d + R * p; }
};

/// Two patches, by number.
struct PatchPair {
  int a, b;
};

/// Limits of the gap g of two points x and y with x - y = g n, -max_depth <= g <= max_gap (m). The parts may
/// also move relative to each other: points of a by `margin` (m) and normals of a by an angle whose sine is
/// `turn`.
struct PairReach {
  double max_gap, max_depth, margin, turn;
};

/// Whether all derivatives of a patch are finite, its tangents are independent, and its bound is finite.
bool is_regular(const Patch& patch);

class PatchTree {
 public:
  explicit PatchTree(std::vector<Patch> patches);
  const std::vector<Patch>& patches() const { return patches_; }
  /// The radius of a ball about the origin of the body frame that contains all patches, m.
  double radius() const { return nodes_.front().bound.centre.norm() + nodes_.front().bound.radius; }
  /// Finds the pairs of patches that can contain two points x of a and y of b with x - y = g n. Here n is the
  /// outward normal at y and the inward normal at x. pose: pose of a in the frame of b. `pairs` is
  /// overwritten. The order of the pairs does not depend on the pose.
  static void find_pairs(const PatchTree& a, const PatchTree& b, const RelativePose& pose,
                         const PairReach& reach, std::vector<PatchPair>& pairs);
  /// Whether a pair of patches can contain two points as in find_pairs().
  static bool can_touch(const PatchTree& a, const PatchTree& b, const RelativePose& pose,
                        const PairReach& reach, const PatchPair& pair);

 private:
  struct Node {
    PatchBound bound;
    int left = -1, right = -1;  // children; for a leaf left is -1 and right is the number of the patch
  };
  int build(std::vector<int>& order, std::size_t first, std::size_t last);

  std::vector<Patch> patches_;
  std::vector<Node> nodes_;
};

/// Returns the patches of a part. features: the features of the part at these values.
std::vector<Patch> make_patches(const Part& part, const ParameterValues<double>& values,
                                const PartFeatures& features);

}  // namespace pliant
