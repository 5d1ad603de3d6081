#include "feature_pair.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace pliant {

namespace {

/// The first step of Newton's method decides whether two patches are searched. The step may move each point
/// by at most kFirstMove radii of its patch. The normal may differ from the axes of the cones by kFirstTurn
/// times their half angles plus kTurnSlack (rad). The gap may exceed the limits by kGapSlack times the sum of
/// both radii plus kGapRounding sizes of the smaller part.
constexpr double kFirstMove = 1.6, kFirstTurn = 1.2, kTurnSlack = 0.05, kGapSlack = 0.05, kGapRounding = 1e-9;
/// Two patches are not searched if the first step leads to points that are within kLeadsTo radii of their
/// patches from those of a known common normal.
constexpr double kLeadsTo = 0.8;
/// Normals are equal if the cosine of the angle between them exceeds this. Contacts with equal normals are
/// merged if they are nearer to each other than FeatureLimits::one_point.
constexpr double kOneContactCosine = 0.98;
/// Overlaps that are deeper than this, in sizes of the smaller part, are tested by is_overlap().
constexpr double kShallow = 1e-7;
/// is_overlap() tests this many points of an edge on each side of the contact. The distance between two of
/// these points is the depth of the overlap.
constexpr int kEdgeSamples = 3;
/// The kept pairs of patches (PatchPairs) stay valid while the parts move by at most this relative to each
/// other, in sizes of the smaller part.
constexpr double kMargin = 0.1;
/// If a pair of parts has more contacts than this, at most this many contacts with equal gaps along a curve
/// or face are kept.
constexpr std::size_t kMaxOnCurve = 8;

/// Adds a contact. If the contact is merged with a known one, the deeper of the two is kept.
void add_contact(const CommonNormal& at, double one_point, std::vector<CommonNormal>& found) {
  const auto twin = std::find_if(found.begin(), found.end(), [&](const CommonNormal& other) {
    return (at.x - other.x).norm() < one_point && at.normal.dot(other.normal) > kOneContactCosine;
  });
  if (twin == found.end())
    found.push_back(at);
  else if (at.gap < twin->gap)
    *twin = at;
}

/// Moves the contacts to keep to the front of the range [first, last). The first contact is kept. Then the
/// contact that is farthest from all kept contacts is kept; this is repeated until kMaxOnCurve contacts are
/// kept. Returns the end of the kept contacts.
template <class Iterator>
Iterator move_outermost(Iterator first, Iterator last) {
  auto kept = first + 1;
  for (std::size_t n = 1; n < kMaxOnCurve && kept != last; ++n, ++kept) {
    auto distance = [&](const CommonNormal& at) {
      double least = (at.x - first->x).norm();
      for (auto other = first + 1; other < kept; ++other) least = std::min(least, (at.x - other->x).norm());
      return least;
    };
    std::iter_swap(kept, std::max_element(kept, last, [&](const auto& one, const auto& other) {
                     return distance(one) < distance(other);
                   }));
  }
  return kept;
}

/// Of contacts that have equal gaps, and equal features or equal normals, keeps those that are farthest
/// apart. All overlaps deeper than kShallow * size are kept. size: of the smaller part, m.
void keep_outermost(std::vector<CommonNormal>& found, double size) {
  auto first = std::stable_partition(found.begin(), found.end(),
                                     [&](const CommonNormal& at) { return at.gap < -kShallow * size; });
  while (first != found.end()) {
    std::iter_swap(first, std::min_element(first, found.end(), [](const auto& one, const auto& other) {
                     return one.gap < other.gap;
                   }));
    const CommonNormal lowest = *first;
    const auto level_end = std::stable_partition(first, found.end(), [&](const CommonNormal& at) {
      return at.gap - lowest.gap <= kShallow * size &&
             ((at.a.feature == lowest.a.feature && at.b.feature == lowest.b.feature) ||
              at.normal.dot(lowest.normal) > kOneContactCosine);
    });
    first = found.erase(move_outermost(first, level_end), level_end);
  }
}

/// The search for the contacts of one pair of parts.
class PairSearch {
 public:
  PairSearch(const PartPatches& a, const PartPatches& b, const RelativePose& pose,
             const FeatureLimits& limits, std::vector<CommonNormal>& known)
      : a_(a),
        b_(b),
        pose_(pose),
        limits_(limits),
        search_(a.features, b.features, pose, limits.size),
        known_(known) {
    known_.clear();
  }

