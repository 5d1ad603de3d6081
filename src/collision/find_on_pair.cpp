// Contacts of a pair of parts: closed forms, support functions of convex parts, common normals of the
// features of parts that are not convex, and for all other pairs the lowest points of each part over the
// other.
#include <algorithm>
#include <cmath>
#include <optional>

#include <pliant/body/multibody.h>
#include <pliant/collision/ellipsoid_points.h>
#include <pliant/math/index.h>

#include "finder_scratch.h"
#include "outline.h"

namespace pliant {

namespace {

/// Contacts of a pair that are nearer than this, in sizes of the smaller part (Part::size(), its largest half
/// extent), are merged.
constexpr double kMergeDistance = 0.03;
/// Whether a contact point is at an edge of b follows from two normals of b. One is at the point; the other
/// is at a share kInner of the way to the middle of the contact. At an edge the cosine of the angle between
/// these normals is below kEdgeCosine.
constexpr double kInner = 0.02, kEdgeCosine = 0.9;
/// Points nearer to the surface of a part than this, in sizes of the part, are treated as points of the
/// surface.
constexpr double kFlush = 1e-4;
/// Accuracy of the distance to the surface along the thin axis of a part, in thicknesses of the part.
constexpr double kBisectionTolerance = 1e-12;
/// Contacts are merged only if the difference of their normals has a norm below this.
constexpr double kMergeNormal = 0.2;
/// Two points of one contact, found on the surfaces of both parts, are equally deep if their gaps differ by
/// less than this, in sizes of the smaller part.
constexpr double kEqualDepth = 1e-9;

/// Largest depth of a contact between features, in thicknesses of the thinner part.
constexpr double kMaxDepth = 0.5;

}  // namespace

/// The inside-outside function f = w - 1 of a part b, as a function of points in the body frame of a part a.
/// To first order the distance to the surface of b is f / |grad f|.
class ContactFinder::OverPart final : public CollisionSurface::Field {
 public:
  OverPart(const Placed& a, const Placed& b, const Part& part, const ParameterValues<double>& values,
           double thickness, int thin_axis)
      : R_(b.R.transpose() * a.R),
        d_(b.R.transpose() * (a.c - b.c)),
        part_(part),
        values_(values),
        axes_(b.axes),
        thickness_(thickness),
        thin_axis_(thin_axis) {}

  const Mat3<double>& R() const { return R_; }
  const Vec3<double>& d() const { return d_; }
  Vec3<double> into_b(const Vec3<double>& p) const { return d_ + R_ * p; }
  double height(const Vec3<double>& in_b, Vec3<double>& gradient) const {
    if (axes_) {
      const Vec3<double> y = in_b.cwiseQuotient(*axes_);
      const double w = y.norm();
      gradient = y.cwiseQuotient(*axes_) / w;
      return (w - 1) / gradient.norm();
    }
    gradient = part_.inside_outside_gradient(in_b, values_);
    const double height = part_.inside_outside(in_b, values_) / gradient.norm();
    // No point of b is deeper than half the thickness of b. If -f / |grad f| exceeds this depth, it is the
    // distance to a far part of the surface, and the distance along the thin axis is used instead.
    return height < -0.5 * thickness_ ? across(in_b, gradient) : height;
  }
  double height(const Vec3<double>& p) const override {
    Vec3<double> gradient;
    return height(into_b(p), gradient);
  }
  double descent(const Vec3<double>& p) const override {
    const Vec3<double> in_b = into_b(p);
    return thickness_ * (axes_ ? in_b.cwiseQuotient(*axes_).norm() - 1 : part_.inside_outside(in_b, values_));
  }

 private:
  /// Returns the height (m, negative) of a point inside b relative to the surface of b. Sets the gradient of
  /// f at a surface point. Bisection finds this surface point along the thin axis, from the point inside b in
  /// the direction away from the middle of b.
  double across(const Vec3<double>& in_b, Vec3<double>& gradient) const {
    const Vec3<double> out = (in_b[thin_axis_] < 0 ? -1.0 : 1.0) * Vec3<double>::Unit(thin_axis_);
    double inside = 0, outside = thickness_;
    while (outside - inside > kBisectionTolerance * thickness_) {
      const double middle = 0.5 * (inside + outside);
      (part_.inside_outside(in_b + middle * out, values_) < 0 ? inside : outside) = middle;
    }
    gradient = part_.inside_outside_gradient(in_b + outside * out, values_);
    return -outside * std::abs(gradient.normalized().dot(out));
  }

