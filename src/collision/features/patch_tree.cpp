#include "patch_tree.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

namespace pliant {

namespace {

/// Whether a direction is inside a cone, or outside it by at most a given angle. cosine, sine: those of this
/// angle. along: cosine of the angle between the direction and the axis of the cone.
bool is_near_cone(double along, const PatchBound& cone, double cosine, double sine) {
  // The sum of both angles exceeds pi if its sine is negative.
  return cone.angle >= kPi || cone.sine * cosine + cone.cosine * sine < 0 ||
         along >= cone.cosine * cosine - cone.sine * sine;
}

/// Whether two bounds can contain a common normal (PatchTree::find_pairs). The bound of a is in the frame of
/// b and already enlarged (placed()).
bool can_meet(const PatchBound& a, const PatchBound& b, const PairReach& reach) {
  const Vec3<double> d = a.centre - b.centre;
  const double radii = a.radius + b.radius, square = d.squaredNorm(),
               most = radii + std::max(reach.max_gap, reach.max_depth);
  if (square > most * most) return false;
  if (b.angle < kPi && !is_near_cone(-a.axis.dot(b.axis), a, b.cosine, b.sine)) return false;
  if (square <= radii * radii) return true;
  const double distance = std::sqrt(square), sine = radii / distance, cosine = std::sqrt(1 - sine * sine),
               along_b = d.dot(b.axis) / distance, along_a = -d.dot(a.axis) / distance;
  auto is_along = [&](double sign) {  // whether the normal can have the direction of sign * d
    return is_near_cone(sign * along_b, b, cosine, sine) && is_near_cone(sign * along_a, a, cosine, sine);
  };
  return (distance - radii <= reach.max_gap && is_along(1)) ||
         (distance - radii <= reach.max_depth && is_along(-1));
}

/// Returns a bound of a in the frame of b, enlarged by reach.margin and reach.turn.
PatchBound placed(const PatchBound& bound, const RelativePose& pose, const PairReach& reach) {
  PatchBound in_b = bound;
  in_b.centre = pose(bound.centre);
  in_b.axis = pose.R * bound.axis;
  in_b.radius += reach.margin;
  if (reach.turn > 0) {  // the angle grows by the angle whose sine is reach.turn
    const double cosine = std::sqrt(1 - reach.turn * reach.turn);
    in_b.angle = std::min(kPi, bound.angle + 1.1 * reach.turn);
    in_b.cosine = bound.cosine * cosine - bound.sine * reach.turn;
    in_b.sine = bound.sine * cosine + bound.cosine * reach.turn;
  }
  return in_b;
}

}  // namespace

double angle_between(const Vec3<double>& a, const Vec3<double>& b) {
  return 2 * std::atan2((a - b).norm(), (a + b).norm());
}

void PatchBound::set_angle(double half_angle) {
  angle = std::min(half_angle, kPi);
  cosine = std::cos(angle);
  sine = std::sin(angle);
}

PatchTree::PatchTree(std::vector<Patch> patches) : patches_(std::move(patches)) {
  std::vector<int> order;
  for (int k = 0; k < static_cast<int>(patches_.size()); ++k) order.push_back(k);
  build(order, 0, order.size());
}

/// Builds the subtree of the patches order[first], ..., order[last - 1] and returns the number of its root.
/// The patches are divided at the median of their positions or normals, whichever spread more.
int PatchTree::build(std::vector<int>& order, std::size_t first, std::size_t last) {
  const int number = static_cast<int>(nodes_.size());
  nodes_.push_back({});
  if (last - first == 1) {
    nodes_.back() = {patches_[static_cast<std::size_t>(order[first])].bound, -1, order[first]};
    return number;
  }
  auto bound = [&](int k) -> const PatchBound& { return patches_[static_cast<std::size_t>(k)].bound; };
  Eigen::AlignedBox3d box, normals;
  Vec3<double> sum = Vec3<double>::Zero();
  for (std::size_t k = first; k < last; ++k) {
    box.extend(bound(order[k]).centre);
    normals.extend(bound(order[k]).axis);
    sum += bound(order[k]).axis;
  }
  PatchBound all;
  all.centre = box.center();
  all.axis = sum.squaredNorm() > 0 ? sum.normalized() : bound(order[first]).axis;
  double angle = 0;
  for (std::size_t k = first; k < last; ++k) {
    const PatchBound& one = bound(order[k]);
    all.radius = std::max(all.radius, (one.centre - all.centre).norm() + one.radius);
    angle = std::max(angle, angle_between(one.axis, all.axis) + one.angle);
  }
  all.set_angle(angle);
  Eigen::Index axis = 0, normal_axis = 0;
  const double size = box.sizes().maxCoeff(&axis), spread = normals.sizes().maxCoeff(&normal_axis);
  const double whole = nodes_.front().bound.radius > 0 ? nodes_.front().bound.radius : all.radius;
  const bool by_place = size >= spread * whole;
  auto key = [&](int k) { return by_place ? bound(k).centre[axis] : bound(k).axis[normal_axis]; };
  const std::size_t middle = first + (last - first) / 2;
  const auto at = [&](std::size_t k) { return order.begin() + static_cast<std::ptrdiff_t>(k); };
  std::nth_element(at(first), at(middle), at(last),
                   [&](int i, int j) { return key(i) != key(j) ? key(i) < key(j) : i < j; });
  nodes_[static_cast<std::size_t>(number)].bound = all;
  const int left = build(order, first, middle), right = build(order, middle, last);
  nodes_[static_cast<std::size_t>(number)].left = left;
  nodes_[static_cast<std::size_t>(number)].right = right;
  return number;
}

void PatchTree::find_pairs(const PatchTree& a, const PatchTree& b, const RelativePose& pose,
                           const PairReach& reach, std::vector<PatchPair>& pairs) {
  pairs.clear();
  auto size = [](const Node& node) { return node.bound.radius * (1 + node.bound.angle); };
  auto visit = [&](const auto& self, int i, int j) -> void {
    const Node &of_a = a.nodes_[static_cast<std::size_t>(i)], &of_b = b.nodes_[static_cast<std::size_t>(j)];
    if (!can_meet(placed(of_a.bound, pose, reach), of_b.bound, reach)) return;
    const bool leaf_a = of_a.left < 0, leaf_b = of_b.left < 0;
    if (leaf_a && leaf_b) {
      pairs.push_back({of_a.right, of_b.right});
    } else if (leaf_b || (!leaf_a && size(of_a) >= size(of_b))) {
      self(self, of_a.left, j);
      self(self, of_a.right, j);
    } else {
      self(self, i, of_b.left);
      self(self, i, of_b.right);
    }
  };
  visit(visit, 0, 0);
}

bool PatchTree::can_touch(const PatchTree& a, const PatchTree& b, const RelativePose& pose,
                          const PairReach& reach, const PatchPair& pair) {
  return can_meet(placed(a.patches_[static_cast<std::size_t>(pair.a)].bound, pose, reach),
                  b.patches_[static_cast<std::size_t>(pair.b)].bound, reach);
}

}  // namespace pliant
