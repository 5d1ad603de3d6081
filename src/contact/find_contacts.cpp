#include <pliant/contact/find_contacts.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include <pliant/body/multibody.h>
#include <pliant/contact/node_motion.h>

namespace pliant {

namespace {

/// Contacts of a pair nearer than this, in sizes of the smaller part, are one.
constexpr double kSame = 0.03;
/// Share of the thinner of two parts that they may move against each other in a step.
constexpr double kThinShare = 0.4;
/// Where the normal of b turns by more than this within a share of the way to the middle of a contact is an
/// edge.
constexpr double kInner = 0.02, kEdgeCosine = 0.9;
/// How far the surface may be outside the box of its points, in sizes of the part.
constexpr double kBulge = 0.05;
/// Normals of one contact differ by less than this.
constexpr double kSameNormal = 0.2;

std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}

}  // namespace

/// A part where it is, and how its frame moves if that is prescribed.
struct ContactFinder::Placed {
  int number;
  const Part* part;
  ParameterValues<double> values;
  Vec3<double> c;
  Mat3<double> R;
  Eigen::Matrix3Xd p, x;    ///< points of its surface, body frame and world
  Eigen::AlignedBox3d box;  ///< world
  Vec3<double> c_dot = Vec3<double>::Zero(), omega = Vec3<double>::Zero();  ///< world

  Vec3<double> carries(const Vec3<double>& point) const { return c_dot + omega.cross(point - c); }
};

ContactFinder::ContactFinder(const Model& model) : model_(&model) {
  const ContactRules rules(model);
  const int n = static_cast<int>(model.parts().size());
  for (const PartModel& m : model.parts()) {
    surfaces_.push_back(m.local == nullptr ? std::make_unique<CollisionSurface>(*m.part) : nullptr);
  }
  on_parts_.resize(at(n) * at(n));
  for (int i = 0; i < n; ++i) {
    for (std::size_t k = 0; k < model.body().contact.planes.size(); ++k)
      on_planes_.push_back(rules.on_plane(i, static_cast<int>(k)));
    for (int j = i + 1; j < n; ++j) on_parts_[at(i) * at(n) + at(j)] = rules.of_parts(i, j);
  }
}

bool ContactFinder::smooth(int part) const {
  return surfaces_[at(part)] != nullptr;
}

ContactFinder::Placed ContactFinder::place(const State& state, double t, int part) const {
  Placed placed{part,
                model_->parts()[at(part)].part,
                model_->values(state, part),
                model_->position(state, part, t),
                model_->orientation(state, part, t).toRotationMatrix(),
                {},
                {},
                {}};
  if (!smooth(part)) return placed;
  placed.p = surfaces_[at(part)]->points(placed.values);
  placed.x = (placed.R * placed.p).colwise() + placed.c;
  const double bulge = kBulge * placed.part->size();
  placed.box = Eigen::AlignedBox3d(placed.x.rowwise().minCoeff().array() - bulge,
                                   placed.x.rowwise().maxCoeff().array() + bulge);
  if (const PrescribedMotion* motion = placed.part->motion()) {
    const MovingFrame frame = motion->at(t);
    placed.c_dot = frame.c_dot;
    placed.omega = frame.omega;
  }
  return placed;
}

void ContactFinder::find_on_plane(const Placed& a, std::size_t number, double t, double most,
                                  std::vector<Contact>& found) const {
  const ContactPlane& plane = model_->body().contact.planes[number];
  if (!plane.acts_at(t)) return;
  const Vec3<Taylor2<double>> moving = plane.point.at(t);
  const Vec3<double> point(moving[0].v, moving[1].v, moving[2].v),
      carried(moving[0].d, moving[1].d, moving[2].d);
  const Vec3<double> n = a.R.transpose() * plane.normal;
  const double offset = plane.normal.dot(a.c - point);
  const CollisionSurface::Field field{
      [&](const Vec3<double>& p) { return p.dot(n) + offset; },
      [&](const Eigen::Matrix3Xd& p) -> VecX<double> { return (p.transpose() * n).array() + offset; }};
  const ContactRule& rule = on_planes_[at(a.number) * model_->body().contact.planes.size() + number];
  for (const CollisionSurface::LowPoint& low :
       surfaces_[at(a.number)]->low_points(a.values, a.p, field.descent(a.p), most, field)) {
    Contact contact;
    contact.a = {a.number, low.material};
    contact.plane = static_cast<int>(number);
    contact.x = a.c + a.R * low.p;
    contact.normal = plane.normal;
    contact.gap = low.height;
    contact.carried = carried;
    contact.friction = rule.friction;
    contact.restitution = rule.restitution;
    found.push_back(contact);
  }
}

