#include <pliant/collision/find_contacts.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <tuple>

#include <pliant/body/multibody.h>
#include <pliant/collision/ellipsoid_points.h>
#include <pliant/collision/mesh/find_on_mesh.h>
#include <pliant/math/index.h>

#include "finder_scratch.h"
#include "outline.h"

namespace pliant {

namespace {

/// Contacts of a pair nearer than this, in sizes of the smaller part, are one.
constexpr double kOneContact = 0.03;
/// Where the normal of b turns by more than this within a share of the way to the middle of a contact is an
/// edge.
constexpr double kInner = 0.02, kEdgeCosine = 0.9;
/// Points this near to a surface, in sizes of the part, are in it.
constexpr double kFlush = 1e-4;
/// Gaps over an obstacle are told up to this, in sizes of the part.
constexpr double kSeen = 0.1;
/// How well the way out of a thin body is told, in thicknesses.
constexpr double kAcross = 1e-12;
/// Pairs are looked for among boxes that are wider by this share of the size of a part.
constexpr double kPairMargin = 0.05;
/// And anew where they are wider than needed by this factor.
constexpr double kWider = 2;
/// Normals of one contact differ by less than this.
constexpr double kOneContactNormal = 0.2;
/// Points of both sides whose gaps differ by less, in sizes of the smaller part, are as deep as each other.
constexpr double kAsDeep = 1e-9;

}  // namespace

/// w - 1 of a part b, over points of the frame of a; to first order the distance to b is that over the length
/// of its gradient.
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
    // Nothing is deeper in a body than half its thickness: w has told the way out at a far side.
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
  /// The height of a point in b under its nearer side across the thin axis, and the gradient there.
  double across(const Vec3<double>& in_b, Vec3<double>& gradient) const {
    const Vec3<double> out = (in_b[thin_axis_] < 0 ? -1.0 : 1.0) * Vec3<double>::Unit(thin_axis_);
    double inside = 0, outside = thickness_;
    while (outside - inside > kAcross * thickness_) {
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
  int thin_axis_;  // along which b extends least
};

ContactFinder::~ContactFinder() = default;

ContactFinder::ContactFinder(const Model& model)
    : model_(&model),
      rules_(model),
      any_pairs_(model.body().contact.between_parts || !model.body().contact.pairs.empty()),
      scratch_(std::make_unique<Scratch>()) {
  for (const PartModel& m : model.parts()) {
    if (m.local == nullptr) smooth_.push_back(static_cast<int>(surfaces_.size()));
    surfaces_.push_back(m.local == nullptr ? std::make_unique<CollisionSurface>(*m.part) : nullptr);
  }
  for (int i = 0; i < static_cast<int>(model.parts().size()); ++i)
    for (std::size_t k = 0; k < model.body().contact.planes.size(); ++k)
      on_planes_.push_back(rules_.on_plane(i, static_cast<int>(k)));
  for (const ContactObstacle& obstacle : model.body().contact.obstacles) {
    try {
      obstacles_.emplace_back(obstacle.vertices, obstacle.triangles);
    } catch (const std::invalid_argument& fault) {
      throw std::invalid_argument("obstacle '" + obstacle.name + "': " + fault.what());
    }
  }
  for (int i = 0; i < static_cast<int>(model.parts().size()); ++i)
    for (std::size_t k = 0; k < obstacles_.size(); ++k)
      on_obstacles_.push_back(rules_.on_obstacle(i, static_cast<int>(k)));
  const std::size_t n = model.parts().size();
  scratch_->parts.resize(n);
  scratch_->points.resize(n);
  for (const PartModel& m : model.parts()) scratch_->values.push_back(m.part->parameters().rest());
}

void ContactFinder::find_on_plane(int a, std::size_t number, double most, std::vector<Contact>& found) const {
  const Scratch::PlaneNow& now = scratch_->planes[number];
  if (!now.acts) return;
  const Placed& placed = scratch_->parts[at(a)];
  const Vec3<double>& normal = model_->body().contact.planes[number].normal;
  const double offset = normal.dot(placed.c - now.point);
  if (offset - placed.reach > most) return;
  const Vec3<double> n = placed.R.transpose() * normal;
  const ContactRule& rule = on_planes_[at(a) * scratch_->planes.size() + number];
  const CollisionSurface& surface = *surfaces_[at(a)];
  const ParameterValues<double>& values = scratch_->values[at(a)];
  auto add = [&](const CollisionSurface::LowPoint& low) {
    Contact contact;
    contact.a = {a, low.material};
    contact.plane = static_cast<int>(number);
    contact.x = placed.c + placed.R * low.p;
    contact.normal = normal;
    contact.gap = low.height;
    contact.carried = now.carried;
    contact.friction = rule.friction;
    contact.restitution = rule.restitution;
    found.push_back(contact);
  };
  const CollisionSurface::OverPlane field(n, offset);
  if (placed.axes) {
    const Vec3<double> y = lowest_direction(*placed.axes, n);
    if (field.height(placed.axes->cwiseProduct(y)) > most) return;
    CollisionSurface::LowPoint low = surface.ellipsoid_point(values, *placed.axes, y);
    low.height = field.height(low.p);
    return add(low);
  }
  if (placed.half) {
    for (const Vec3<double>& p : box_corners(*placed.half))
      if (const double height = field.height(p); height <= std::min(most, offset))
        add({model_->parts()[at(a)].part->label(p, values), p, height});
    return;
  }
  const Eigen::Matrix3Xd& p = points_of(a);
  const VecX<double> heights = (p.transpose() * n).array() + offset;
  const std::size_t first = found.size();
  for (const CollisionSurface::LowPoint& low : surface.low_points(values, p, heights, most, field)) add(low);
  if (is_still(a)) keep_outline(found, first, model_->parts()[at(a)].part->size());
}

void ContactFinder::find_on_obstacle(int a, std::size_t number, double t, double most,
                                     std::vector<Contact>& found) const {
  if (!model_->body().contact.obstacles[number].acts_before(t)) return;
  const Placed& placed = scratch_->parts[at(a)];
  const std::size_t first = found.size();
  find_on_mesh({*model_->parts()[at(a)].part, *surfaces_[at(a)], scratch_->values[at(a)], placed.c, placed.R,
                placed.axes, world_box(a), [&]() -> const Eigen::Matrix3Xd& { return points_of(a); }},
               obstacles_[number], most, scratch_->mesh_search, found);
  const ContactRule& rule = on_obstacles_[at(a) * obstacles_.size() + number];
  for (std::size_t k = first; k < found.size(); ++k) {
    found[k].a.part = a;
    found[k].obstacle = static_cast<int>(number);
    found[k].friction = rule.friction;
    found[k].restitution = rule.restitution;
  }
}

void ContactFinder::find_on_part(int a, int b, const ContactRule& rule, double most,
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
    contact.carried = over.carries(contact.x) - on.carries(contact.x);
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
    if (!(gap > most)) add(surface.ellipsoid_point(values, *on.axes, y), gap, gradient);
    return;
  }
  const Eigen::Matrix3Xd& p = points_of(a);
  const double size = part_a.size() + part_b.size(),
               reach = most + 0.1 * std::min(part_a.size(), part_b.size());
  const Eigen::AlignedBox3d around(box.min().array() - reach, box.max().array() + reach);
  VecX<double> heights = VecX<double>::Constant(p.cols(), size);
  bool any = false;
  Vec3<double> gradient;
  for (Eigen::Index i = 0; i < p.cols(); ++i) {
    const Vec3<double> in_b = field.into_b(p.col(i));
    if (!around.contains(in_b)) continue;
    heights[i] = field.height(in_b, gradient);
    any = true;
  }
  if (!any) return;
  const std::vector<CollisionSurface::LowPoint> lows = surface.low_points(values, p, heights, most, field);
  Vec3<double> middle = Vec3<double>::Zero();
  for (const CollisionSurface::LowPoint& low : lows) middle += low.p / static_cast<double>(lows.size());
  for (const CollisionSurface::LowPoint& low : lows) {
    double gap = field.height(field.into_b(low.p), gradient);
    if (lows.size() > 1) {
      // At an edge of b its faces have one normal each: the one that holds for the middle of the contact
      // does.
      Vec3<double> inner;
      const Vec3<double> inwards = field.R() * (kInner * (middle - low.p));
      const double inner_gap = field.height(field.into_b(low.p) + inwards, inner);
      if (inner.normalized().dot(gradient.normalized()) < kEdgeCosine) {
        // A point in a side of b, as where faces of a size lie on each other, is as deep as its face is
        // there.
        const bool flush = std::abs(gap) < kFlush * part_b.size();
        gap = flush ? inner_gap - inner.normalized().dot(inwards) : std::max(gap, inner_gap);
        gradient = inner;
      }
    }
    add(low, gap, gradient);
  }
}

/// A contact of two parts at a point of the world.
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
  contact.carried = other.carries(x) - one.carries(x);
  contact.friction = rule.friction;
  contact.restitution = rule.restitution;
  return contact;
}

