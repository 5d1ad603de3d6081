// Contacts with planes and obstacles, and the pairs of parts that are near each other.
#include <pliant/collision/find_contacts.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <tuple>

#include <pliant/body/multibody.h>
#include <pliant/collision/ellipsoid_points.h>
#include <pliant/math/index.h>

#include "finder_scratch.h"
#include "outline.h"

namespace pliant {

namespace {

/// Largest gap over an obstacle that min_gap() returns, in sizes of the part.
constexpr double kMaxReportedGap = 0.1;
/// The boxes of the pair search are enlarged by this share of the size of a part.
constexpr double kPairMargin = 0.05;
/// The boxes are also enlarged by half the largest gap of their search. They are computed again if this half
/// gap exceeds kMaxExcess times the half gap of the present search plus the least margin of the boxes.
constexpr double kMaxExcess = 2;
/// Pairs of patches (features/) are kept for at most this many pairs of parts, as a multiple of the number of
/// nearby pairs.
constexpr std::size_t kMaxKeptPairs = 2;

}  // namespace

ContactFinder::~ContactFinder() = default;

ContactFinder::ContactFinder(const Model& model)
    : model_(&model), rules_(std::make_shared<ContactRules>(model)) {
  for (const PartModel& m : model.parts())
    surfaces_.push_back(m.local == nullptr ? std::make_shared<CollisionSurface>(*m.part) : nullptr);
  std::vector<ObstacleMesh> meshes;
  for (const ContactObstacle& obstacle : model.body().contact.obstacles) {
    try {
      meshes.emplace_back(obstacle.vertices, obstacle.triangles);
    } catch (const std::invalid_argument& fault) {
      throw std::invalid_argument("obstacle '" + obstacle.name + "': " + fault.what());
    }
  }
  obstacles_ = std::make_shared<const std::vector<ObstacleMesh>>(std::move(meshes));
  set_up();
}

ContactFinder::ContactFinder(const Model& model, const ContactFinder& whole)
    : model_(&model), rules_(whole.rules_), obstacles_(whole.obstacles_) {
  for (const int i : model.part_numbers()) surfaces_.push_back(whole.surfaces_[at(i)]);
  set_up();
}

/// Looks up the rules of the parts with planes and obstacles, and allocates the scratch storage.
void ContactFinder::set_up() {
  const ContactSettings& settings = model_->body().contact;
  has_pairs_ = settings.between_parts || !settings.pairs.empty();
  scratch_ = std::make_unique<Scratch>();
  const std::vector<PartModel>& parts = model_->parts();
  for (std::size_t i = 0; i < parts.size(); ++i) {
    if (parts[i].local == nullptr) smooth_parts_.push_back(static_cast<int>(i));
    const int number = model_->part_numbers()[i];
    for (std::size_t k = 0; k < settings.planes.size(); ++k)
      on_planes_.push_back(rules_->on_plane(number, static_cast<int>(k)));
    for (std::size_t k = 0; k < obstacles_->size(); ++k)
      on_obstacles_.push_back(rules_->on_obstacle(number, static_cast<int>(k)));
    scratch_->values.push_back(parts[i].part->parameters().rest());
  }
  scratch_->parts.resize(parts.size());
  scratch_->points.resize(parts.size());
}

/// Returns the rule of two parts. The rules number the parts as the body does.
ContactRule ContactFinder::rule_of(int a, int b) const {
  const std::vector<int>& numbers = model_->part_numbers();
  return rules_->of_parts(numbers[at(a)], numbers[at(b)]);
}

void ContactFinder::find_on_plane(int a, std::size_t number, double max_gap,
                                  std::vector<Contact>& found) const {
  const Scratch::PlaneNow& now = scratch_->planes[number];
  if (!now.acts) return;
  const Placed& placed = scratch_->parts[at(a)];
  const Vec3<double>& normal = model_->body().contact.planes[number].normal;
  const double offset = normal.dot(placed.c - now.point);
  if (offset - placed.reach > max_gap) return;
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
    contact.prescribed_velocity = now.prescribed_velocity;
    contact.friction = rule.friction;
    contact.restitution = rule.restitution;
    found.push_back(contact);
  };
  const CollisionSurface::OverPlane field(n, offset);
  if (placed.axes) {
    const Vec3<double> y = lowest_direction(*placed.axes, n);
    if (field.height(placed.axes->cwiseProduct(y)) > max_gap) return;
    CollisionSurface::LowPoint low = surface.ellipsoid_point(values, *placed.axes, y);
    low.height = field.height(low.p);
    return add(low);
  }
  if (placed.half) {
    for (const Vec3<double>& p : box_corners(*placed.half))
      if (const double height = field.height(p); height <= std::min(max_gap, offset))
        add({model_->parts()[at(a)].part->label(p, values), p, height});
    return;
  }
  if (uses_hull(a)) {
    const Vec3<double> along = placed.R.transpose() * normal.unitOrthogonal();
    const Hull hull = hull_of(a);
    touch_plane(hull, surface.thickness(), {n, offset, along}, max_gap, scratch_->hull_points,
                scratch_->of_plane);
    for (const PlaneTouch& touch : scratch_->of_plane) add({hull.label(touch.p), touch.p, touch.height});
    return;
  }
  const Eigen::Matrix3Xd& p = points_of(a);
  const VecX<double> heights = (p.transpose() * n).array() + offset;
  const std::size_t first = found.size();
  for (const CollisionSurface::LowPoint& low : surface.low_points(values, p, heights, max_gap, field))
    add(low);
  if (has_fixed_shape(a)) keep_outline(found, first, model_->parts()[at(a)].size);
}