void ContactFinder::find_on_part(const Placed& a, const Placed& b, const ContactRule& rule, double most,
                                 std::vector<Contact>& found) const {
  // To first order the distance to b is w - 1 over the length of its gradient.
  auto height = [&](const Vec3<double>& in_b, Vec3<double>* gradient = nullptr) {
    const Vec3<double> slope = b.part->inside_outside_gradient(in_b, b.values);
    if (gradient != nullptr) *gradient = slope;
    return b.part->inside_outside(in_b, b.values) / slope.norm();
  };
  auto into_b = [&](const Vec3<double>& p) -> Vec3<double> {
    return b.R.transpose() * (a.c + a.R * p - b.c);
  };
  const double thickness = surfaces_[at(b.number)]->thickness();
  const CollisionSurface::Field field{[&](const Vec3<double>& p) { return height(into_b(p)); },
                                      [&](const Eigen::Matrix3Xd& p) {
                                        VecX<double> level(p.cols());
                                        for (Eigen::Index k = 0; k < p.cols(); ++k)
                                          level[k] =
                                              thickness * b.part->inside_outside(into_b(p.col(k)), b.values);
                                        return level;
                                      }};
  const double reach = most + 0.1 * std::min(a.part->size(), b.part->size());
  const Eigen::AlignedBox3d near(b.box.min().array() - reach, b.box.max().array() + reach);
  VecX<double> heights = VecX<double>::Constant(a.x.cols(), a.part->size() + b.part->size());
  bool any = false;
  for (Eigen::Index i = 0; i < a.x.cols(); ++i)
    if (near.contains(a.x.col(i))) {
      heights[i] = height(into_b(a.p.col(i)));
      any = true;
    }
  if (!any) return;
  const std::vector<CollisionSurface::LowPoint> lows =
      surfaces_[at(a.number)]->low_points(a.values, a.p, heights, most, field);
  Vec3<double> middle = Vec3<double>::Zero();
  for (const CollisionSurface::LowPoint& low : lows) middle += low.p / static_cast<double>(lows.size());
  for (const CollisionSurface::LowPoint& low : lows) {
    Contact contact;
    Vec3<double> gradient, inner;
    const Vec3<double> in_b = into_b(low.p);
    contact.gap = height(in_b, &gradient);
    // At an edge of b its faces have one normal each: the one that holds for the middle of the contact does.
    const double inner_gap = height(into_b(low.p + kInner * (middle - low.p)), &inner);
    if (inner.normalized().dot(gradient.normalized()) < kEdgeCosine) {
      gradient = inner;
      contact.gap = std::max(contact.gap, inner_gap);
    }
    contact.normal = b.R * gradient.normalized();
    contact.x = a.c + a.R * low.p;
    if (!std::isfinite(contact.gap) || !contact.normal.allFinite() || !(contact.normal.norm() > 0.5))
      continue;
    contact.a = {a.number, low.material};
    contact.b = {b.number, b.part->label(in_b, b.values)};
    contact.carried = b.carries(contact.x) - a.carries(contact.x);
    contact.friction = rule.friction;
    contact.restitution = rule.restitution;
    found.push_back(contact);
  }
}

std::vector<Contact> ContactFinder::find(const State& state, double t, double most) const {
  const int n = static_cast<int>(model_->parts().size());
  std::vector<Placed> placed;
  for (int i = 0; i < n; ++i) placed.push_back(place(state, t, i));
  std::vector<Contact> found;
  const std::size_t planes = model_->body().contact.planes.size();
  for (int i = 0; i < n; ++i)
    for (std::size_t k = 0; k < planes; ++k)
      if (smooth(i) && on_planes_[at(i) * planes + k].touch) find_on_plane(placed[at(i)], k, t, most, found);
  // Sweep and prune along x.
  std::vector<int> order(at(n));
  for (int i = 0; i < n; ++i) order[at(i)] = i;
  auto start = [&](int i) { return placed[at(i)].box.min()[0]; };
  std::sort(order.begin(), order.end(),
            [&](int i, int j) { return std::pair(start(i), i) < std::pair(start(j), j); });
  std::vector<std::pair<int, int>> pairs;
  for (int k = 0; k < n; ++k)
    for (int l = k + 1; l < n; ++l) {
      const Placed &one = placed[at(order[at(k)])], &other = placed[at(order[at(l)])];
      if (other.box.min()[0] > one.box.max()[0] + most) break;
      const int i = std::min(one.number, other.number), j = std::max(one.number, other.number);
      if (smooth(i) && smooth(j) && on_parts_[at(i) * at(n) + at(j)].touch &&
          one.box.squaredExteriorDistance(other.box) <= most * most)
        pairs.emplace_back(i, j);
    }
  std::sort(pairs.begin(), pairs.end());
  for (const auto& [i, j] : pairs) {
    const Placed &a = placed[at(i)], &b = placed[at(j)];
    const ContactRule& rule = on_parts_[at(i) * at(n) + at(j)];
    std::vector<Contact> ours, theirs;
    find_on_part(a, b, rule, most, ours);
    find_on_part(b, a, rule, most, theirs);
    const double same = kSame * std::min(a.part->size(), b.part->size());
    for (Contact& contact : theirs) {
      std::swap(contact.a, contact.b);
      contact.normal = -contact.normal;
      contact.carried = -contact.carried;
      auto twin = std::find_if(ours.begin(), ours.end(), [&](const Contact& other) {
        return (other.x - contact.x).norm() < same && (other.normal - contact.normal).norm() < kSameNormal;
      });
      if (twin == ours.end())
        ours.push_back(contact);
      else if (contact.gap < twin->gap)
        *twin = contact;
    }
    found.insert(found.end(), ours.begin(), ours.end());
  }
  return found;
}