  Mat3<double> R_;
  Vec3<double> d_;
  const Part& part_;
  const ParameterValues<double>& values_;
  const std::optional<Vec3<double>>& axes_;
  double thickness_;
  int thin_axis_;  // axis of the least extent of b
};

// Appends the lowest points of a over b. The function is longer than 60 lines, because the closed form of two
// ellipsoids and the general search share the field and the function that adds a contact.
void ContactFinder::find_on_part(int a, int b, const ContactRule& rule, double max_gap,
                                 std::vector<Contact>& found) const {
  const Placed &on = scratch_->parts[at(a)], &over = scratch_->parts[at(b)];
  const Part &part_a = *model_->parts()[at(a)].part, &part_b = *model_->parts()[at(b)].part;
  const ParameterValues<double>&values = scratch_->values[at(a)], &values_b = scratch_->values[at(b)];
  const CollisionSurface& surface = *surfaces_[at(a)];
  const Eigen::AlignedBox3d box = body_box(b);
  int thin_axis = 0;
  box.sizes().minCoeff(&thin_axis);
  const OverPart field(on, over, part_b, values_b, surfaces_[at(b)]->thickness(), thin_axis);
  auto add = [&](const CollisionSurface::LowPoint& low, double gap, const Vec3<double>& gradient) {
    Contact contact;
    contact.gap = gap;
    contact.normal = over.R * gradient.normalized();
    contact.x = on.c + on.R * low.p;
    if (!std::isfinite(gap) || !contact.normal.allFinite() || !(contact.normal.norm() > 0.5)) return;
    contact.a = {a, low.material};
    contact.b = {b, part_b.label(field.into_b(low.p), values_b)};
    contact.prescribed_velocity = over.frame_velocity(contact.x) - on.frame_velocity(contact.x);
    contact.friction = rule.friction;
    contact.restitution = rule.restitution;
    found.push_back(contact);
  };
  if (on.axes && over.axes) {
    const Vec3<double> y =
        nearest_direction(over.axes->cwiseInverse().asDiagonal() * field.R() * on.axes->asDiagonal(),
                          field.d().cwiseQuotient(*over.axes));
    Vec3<double> gradient;
    const double gap = field.height(field.into_b(on.axes->cwiseProduct(y)), gradient);
    if (!(gap > max_gap)) add(surface.ellipsoid_point(values, *on.axes, y), gap, gradient);
    return;
  }
  const Eigen::Matrix3Xd& p = points_of(a);
  const double size = part_a.size() + part_b.size(),
               reach = max_gap + 0.1 * std::min(part_a.size(), part_b.size());
  const Eigen::AlignedBox3d around(box.min().array() - reach, box.max().array() + reach);
  VecX<double> heights = VecX<double>::Constant(p.cols(), size);
  bool any_near = false;
  Vec3<double> gradient;
  for (Eigen::Index i = 0; i < p.cols(); ++i) {
    const Vec3<double> in_b = field.into_b(p.col(i));
    if (!around.contains(in_b)) continue;
    heights[i] = field.height(in_b, gradient);
    any_near = true;
  }
  if (!any_near) return;
  const std::vector<CollisionSurface::LowPoint> lows = surface.low_points(values, p, heights, max_gap, field);
  Vec3<double> middle = Vec3<double>::Zero();
  for (const CollisionSurface::LowPoint& low : lows) middle += low.p / static_cast<double>(lows.size());
  for (const CollisionSurface::LowPoint& low : lows) {
    double gap = field.height(field.into_b(low.p), gradient);
    if (lows.size() > 1) {
      // At an edge of b the contact gets the normal of the face of b under the middle of the contact.
      Vec3<double> inner;
      const Vec3<double> inwards = field.R() * (kInner * (middle - low.p));
      const double inner_gap = field.height(field.into_b(low.p) + inwards, inner);
      if (inner.normalized().dot(gradient.normalized()) < kEdgeCosine) {
        // A point on the surface of b (two stacked faces of equal size) gets the gap over the face under the
        // middle.
        const bool flush = std::abs(gap) < kFlush * part_b.size();
        gap = flush ? inner_gap - inner.normalized().dot(inwards) : std::max(gap, inner_gap);
        gradient = inner;
      }
    }
    add(low, gap, gradient);
  }
}

/// Returns a contact of parts a and b at a point x (m, world).
Contact ContactFinder::contact_at(const Vec3<double>& x, const Vec3<double>& normal, double gap, int a, int b,
                                  const ContactRule& rule) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  auto label = [&](int part, const Placed& placed) {
    return model_->parts()[at(part)].part->label(placed.R.transpose() * (x - placed.c),
                                                 scratch_->values[at(part)]);
  };
  Contact contact;
  contact.x = x;
  contact.normal = normal;
  contact.gap = gap;
  contact.a = {a, label(a, one)};
  contact.b = {b, label(b, other)};
  contact.prescribed_velocity = other.frame_velocity(x) - one.frame_velocity(x);
  contact.friction = rule.friction;
  contact.restitution = rule.restitution;
  return contact;
}