void ContactFinder::find_between_boxes(int a, int b, const ContactRule& rule, double most,
                                       std::vector<Contact>& found) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  std::vector<BoxTouch>& touches = scratch_->of_boxes;
  touches.clear();
  touch_boxes({one.c, one.R, *one.half}, {other.c, other.R, *other.half}, most, touches);
  const std::size_t first = found.size();
  for (const BoxTouch& touch : touches)
    found.push_back(contact_at(touch.x, touch.normal, touch.gap, a, b, rule));
  keep_outline(found, first,
               std::min(model_->parts()[at(a)].part->size(), model_->parts()[at(b)].part->size()));
}

/// Whether one of a pair is a ball and the other a box; adds where they touch if they do.
bool ContactFinder::find_ball_on_box(int a, int b, const ContactRule& rule, double most,
                                     std::vector<Contact>& found) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  const Placed &ball = one.half ? other : one, &box = one.half ? one : other;
  if (!box.half || !ball.axes || !(ball.axes->array() == ball.axes->x()).all()) return false;
  // The point is on the ball, so that one that rolls keeps its arm.
  const BoxTouch touch = touch_ball(ball.c, ball.axes->x(), {box.c, box.R, *box.half});
  if (touch.gap <= most)
    found.push_back(contact_at(touch.x, one.half ? -touch.normal : touch.normal, touch.gap, a, b, rule));
  return true;
}