  /// Searches for a contact of two patches and adds it to `found`. Returns false if the search fails.
  bool add(const Patch& a, const Patch& b, std::vector<CommonNormal>& found) {
    CommonNormal at;
    at.normal = search_.start(a, b);
    const NormalStep first = search_.step(a, b, at.normal);
    if (!first.is_finite()) return false;
    if (!can_lead_to_contact(a, b, first) || is_known(a, b, first)) return true;
    const NormalSearch::End end = search_.search(a, b, at);
    if (end == NormalSearch::End::none) return true;
    if (end == NormalSearch::End::failed) return std::isfinite(at.gap) && !is_within_limits(at.gap);
    known_.push_back(at);
    if (is_within_limits(at.gap) && (at.gap > -kShallow * limits_.size || is_overlap(at)))
      add_contact(at, limits_.one_point, found);
    return true;
  }
  /// Whether the parts overlap by more than the largest depth: a deeper contact is known, or the middle of a
  /// patch of one part is inside the other.
  bool is_deep() const {
    const Mat3<double> R = pose_.R.transpose();
    return std::any_of(
               known_.begin(), known_.end(),
               [&](const CommonNormal& at) { return at.gap < -limits_.max_depth && is_overlap(at); }) ||
           enters(a_, pose_, b_) || enters(b_, {R, -(R * pose_.d)}, a_);
  }

 private:
  /// Whether the middle of a patch of a part is inside the other part. pose: pose of the part in the frame of
  /// the other part.
  static bool enters(const PartPatches& part, const RelativePose& pose, const PartPatches& other) {
    return std::any_of(part.tree.patches().begin(), part.tree.patches().end(), [&](const Patch& patch) {
      const Vec3<double> x = pose(patch.jet.x);
      return other.box.contains(x) && other.features.contains(x, kShallow);
    });
  }
  bool is_within_limits(double gap) const { return gap <= limits_.max_gap && gap >= -limits_.max_depth; }
  /// Whether the first step leads to points near a known contact of the same features.
  bool is_known(const Patch& a, const Patch& b, const NormalStep& first) const {
    return std::any_of(known_.begin(), known_.end(), [&](const CommonNormal& at) {
      return at.a.feature == a.middle.feature && at.b.feature == b.middle.feature &&
             (at.x - first.x).norm() <= kLeadsTo * a.bound.radius &&
             (at.y - first.y).norm() <= kLeadsTo * b.bound.radius;
    });
  }
  /// Whether the first step leads to a possible contact.
  bool can_lead_to_contact(const Patch& a, const Patch& b, const NormalStep& first) const {
    const double slack = kGapSlack * (a.bound.radius + b.bound.radius) + kGapRounding * limits_.size;
    if (!(first.gap <= limits_.max_gap + slack && first.gap >= -limits_.max_depth - slack)) return false;
    // A negative gap of two vertices, or of a vertex and an edge, is no overlap of the parts.
    if (a.jet.dimension + b.jet.dimension < 2 && first.gap < 0) return false;
    auto is_turned = [&](const Vec3<double>& normal, const PatchBound& bound) {
      return angle_between(normal, bound.axis) > kFirstTurn * bound.angle + kTurnSlack;
    };
    if (is_turned(first.normal, b.bound) || is_turned(pose_.R.transpose() * -first.normal, a.bound))
      return false;
    return first.length_a <= kFirstMove * a.bound.radius && first.length_b <= kFirstMove * b.bound.radius;
  }
  /// Whether the parts overlap at a contact with a negative gap. Separate parts can have common normals with
  /// negative gaps, too, because the normals at an acute edge span a wider angle than the solid there.
  bool is_overlap(const CommonNormal& at) const {
    auto in_a = [&](const Vec3<double>& p) {
      return a_.features.contains(pose_.R.transpose() * (p - pose_.d));
    };
    auto in_b = [&](const Vec3<double>& p) { return b_.features.contains(p); };
    const int of_a = a_.features.dimension(at.a.feature), of_b = b_.features.dimension(at.b.feature);
    if (of_a == 2 && of_b == 2) return in_a(at.y) && in_b(at.x);
    if (of_a < of_b) return in_b(at.x);
    if (of_b < of_a) return in_a(at.y);
    // If parts overlap at two edges, one of the edges is inside the other part near the contact.
    auto enters = [&](const PartFeatures& features, const FeaturePoint& point, const auto& in_other) {
      const FeatureJet jet = features.evaluate(point);
      const double step = at.gap / jet.tangents.col(0).norm();
      for (int k = -kEdgeSamples; k <= kEdgeSamples; ++k) {
        const FeaturePoint near = features.moved(point, jet, {k * step, 0});
        if (features.is_inside(near) && in_other(features.evaluate(near).x)) return true;
      }
      return false;
    };
    return enters(a_.features, at.a, [&](const Vec3<double>& p) { return in_b(pose_(p)); }) ||
           enters(b_.features, at.b, in_a);
  }