void ContactFinder::find_between_boxes(int a, int b, const ContactRule& rule, double max_gap,
                                       std::vector<Contact>& found) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  std::vector<BoxTouch>& touches = scratch_->of_boxes;
  touches.clear();
  touch_boxes({one.c, one.R, *one.half}, {other.c, other.R, *other.half}, max_gap, touches);
  const std::size_t first = found.size();
  for (const BoxTouch& touch : touches)
    found.push_back(contact_at(touch.x, touch.normal, touch.gap, a, b, rule));
  keep_outline(found, first, std::min(model_->parts()[at(a)].size, model_->parts()[at(b)].size));
}

/// Appends the contacts of two convex parts that are not both ellipsoids. Returns false for other pairs.
bool ContactFinder::find_between_hulls(int a, int b, const ContactRule& rule, double max_gap,
                                       std::vector<Contact>& found) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  if (!uses_hull(a) || !uses_hull(b) || (one.axes && other.axes)) return false;
  if (!is_convex(a) || !is_convex(b)) return false;
  const Hull hull_a(*model_->parts()[at(a)].part, scratch_->values[at(a)], Hull::Convexity::convex),
      hull_b(*model_->parts()[at(b)].part, scratch_->values[at(b)], Hull::Convexity::convex);
  const PlacedHull placed_a{hull_a, one.c, one.R, surfaces_[at(a)]->thickness()},
      placed_b{hull_b, other.c, other.R, surfaces_[at(b)]->thickness()};
  const Separation apart = separation(placed_a, placed_b, max_gap);
  if (apart.gap > max_gap) return true;
  // The contact points are on the smaller part, so that the lever arm of a rolling part is exact.
  std::vector<PairTouch>& touches = scratch_->of_hulls;
  touches.clear();
  touch_pair(placed_a, placed_b, apart, max_gap, hull_b.size() < hull_a.size(), touches);
  const std::size_t first = found.size();
  for (const PairTouch& touch : touches)
    found.push_back(contact_at(touch.x, apart.normal, touch.gap, a, b, rule));
  keep_outline(found, first, std::min(hull_a.size(), hull_b.size()));
  return true;
}

/// Appends the contacts of two parts whose shapes never change, from their faces, edges and vertices. Returns
/// false and appends nothing if a shape changes, the features of a part are not known, both parts are
/// ellipsoids, or the search fails.
bool ContactFinder::find_between_features(int a, int b, const ContactRule& rule, double max_gap,
                                          std::vector<Contact>& found) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  if (!has_fixed_shape(a) || !has_fixed_shape(b) || (one.axes && other.axes)) return false;
  const PartPatches *of_a = surfaces_[at(a)]->rest_patches(), *of_b = surfaces_[at(b)]->rest_patches();
  if (of_a == nullptr || of_b == nullptr) return false;
  const double thickness = std::min(surfaces_[at(a)]->thickness(), surfaces_[at(b)]->thickness()),
               size_a = model_->parts()[at(a)].size, size_b = model_->parts()[at(b)].size;
  const RelativePose pose{other.R.transpose() * one.R, other.R.transpose() * (one.c - other.c)};
  std::vector<CommonNormal>& touches = scratch_->of_features;
  if (!touch_features(
          *of_a, *of_b, pose,
          {max_gap, kMaxDepth * thickness, one_point_distance(thickness), std::min(size_a, size_b)},
          scratch_->patch_pairs[{a, b}], touches))
    return false;
  // The contact points are on the smaller part, so that the lever arm of a rolling part is exact.
  for (const CommonNormal& touch : touches)
    found.push_back(contact_at(other.c + other.R * (size_b < size_a ? touch.y : touch.x),
                               other.R * touch.normal, touch.gap, a, b, rule));
  return true;
}

