// Contacts of two parts that need not be convex: all points at which the distance of their surfaces is least
// among the points near them.
#pragma once

#include <vector>

#include "common_normal.h"

namespace pliant {

/// The features of a part, divided into patches.
struct PartPatches {
  PartPatches(const Part& part, const ParameterValues<double>& values)
      : features(part, values), tree(make_patches(part, values, features)) {}
  PartFeatures features;
  PatchTree tree;
};

/// Which contacts of a pair are found.
struct FeatureLimits {
  double max_gap, max_depth;  ///< m
  double one_point;           ///< of points nearer to each other than this (m) one is kept
  double size;                ///< of the smaller part, m
};

/// Pairs of patches of two parts that can touch near a relative pose. They are kept from search to search
/// until the parts have moved too far. The contacts do not depend on them.
struct PatchPairs {
  std::vector<PatchPair> pairs;
  RelativePose pose;                ///< of a in the frame of b
  std::vector<CommonNormal> known;  ///< scratch storage of a search
  double max_gap = -1;              ///< m; negative: not computed yet

  /// Computes the pairs if they are not valid at a pose.
  void update(const PartPatches& a, const PartPatches& b, const RelativePose& now,
              const FeatureLimits& limits);
};

/// Finds the contacts of parts a and b. pose: that of a in the frame of b, which is that of `found`, too.
/// candidates: those of this pair of parts. `found` is overwritten. Returns false if a search has failed;
/// then `found` may not be complete.
bool touch_features(const PartPatches& a, const PartPatches& b, const RelativePose& pose,
                    const FeatureLimits& limits, PatchPairs& candidates, std::vector<CommonNormal>& found);

}  // namespace pliant