  const PartPatches &a_, &b_;
  const RelativePose& pose_;
  const FeatureLimits& limits_;
  NormalSearch search_;
  std::vector<CommonNormal>& known_;  // all common normals found so far, also beyond the limits
};

}  // namespace

std::unique_ptr<PartPatches> PartPatches::make(const Part& part, const ParameterValues<double>& values) {
  if (!PartFeatures::exist(part, values)) return nullptr;
  const PartFeatures features(part, values);
  std::vector<Patch> patches = make_patches(part, values, features);
  if (!std::all_of(patches.begin(), patches.end(), is_regular)) return nullptr;
  Eigen::AlignedBox3d box;
  for (const Patch& patch : patches) {
    box.extend((patch.bound.centre.array() - patch.bound.radius).matrix());
    box.extend((patch.bound.centre.array() + patch.bound.radius).matrix());
  }
  return std::unique_ptr<PartPatches>(new PartPatches{features, PatchTree(std::move(patches)), box});
}

const std::vector<PatchPair>& PatchPairs::update(const PartPatches& a, const PartPatches& b,
                                                 const RelativePose& now, const FeatureLimits& limits) {
  const double margin = kMargin * limits.size, turn = margin / a.tree.radius();
  auto is_valid = [&](const Kept& old) {
    // Frobenius norm of the difference: sqrt(8) times the sine of half the angle
    const double turned = (now.R - old.pose.R).norm() / std::sqrt(2.0);
    return old.max_gap >= limits.max_gap && old.max_gap <= limits.max_gap + margin && turned <= turn &&
           (now.d - old.pose.d).norm() + turned * a.tree.radius() <= margin;
  };
  if (is_valid(kept[0])) return kept[0].pairs;
  std::swap(kept[0], kept[1]);
  if (is_valid(kept[0])) return kept[0].pairs;
  kept[0].pose = now;
  kept[0].max_gap = limits.max_gap + 0.5 * margin;
  PatchTree::find_pairs(a.tree, b.tree, now, {kept[0].max_gap, limits.max_depth, margin, turn},
                        kept[0].pairs);
  return kept[0].pairs;
}

bool touch_features(const PartPatches& a, const PartPatches& b, const RelativePose& pose,
                    const FeatureLimits& limits, PatchPairs& candidates, std::vector<CommonNormal>& found) {
  found.clear();
  PairSearch search(a, b, pose, limits, candidates.known);
  const PairReach reach{limits.max_gap, limits.max_depth, 0, 0};
  for (const PatchPair& pair : candidates.update(a, b, pose, limits)) {
    if (!PatchTree::can_touch(a.tree, b.tree, pose, reach, pair)) continue;
    if (!search.add(a.tree.patches()[static_cast<std::size_t>(pair.a)],
                    b.tree.patches()[static_cast<std::size_t>(pair.b)], found))
      return false;
  }
  const bool overlaps =
      std::any_of(found.begin(), found.end(), [](const CommonNormal& at) { return at.gap < 0; });
  if (!overlaps && search.is_deep()) return false;
  if (found.size() > kMaxOnCurve) keep_outermost(found, limits.size);
  return true;
}

}  // namespace pliant