/// Appends the contact of a ball and a box if its gap is at most max_gap (m). Returns whether the pair is a
/// ball and a box.
bool ContactFinder::find_ball_on_box(int a, int b, const ContactRule& rule, double max_gap,
                                     std::vector<Contact>& found) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  const Placed &ball = one.half ? other : one, &box = one.half ? one : other;
  if (!box.half || !ball.axes || !(ball.axes->array() == ball.axes->x()).all()) return false;
  // The contact point is on the ball, so that the lever arm of a rolling ball is its radius.
  const BoxTouch touch = touch_ball(ball.c, ball.axes->x(), {box.c, box.R, *box.half});
  if (touch.gap <= max_gap)
    found.push_back(contact_at(touch.x, one.half ? -touch.normal : touch.normal, touch.gap, a, b, rule));
  return true;
}

/// Whether two planes normal to the line of centres separate two parts by more than max_gap (m).
bool ContactFinder::are_apart(int a, int b, double max_gap) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  const Vec3<double> d = other.c - one.c;
  auto extent = [&](const Placed& placed) {  // half extent of the part along d, times |d|, m^2
    return placed.axes ? placed.axes->cwiseProduct(placed.R.transpose() * d).norm() : placed.reach * d.norm();
  };
  return d.squaredNorm() - extent(one) - extent(other) > max_gap * d.norm();
}

/// Appends the contacts of a pair of parts. Boxes, balls on boxes and ellipsoids have closed forms. Convex
/// parts use their support functions, and other parts their features. Parts in deep overlap get one contact.
/// For all other pairs both surfaces are searched; a point that is found on both is added once.
void ContactFinder::find_on_pair(int a, int b, const ContactRule& rule, double max_gap,
                                 std::vector<Contact>& found) const {
  if (are_apart(a, b, max_gap)) return;
  if (scratch_->parts[at(a)].half && scratch_->parts[at(b)].half)
    return find_between_boxes(a, b, rule, max_gap, found);
  if (find_ball_on_box(a, b, rule, max_gap, found)) return;
  if (find_between_hulls(a, b, rule, max_gap, found)) return;
  if (find_deep_overlap(a, b, rule, found)) return;
  if (find_between_features(a, b, rule, max_gap, found)) return;
  std::vector<Contact>&ours = scratch_->ours, &theirs = scratch_->theirs;
  ours.clear();
  theirs.clear();
  find_on_part(a, b, rule, max_gap, ours);
  // Two ellipsoids touch at one point. If the search on one surface finds a gap above max_gap, there is no
  // contact.
  const bool at_one_point = scratch_->parts[at(a)].axes && scratch_->parts[at(b)].axes;
  if (at_one_point && ours.empty()) return;
  find_on_part(b, a, rule, max_gap, theirs);
  const double size_a = model_->parts()[at(a)].size, size_b = model_->parts()[at(b)].size,
               same = kMergeDistance * std::min(size_a, size_b),
               as_deep = kEqualDepth * std::min(size_a, size_b);
  // If both points of a contact are equally deep, the point on the smaller part is kept, so that the lever
  // arm of a rolling part is exact.
  for (Contact& contact : theirs) {
    std::swap(contact.a, contact.b);
    contact.normal = -contact.normal;
    contact.prescribed_velocity = -contact.prescribed_velocity;
    auto twin = std::find_if(ours.begin(), ours.end(), [&](const Contact& other) {
      return at_one_point ||
             ((other.x - contact.x).norm() < same && (other.normal - contact.normal).norm() < kMergeNormal);
    });
    if (twin == ours.end())
      ours.push_back(contact);
    else if (contact.gap < twin->gap + (size_b < size_a ? as_deep : -as_deep))
      *twin = contact;
  }
  if (has_fixed_shape(a) && has_fixed_shape(b)) keep_outline(ours, 0, std::min(size_a, size_b));
  found.insert(found.end(), ours.begin(), ours.end());
}

}  // namespace pliant