/// Whether a plane across the line of their centres parts two bodies, by more than `most`.
bool ContactFinder::are_apart(int a, int b, double most) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  const Vec3<double> d = other.c - one.c;
  auto extent = [&](const Placed& placed) {  // along d, times its length
    return placed.axes ? placed.axes->cwiseProduct(placed.R.transpose() * d).norm() : placed.reach * d.norm();
  };
  return d.squaredNorm() - extent(one) - extent(other) > most * d.norm();
}

/// Contacts of a pair, each point once though both surfaces are searched.
void ContactFinder::find_between(int a, int b, const ContactRule& rule, double most,
                                 std::vector<Contact>& found) const {
  if (are_apart(a, b, most)) return;
  if (scratch_->parts[at(a)].half && scratch_->parts[at(b)].half)
    return find_between_boxes(a, b, rule, most, found);
  if (find_ball_on_box(a, b, rule, most, found)) return;
  if (find_deep(a, b, rule, found)) return;
  std::vector<Contact>&ours = scratch_->ours, &theirs = scratch_->theirs;
  ours.clear();
  theirs.clear();
  find_on_part(a, b, rule, most, ours);
  // Two ellipsoids touch at one point, and are no nearer than w of one of them and its gradient there tell.
  const bool at_one_point = scratch_->parts[at(a)].axes && scratch_->parts[at(b)].axes;
  if (at_one_point && ours.empty()) return;
  find_on_part(b, a, rule, most, theirs);
  const double size_a = model_->parts()[at(a)].part->size(), size_b = model_->parts()[at(b)].part->size(),
               same = kOneContact * std::min(size_a, size_b), as_deep = kAsDeep * std::min(size_a, size_b);
  for (Contact& contact : theirs) {
    std::swap(contact.a, contact.b);
    contact.normal = -contact.normal;
    contact.carried = -contact.carried;
    auto twin = std::find_if(ours.begin(), ours.end(), [&](const Contact& other) {
      return at_one_point || ((other.x - contact.x).norm() < same &&
                              (other.normal - contact.normal).norm() < kOneContactNormal);
    });
    if (twin == ours.end())
      ours.push_back(contact);
    else if (contact.gap < twin->gap + (size_b < size_a ? as_deep : -as_deep))
      *twin = contact;  // of two as deep the point on the smaller part, so that one that rolls keeps its arm
  }
  if (is_still(a) && is_still(b)) keep_outline(ours, 0, std::min(size_a, size_b));
  found.insert(found.end(), ours.begin(), ours.end());
}