/// Whether the contacts of a part follow from its support function at the present parameters.
bool ContactFinder::uses_hull(int i) const {
  std::optional<bool>& hull = scratch_->parts[at(i)].hull;
  if (!hull) hull = Hull::exists(*model_->parts()[at(i)].part, scratch_->values[at(i)]);
  return *hull;
}

/// Whether a part that uses its hull is convex at the present parameters.
bool ContactFinder::is_convex(int i) const {
  std::optional<bool>& convex = scratch_->parts[at(i)].convex;
  if (!convex) convex = Hull::is_convex(*model_->parts()[at(i)].part, scratch_->values[at(i)]);
  return *convex;
}

/// Returns the hull of a part that uses its hull. With dynamic parameters its convexity is unknown, because
/// the test of convexity takes longer than the search from several starts.
Hull ContactFinder::hull_of(int i) const {
  const bool convex = has_fixed_shape(i) && is_convex(i);
  return {*model_->parts()[at(i)].part, scratch_->values[at(i)],
          convex ? Hull::Convexity::convex : Hull::Convexity::unknown};
}

bool ContactFinder::is_smooth(const Contact& contact) const {
  if (contact.obstacle >= 0 && !(*obstacles_)[at(contact.obstacle)].is_flat()) return false;
  return is_round(contact.a.part) || is_round(contact.b.part);
}

/// Whether a part has no face, no edge and no nearly flat region.
bool ContactFinder::is_round(int i) const {
  if (i < 0 || !surfaces_[at(i)]) return false;
  const ShapeInterface& shape = model_->parts()[at(i)].part->shape();
  const double* a = scratch_->values[at(i)].b.data();
  return shape.hull_pieces() > 0 && shape.has_support(a) && !shape.has_flat_regions(a) &&
         !shape.has_end_faces() && !shape.half_sizes(a);
}

std::optional<Contact> ContactFinder::follow(const Contact& contact) const {
  const int a = contact.a.part;
  if (contact.plane < 0 || contact.a.at_nodes() || !uses_hull(a)) return std::nullopt;
  const ParameterValues<double>& values = scratch_->values[at(a)];
  const Part& part = *model_->parts()[at(a)].part;
  const Scratch::PlaneNow& plane = scratch_->planes[at(contact.plane)];
  if (!plane.acts || !part.shape().has_flat_regions(values.b.data())) return std::nullopt;
  Contact moved = contact;
  scratch_->material[0] = contact.a.material;
  moved.x = scratch_->parts[at(a)].c + scratch_->parts[at(a)].R * part.s(scratch_->material, values).col(0);
  moved.gap = contact.normal.dot(moved.x - plane.point);
  moved.prescribed_velocity = plane.prescribed_velocity;
  return moved;
}

double ContactFinder::merge_distance(const Contact& contact) const {
  return one_point_distance(surfaces_[at(contact.a.part)]->thickness());
}

void ContactFinder::find_on_obstacle(int a, std::size_t number, double t, double max_gap,
                                     std::vector<Contact>& found) const {
  if (!model_->body().contact.obstacles[number].acts_before(t)) return;
  const Placed& placed = scratch_->parts[at(a)];
  const Eigen::AlignedBox3d box = world_box(a);
  // The hull of a part that is far from the mesh is not made. find_on_mesh() has a smaller bound.
  const double far = std::max(max_gap, 0.0) + model_->parts()[at(a)].part->size();
  if (box.exteriorDistance((*obstacles_)[number].box()) > far) return;
  const std::size_t first = found.size();
  std::optional<Hull> hull;
  if (!placed.axes && uses_hull(a)) hull.emplace(hull_of(a));
  find_on_mesh(
      {*model_->parts()[at(a)].part, *surfaces_[at(a)], scratch_->values[at(a)], placed.c, placed.R,
       placed.axes, hull ? &*hull : nullptr, box, [&]() -> const Eigen::Matrix3Xd& { return points_of(a); }},
      (*obstacles_)[number], max_gap, scratch_->mesh_search, found);
  const ContactRule& rule = on_obstacles_[at(a) * obstacles_->size() + number];
  for (std::size_t k = first; k < found.size(); ++k) {
    found[k].a.part = a;
    found[k].obstacle = static_cast<int>(number);
    found[k].friction = rule.friction;
    found[k].restitution = rule.restitution;
  }
}