Vec3<double> ContactFinder::velocity(const State& state, const Contact& contact) const {
  auto of = [&](const ContactSide& side) -> Vec3<double> {
    if (side.part < 0 || model_->parts()[at(side.part)].q0 < 0) return Vec3<double>::Zero();
    const PartModel& m = model_->parts()[at(side.part)];
    if (side.at_nodes()) {
      Vec3<double> u = Vec3<double>::Zero();
      for (std::size_t k = 0; k < side.node.size() && side.node[k] >= 0; ++k)
        u += side.weight[static_cast<Eigen::Index>(k)] *
             node_motion(*model_, state, side.part, side.node[k]).x_dot;
      return u;
    }
    const Mat3<double> R = model_->orientation(state, side.part).toRotationMatrix();
    const auto v = state.v.segment(m.v0, m.n_v());
    std::vector<PointJet<double>> jets;
    Counters counters;
    m.part->points({side.material}, state.q.segment(m.q0 + 7, m.n_s), v.segment(6, m.n_s), jets, counters);
    return v.head<3>() + R * (v.segment<3>(3).cross(jets[0].p) + jets[0].p1);
  };
  return of(contact.a) - of(contact.b) - contact.carried;
}

ContactFinder::Neighbourhood ContactFinder::neighbourhood(const State& state, double t, double h) const {
  Neighbourhood near;
  near.h = h;
  const int n = static_cast<int>(model_->parts().size());
  struct Swept {
    Vec3<double> c, c_dot;
    double speed, reach;  // of any point against the frame's origin, m/s; the bounding ball and the way, m
  };
  std::vector<Swept> all;
  for (int i = 0; i < n; ++i) {
    const PartModel& m = model_->parts()[at(i)];
    if (!smooth(i)) {
      all.emplace_back();
      continue;
    }
    Swept swept{model_->position(state, i, t), Vec3<double>::Zero(), 0, 0};
    // A parameter may be larger than at rest: the ball is about where the points are.
    swept.reach = surfaces_[at(i)]->points(model_->values(state, i)).colwise().norm().maxCoeff();
    if (m.q0 >= 0) {
      const auto v = state.v.segment(m.v0, m.n_v());
      swept.c_dot = v.head<3>();
      swept.speed = swept.reach * (v.segment<3>(3).norm() + v.tail(m.n_s).lpNorm<1>() / m.part->size());
      const double free_fall = model_->body().gravity_at(t).norm() * h;
      swept.reach += h * (swept.c_dot.norm() + swept.speed + free_fall);
    } else if (m.motion != nullptr) {
      const MovingFrame now = m.motion->at(t), then = m.motion->at(t + h);
      swept.c_dot = (then.c - now.c) / h;
      swept.speed = swept.reach * std::max(now.omega.norm(), then.omega.norm()) +
                    std::max((now.c_dot - swept.c_dot).norm(), (then.c_dot - swept.c_dot).norm());
      swept.reach += h * (swept.c_dot.norm() + swept.speed);
    }
    all.push_back(swept);
  }
  const auto& planes = model_->body().contact.planes;
  for (int i = 0; i < n; ++i)
    for (std::size_t k = 0; k < planes.size(); ++k) {
      if (!smooth(i) || !on_planes_[at(i) * planes.size() + k].touch ||
          !(planes[k].acts_at(t) || planes[k].acts_at(t + h)))
        continue;
      for (const double when : {t, t + h})
        if (planes[k].normal.dot(all[at(i)].c - planes[k].point.value(when)) < all[at(i)].reach)
          near.empty = false;
    }
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      if (!smooth(i) || !smooth(j) || !on_parts_[at(i) * at(n) + at(j)].touch) continue;
      const Swept &a = all[at(i)], &b = all[at(j)];
      if ((a.c - b.c).norm() > a.reach + b.reach) continue;
      near.empty = false;
      const double way = h * ((a.c_dot - b.c_dot).norm() + a.speed + b.speed);
      const double thin = kThinShare * std::min(surfaces_[at(i)]->thickness(), surfaces_[at(j)]->thickness());
      if (way > thin) near.h = std::min(near.h, h * thin / way);
    }
  return near;
}

double ContactFinder::least_gap(const State& state, double t, const Contact& of, double most) const {
  std::vector<Contact> found;
  const Placed a = place(state, t, of.a.part);
  if (of.b.part < 0) {
    find_on_plane(a, at(of.plane), t, most, found);
  } else {
    const Placed b = place(state, t, of.b.part);
    find_on_part(a, b, {}, most, found);
    find_on_part(b, a, {}, most, found);
  }
  double least = most;
  for (const Contact& contact : found) least = std::min(least, contact.gap);
  return least;
}

}  // namespace pliant
