// Common normals of two features (faces, edges and vertices: part_features.h) of parts a and b. A point x of
// a and a point y of b with x - y = g n, where n is normal to both features, are stationary points of
//   L(s_a, s_b, n) = n . (x(s_a) - y(s_b)),  |n| = 1,
// where s_a and s_b are the coordinates of the features. Newton's method finds these points. The Hessian of L
// is
//   ( n.x''    0       x'^T P )
//   (   0    -n.y''   -y'^T P )
//   ( P^T x' -P^T y'   -g     )
// with a basis P of the plane normal to n. The distance of x and y is least if the block of s_a and s_b is
// positive definite for all changes with x' ds_a = y' ds_b. For a vertex and a face the condition is
// 1 + g kappa > 0 instead, for both principal curvatures kappa of the face.
#pragma once

#include <algorithm>
#include <cmath>

#include "patch_tree.h"

namespace pliant {

/// Two points with a common normal. Vectors are in the frame of b.
struct CommonNormal {
  FeaturePoint a, b;
  Vec3<double> x, y;    ///< points of a and of b, m
  Vec3<double> normal;  ///< n, unit vector from b to a
  double gap;           ///< g, m
};

/// A step of Newton's method.
struct NormalStep {
  Eigen::Vector2d a, b;       ///< changes of s_a and s_b
  Vec3<double> turn;          ///< change of n, normal to n
  Vec3<double> normal;        ///< n + turn, unit vector
  double gap;                 ///< value of L to which the step leads, to second order, m
  Vec3<double> x, y;          ///< points to which the step leads, to first order, m
  double length_a, length_b;  ///< lengths of the changes of x and y, m

  /// Returns the largest of the turn (rad) and both lengths, in units of `size` (m).
  double length(double size) const { return std::max({turn.norm(), length_a / size, length_b / size}); }
  bool is_finite() const { return turn.allFinite() && a.allFinite() && b.allFinite() && std::isfinite(gap); }
};

class NormalSearch {
 public:
  /// a, b: the features of two parts. pose: pose of a in the frame of b. These three must outlive this
  /// object. size: size of the smaller part, m.
  NormalSearch(const PartFeatures& a, const PartFeatures& b, const RelativePose& pose, double size)
      : a_(a), b_(b), pose_(pose), size_(size) {}

  /// Returns a normal from which the search can start at the middles of two patches.
  Vec3<double> start(const Patch& a, const Patch& b) const;
  /// Returns the step from the middles of two patches with the normal n.
  NormalStep step(const Patch& a, const Patch& b, const Vec3<double>& n) const;
  /// How a search ends. found: the search has found a common normal at which the distance is least. none: the
  /// distance is not least at the common normal, a point is too far from the middle of its patch, or no
  /// common normal is near. failed: the search does not converge; result.gap is then the last gap, NaN if
  /// there is none.
  enum class End { found, none, failed };
  /// Starts a search at the middles of two patches with the normal result.normal. Sets the result if the
  /// search converges.
  End search(const Patch& a, const Patch& b, CommonNormal& result) const;

 private:
  /// A place of the search: two points with their derivatives in the frame of b, and a normal.
  struct Place {
    FeaturePoint a, b;
    FeatureJet of_a, of_b;
    Vec3<double> normal;
  };
  /// The system of equations for a step from a place. The unknowns are the moves of both points along
  /// their unit tangents, divided by size_, and the turn of the normal along two vectors, rad.
  struct System {
    Eigen::Matrix<double, 6, 6> hessian;
    Vec<double, 6> residual;
    Eigen::Matrix<double, 3, 2> plane;  ///< the two vectors: a basis of the plane perpendicular to the normal
    Eigen::Vector2d of_a, of_b;         ///< lengths of the tangents; 1 for a tangent that does not exist
  };
  FeatureJet turned(FeatureJet jet) const;
  Place middles(const Patch& a, const Patch& b, const Vec3<double>& n) const;
  System system(const Place& at) const;
  NormalStep step(const Place& at, const System& system, const Vec<double, 6>& z) const;
  NormalStep step(const Place& at) const;
  Place moved(const Place& at, const NormalStep& step, double share) const;
  bool is_far(const Place& at, const Patch& a, const Patch& b) const;
  End end_at(const Place& at, CommonNormal& result) const;
  End search_least_residual(const Patch& a, const Patch& b, Place at, CommonNormal& result) const;
  bool is_least(const FeatureJet& a, const FeatureJet& b, const CommonNormal& at) const;

  const PartFeatures &a_, &b_;
  const RelativePose& pose_;
  double size_;
};

}  // namespace pliant