/// Finds the pairs of parts whose boxes are at most max_gap (m) apart. marked: if given, at least one part of
/// each pair is marked. The pairs of enlarged boxes are kept from call to call. They are valid while the box
/// of each part, enlarged by half of max_gap, is inside the enlarged box.
void ContactFinder::find_near_pairs(double max_gap, const std::vector<bool>* marked) const {
  Scratch& s = *scratch_;
  s.boxes.clear();
  for (const int i : smooth_parts_) s.boxes.push_back(world_box(i));
  const Vec3<double> reach = Vec3<double>::Constant(0.5 * max_gap);
  bool within = s.wide.size() == s.boxes.size() && s.wide_reach <= kMaxExcess * reach[0] + s.wide_margin;
  for (std::size_t k = 0; within && k < s.boxes.size(); ++k)
    within = s.wide[k].contains(Eigen::AlignedBox3d(s.boxes[k].min() - reach, s.boxes[k].max() + reach));
  if (!within) {
    s.wide.clear();
    s.wide_reach = reach[0];
    s.wide_margin = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < smooth_parts_.size(); ++k) {
      const double spare = kPairMargin * model_->parts()[at(smooth_parts_[k])].size;
      const Vec3<double> margin = reach.array() + spare;
      s.wide_margin = std::min(s.wide_margin, spare);
      s.wide.emplace_back(s.boxes[k].min() - margin, s.boxes[k].max() + margin);
    }
    s.tree.build(s.wide);
    s.tree.near_pairs(0, s.wide_pairs);
    // All kept pairs of patches are dropped if too many of them belong to pairs of parts that are apart now.
    if (s.patch_pairs.size() > kMaxKeptPairs * s.wide_pairs.size()) s.patch_pairs.clear();
  }
  s.pairs.clear();
  for (const auto& [one, other] : s.wide_pairs) {
    const int i = smooth_parts_[at(one)], j = smooth_parts_[at(other)];
    if (marked != nullptr && !(*marked)[at(i)] && !(*marked)[at(j)]) continue;
    if (s.boxes[at(one)].squaredExteriorDistance(s.boxes[at(other)]) <= max_gap * max_gap)
      s.pairs.emplace_back(i, j);
  }
}

std::vector<Contact> ContactFinder::find(const State& state, double t, double max_gap,
                                         const std::vector<bool>* marked) const {
  Scratch& s = *scratch_;
  place_planes(t);
  std::vector<Contact> found;
  found.reserve(s.last_count);
  for (const int i : smooth_parts_) {
    place(state, t, i);
    if (marked != nullptr && !(*marked)[at(i)]) continue;
    const bool asleep = sleeps(state, i);
    for (std::size_t k = 0; k < s.planes.size(); ++k) {
      const bool at_rest = asleep && model_->body().contact.planes[k].point.is_constant();
      if (on_planes_[at(i) * s.planes.size() + k].touch && !at_rest) find_on_plane(i, k, max_gap, found);
    }
    if (asleep) continue;
    for (std::size_t k = 0; k < obstacles_->size(); ++k)
      if (on_obstacles_[at(i) * obstacles_->size() + k].touch) find_on_obstacle(i, k, t, max_gap, found);
  }
  if (has_pairs_) {
    find_near_pairs(max_gap, marked);
    for (const auto& [i, j] : s.pairs) {
      if (model_->is_motionless(state, i) && model_->is_motionless(state, j)) continue;
      const ContactRule rule = rule_of(i, j);
      if (rule.touch) find_on_pair(i, j, rule, max_gap, found);
    }
  }
  if (marked == nullptr) s.last_count = found.size();
  return found;
}

bool ContactFinder::precedes(const Contact& one, const Contact& other) {
  auto place = [](const Contact& c) {
    return std::tuple(c.b.part >= 0, c.a.part, c.b.part, c.obstacle, c.plane);
  };
  return place(one) < place(other);
}

double ContactFinder::min_gap(const State& state, double t, const Contact& contact, double max_gap) const {
  std::vector<Contact> found;
  place(state, t, contact.a.part);
  if (contact.obstacle >= 0) {
    max_gap = std::min(max_gap, kMaxReportedGap * model_->parts()[at(contact.a.part)].size);
    find_on_obstacle(contact.a.part, at(contact.obstacle), t, max_gap, found);
  } else if (contact.b.part < 0) {
    place_planes(t);
    find_on_plane(contact.a.part, at(contact.plane), max_gap, found);
  } else {
    place(state, t, contact.b.part);
    find_on_pair(contact.a.part, contact.b.part, {}, max_gap, found);
  }
  double least = max_gap;
  for (const Contact& one : found) least = std::min(least, one.gap);
  return least;
}

}  // namespace pliant
