// Contacts of two parts that need not be convex: all pairs of points at which the distance of both surfaces
// has a local minimum.
#pragma once

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include "common_normal.h"

namespace pliant {

/// The features of a part, divided into patches.
struct PartPatches {
  /// Returns the patches of a part, or nullptr if its features are not known or are degenerate at these
  /// values: a full taper, for example, maps an end face to a line or a point.
  static std::unique_ptr<PartPatches> make(const Part& part, const ParameterValues<double>& values);
  PartFeatures features;
  PatchTree tree;
  Eigen::AlignedBox3d box;  ///< contains all patches, body frame, m
};

/// Limits of the contacts that touch_features() finds.
struct FeatureLimits {
  double max_gap, max_depth;  ///< m
  double one_point;           ///< of points nearer to each other than this (m) one is kept
  double size;                ///< size of the smaller part, m
};

/// Pairs of patches of two parts that can touch near a relative pose. The pairs are kept from search to
/// search until the parts have moved too far. They only save time: the contacts do not depend on them.
struct PatchPairs {
  struct Kept {
    std::vector<PatchPair> pairs;
    RelativePose pose;    ///< of a in the frame of b
    double max_gap = -1;  ///< m; negative: not computed yet
  };
  std::array<Kept, 2> kept;         ///< for two limits of the gap; the entry used last is first
  std::vector<CommonNormal> known;  ///< scratch storage of a search

  /// Returns the pairs at the pose `now` of a in the frame of b. Computes them if no kept pairs are valid.
  const std::vector<PatchPair>& update(const PartPatches& a, const PartPatches& b, const RelativePose& now,
                                       const FeatureLimits& limits);
};

/// Finds the contacts of parts a and b. pose: pose of a in the frame of b. candidates: the kept pairs of
/// patches of these two parts. `found` is overwritten; its vectors are in the frame of b. Returns false if a
/// search has failed, or if the parts overlap by more than limits.max_depth; then `found` may not be
/// complete.
bool touch_features(const PartPatches& a, const PartPatches& b, const RelativePose& pose,
                    const FeatureLimits& limits, PatchPairs& candidates, std::vector<CommonNormal>& found);

}  // namespace pliant