/// Pairs of parts, of which one at least is marked, whose boxes are no farther from each other than `most`.
/// While boxes stay within wider ones, only pairs of which these meet are looked at.
void ContactFinder::find_near_pairs(double most, const std::vector<bool>* of) const {
  Scratch& s = *scratch_;
  s.boxes.clear();
  for (const int i : smooth_) s.boxes.push_back(world_box(i));
  const Vec3<double> reach = Vec3<double>::Constant(0.5 * most);
  bool within = s.wide.size() == s.boxes.size() && s.wide_reach <= kWider * reach[0] + s.wide_margin;
  for (std::size_t k = 0; within && k < s.boxes.size(); ++k)
    within = s.wide[k].contains(Eigen::AlignedBox3d(s.boxes[k].min() - reach, s.boxes[k].max() + reach));
  if (!within) {
    s.wide.clear();
    s.wide_reach = reach[0];
    s.wide_margin = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < smooth_.size(); ++k) {
      const double spare = kPairMargin * model_->parts()[at(smooth_[k])].part->size();
      const Vec3<double> margin = reach.array() + spare;
      s.wide_margin = std::min(s.wide_margin, spare);
      s.wide.emplace_back(s.boxes[k].min() - margin, s.boxes[k].max() + margin);
    }
    s.tree.build(s.wide);
    s.tree.near_pairs(0, s.wide_pairs);
  }
  s.pairs.clear();
  for (const auto& [one, other] : s.wide_pairs) {
    const int i = smooth_[at(one)], j = smooth_[at(other)];
    if (of != nullptr && !(*of)[at(i)] && !(*of)[at(j)]) continue;
    if (s.boxes[at(one)].squaredExteriorDistance(s.boxes[at(other)]) <= most * most)
      s.pairs.emplace_back(i, j);
  }
}

std::vector<Contact> ContactFinder::find(const State& state, double t, double most,
                                         const std::vector<bool>* of) const {
  Scratch& s = *scratch_;
  place_planes(t);
  std::vector<Contact> found;
  for (const int i : smooth_) {
    place(state, t, i);
    if (of != nullptr && !(*of)[at(i)]) continue;
    const bool asleep = sleeps(state, i);
    for (std::size_t k = 0; k < s.planes.size(); ++k) {
      const bool at_rest = asleep && model_->body().contact.planes[k].point.is_constant();
      if (on_planes_[at(i) * s.planes.size() + k].touch && !at_rest) find_on_plane(i, k, most, found);
    }
    if (asleep) continue;
    for (std::size_t k = 0; k < obstacles_.size(); ++k)
      if (on_obstacles_[at(i) * obstacles_.size() + k].touch) find_on_obstacle(i, k, t, most, found);
  }
  if (!any_pairs_) return found;
  find_near_pairs(most, of);
  for (const auto& [i, j] : s.pairs) {
    if (model_->lies_still(state, i) && model_->lies_still(state, j)) continue;
    const ContactRule rule = rules_.of_parts(i, j);
    if (rule.touch) find_between(i, j, rule, most, found);
  }
  return found;
}

bool ContactFinder::precedes(const Contact& one, const Contact& other) {
  auto place = [](const Contact& c) {
    return std::tuple(c.b.part >= 0, c.a.part, c.b.part, c.obstacle, c.plane);
  };
  return place(one) < place(other);
}

double ContactFinder::least_gap(const State& state, double t, const Contact& of, double most) const {
  std::vector<Contact> found;
  place(state, t, of.a.part);
  if (of.obstacle >= 0) {
    most = std::min(most, kSeen * model_->parts()[at(of.a.part)].part->size());
    find_on_obstacle(of.a.part, at(of.obstacle), t, most, found);
  } else if (of.b.part < 0) {
    place_planes(t);
    find_on_plane(of.a.part, at(of.plane), most, found);
  } else {
    place(state, t, of.b.part);
    find_between(of.a.part, of.b.part, {}, most, found);
  }
  double least = most;
  for (const Contact& contact : found) least = std::min(least, contact.gap);
  return least;
}

}  // namespace pliant
