#include <pliant/collision/mesh/mesh_finder.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <pliant/body/multibody.h>
#include <pliant/collision/box_tree.h>
#include <pliant/collision/mesh/mesh_touches.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

/// An obstacle holds what is no deeper behind it than this share of the part's thickness: beyond may be the
/// far side of the part, over a plate that it lies on. In a step it moves by less.
constexpr double kDeepest = 0.25, kStepShare = 0.2;

}  // namespace

MeshFinder::MeshFinder(const Model& model, const std::vector<ObstacleMesh>& obstacles)
    : model_(&model), rules_(model) {
  const int n = static_cast<int>(model.parts().size());
  auto need = [&](int i) { meshes_.try_emplace(i, model.parts()[at(i)]); };
  for (int i = 0; i < n; ++i) {
    if (!is_soft(i)) continue;
    for (std::size_t k = 0; k < model.body().contact.planes.size(); ++k) {
      const ContactRule rule = rules_.on_plane(i, static_cast<int>(k));
      if (!rule.touch) continue;
      need(i);
      planes_.push_back({i, k, rule});
    }
    for (std::size_t k = 0; k < obstacles.size(); ++k) {
      const ContactRule rule = rules_.on_obstacle(i, static_cast<int>(k));
      if (!rule.touch) continue;
      need(i);
      on_obstacles_.push_back({i, k, &obstacles[k], rule});
    }
    for (int j = 0; j < n; ++j) {
      if (j == i || (j < i && is_soft(j)) || !rules_.of_parts(std::min(i, j), std::max(i, j)).touch) continue;
      need(i);
      need(j);
    }
  }
}

bool MeshFinder::is_soft(int part) const {
  return model_->parts()[at(part)].local != nullptr;
}

template <class Thing, class F>
void MeshFinder::each_pair(const State& state, const std::map<int, Thing>& all, F&& act) const {
  std::vector<Eigen::AlignedBox3d> boxes;
  std::vector<const Thing*> things;
  for (const auto& [part, thing] : all) {
    boxes.emplace_back(thing.c.array() - thing.reach, thing.c.array() + thing.reach);
    things.push_back(&thing);
  }
  BoxTree tree;
  tree.build(boxes);
  std::vector<std::pair<int, int>> pairs;
  tree.near_pairs(0, pairs);
  for (const auto& [i, j] : pairs) {
    const Thing &one = *things[at(i)], &other = *things[at(j)];
    if ((!is_soft(one.part) && !is_soft(other.part)) ||
        (model_->lies_still(state, one.part) && model_->lies_still(state, other.part)) ||
        (one.c - other.c).norm() > one.reach + other.reach)
      continue;
    const ContactRule rule = rules_.of_parts(one.part, other.part);
    if (rule.touch) act(one, other, rule);
  }
}

std::map<int, MeshFinder::Around> MeshFinder::balls(const State& state, double t) const {
  std::map<int, Around> all;
  for (const auto& [part, mesh] : meshes_) {
    Around ball{part, model_->position(state, part, t), 0, {}};
    if (!mesh.reach_takes_all()) {
      ball.reach = mesh.reach(*model_, state, part);
    } else {
      ball.p = mesh.positions(*model_, state, part);
      ball.reach = ball.p.colwise().norm().maxCoeff();
    }
    all.emplace(part, std::move(ball));
  }
  return all;
}

PlacedMesh MeshFinder::place(const State& state, double t, const Around& ball) const {
  const ContactMesh& mesh = meshes_.at(ball.part);
  const Mat3<double> R = model_->orientation(state, ball.part, t).toRotationMatrix();
  auto placed = [&](const Eigen::Matrix3Xd& p) { return PlacedMesh(mesh, (R * p).colwise() + ball.c); };
  return placed(ball.p.cols() > 0 ? ball.p : mesh.positions(*model_, state, ball.part));
}

/// Velocity that a prescribed motion gives a point of a part, m/s.
Vec3<double> MeshFinder::carries(int part, double t, const Vec3<double>& x) const {
  const PrescribedMotion* motion = model_->parts()[at(part)].motion;
  if (motion == nullptr) return Vec3<double>::Zero();
  const MovingFrame frame = motion->at(t);
  return frame.velocity(x - frame.c);
}

ContactSide MeshFinder::side(const PlacedMesh& placed, int part, const State& state, const MeshPoint& point,
                             const Vec3<double>& x) const {
  ContactSide side;
  side.part = part;
  const PartModel& m = model_->parts()[at(part)];
  if (m.local != nullptr) {
    for (std::size_t k = 0; k < 3; ++k)
      if (point.vertex[k] >= 0) side.node[k] = placed.mesh->node(point.vertex[k]);
    side.weight = point.weight;
  } else if (m.q0 >= 0) {
    side.material =
        m.part->label(model_->orientation(state, part).conjugate() * (x - model_->position(state, part)),
                      model_->values(state, part));
  }
  return side;
}

void MeshFinder::find(const State& state, double t, std::vector<Contact>& found) const {
  // Meshes are placed when they are first asked for; balls about them tell which pairs need none.
  const std::map<int, Around> balls = this->balls(state, t);
  std::map<int, PlacedMesh> placed;
  auto mesh_of = [&](int part) -> const PlacedMesh& {
    const auto known = placed.find(part);
    return known != placed.end() ? known->second
                                 : placed.emplace(part, place(state, t, balls.at(part))).first->second;
  };
  for (const OnPlane& on : planes_) {
    const ContactPlane& plane = model_->body().contact.planes[on.plane];
    if (!plane.acts_before(t) || (sleeps(state, on.part) && plane.point.is_constant())) continue;
    const Vec3<Taylor2<double>> moving = plane.point.at(t);
    const Vec3<double> point(moving[0].v, moving[1].v, moving[2].v);
    const Around& ball = balls.at(on.part);
    if (plane.normal.dot(ball.c - point) > ball.reach) continue;
    const PlacedMesh& m = mesh_of(on.part);
    const VecX<double> height = (m.x.colwise() - point).transpose() * plane.normal;
    for (int k = 0; k < height.size(); ++k) {
      if (!(height[k] < 0)) continue;
      Contact contact;
      contact.a = side(m, on.part, state, {{k, -1, -1}, Vec3<double>::UnitX()}, m.x.col(k));
      contact.plane = static_cast<int>(on.plane);
      contact.x = m.x.col(k);
      contact.normal = plane.normal;
      contact.gap = height[k];
      contact.carried = {moving[0].d, moving[1].d, moving[2].d};
      contact.friction = on.rule.friction;
      contact.restitution = on.rule.restitution;
      found.push_back(contact);
    }
  }
  std::vector<MeshTouch> touches;
  for (const OnObstacle& on : on_obstacles_) {
    if (!model_->body().contact.obstacles[on.obstacle].acts_before(t) || sleeps(state, on.part)) continue;
    touches.clear();
    const Around& ball = balls.at(on.part);
    if (!on.mesh->comes_near(ball.c, ball.reach)) continue;
    const PlacedMesh& m = mesh_of(on.part);
    find_touches(m, *on.mesh, kDeepest * m.mesh->thickness(), touches);
    for (const MeshTouch& touch : touches) {
      Contact contact;
      contact.a = side(m, on.part, state, touch.a, touch.x);
      contact.obstacle = static_cast<int>(on.obstacle);
      contact.x = touch.x;
      contact.normal = touch.normal;
      contact.gap = touch.gap;
      contact.friction = on.rule.friction;
      contact.restitution = on.rule.restitution;
      found.push_back(contact);
    }
  }
  each_pair(state, balls, [&](const Around& one, const Around& other, const ContactRule& rule) {
    touches.clear();
    const PlacedMesh &a = mesh_of(one.part), &b = mesh_of(other.part);
    find_touches(a, b, touches);
    auto add = [&](Contact contact) {
      contact.carried = carries(other.part, t, contact.x) - carries(one.part, t, contact.x);
      contact.friction = rule.friction;
      contact.restitution = rule.restitution;
      found.push_back(contact);
    };
    if (are_deep(state, t, one, other, a, b, touches)) return add(way_out(state, t, one, other, a, b));
    for (const MeshTouch& touch : touches) {
      Contact contact;
      contact.a = side(a, one.part, state, touch.a, touch.x);
      contact.b = side(b, other.part, state, touch.b, touch.x - touch.gap * touch.normal);
      contact.x = touch.x;
      contact.normal = touch.normal;
      contact.gap = touch.gap;
      add(contact);
    }
  });
}

void MeshFinder::approach(const State& state, const State* after, double t, double h, double reach,
                          ContactFinder::Neighbourhood& near) const {
  struct Swept {
    int part;
    Vec3<double> c;
    double way, gained;  // of any point in the world, m: at the velocities of the start, and as they change
    Vec3<double> fall;   // what gravity adds to that, m
    double reach;        // about c, with the way, m
  };
  const Vec3<double> g = model_->body().gravity_at(t);
  std::map<int, Swept> all;
  for (const auto& [part, mesh] : meshes_) {
    const PartModel& m = model_->parts()[at(part)];
    Swept swept{
        part, model_->position(state, part, t), 0, 0, Vec3<double>::Zero(), mesh.reach(*model_, state, part)};
    if (m.q0 >= 0) {
      auto speed = [&, &mesh = mesh](const State& of, const Vec3<double>& fallen) {
        const auto v = of.v.segment(m.v0, m.n_v());
        return (v.head<3>() - fallen).norm() + swept.reach * v.segment<3>(3).norm() + mesh.speed(of);
      };
      const bool falls = !sleeps(state, part);
      swept.way = h * speed(state, Vec3<double>::Zero());
      if (falls) swept.fall = reach * h * h * g;
      if (after != nullptr && falls) swept.gained = std::max(0.0, h * speed(*after, h * g) - swept.way);
      swept.reach += swept.way + swept.gained + (after == nullptr ? h * h * g.norm() : swept.fall.norm());
    } else if (m.motion != nullptr) {
      const TimeVector::Passage passage = m.motion->over(t, h, swept.reach);
      swept.way = h * (passage.rate.norm() + passage.beside);
      swept.reach += swept.way;
    }
    all.emplace(part, swept);
  }
  for (const OnPlane& on : planes_) {
    const ContactPlane& plane = model_->body().contact.planes[on.plane];
    if (!plane.acts_before(t) && !plane.acts_before(t + h)) continue;
    if (sleeps(state, on.part) && plane.point.is_constant()) continue;
    const Swept& a = all.at(on.part);
    if (!(plane.normal.dot(a.c) - plane.highest(t, h) < a.reach)) continue;
    near.soft = true;
    // It is not thin, but may go to and fro.
    near.keep_within(h * plane.point.over(t, h).beside, 0, kStepShare * meshes_.at(on.part).thickness(), h,
                     after != nullptr);
  }
  for (const OnObstacle& on : on_obstacles_) {
    const ContactObstacle& obstacle = model_->body().contact.obstacles[on.obstacle];
    if ((!obstacle.acts_before(t) && !obstacle.acts_before(t + h)) || sleeps(state, on.part)) continue;
    const Swept& a = all.at(on.part);
    if (!on.mesh->comes_near(a.c, a.reach)) continue;
    near.soft = true;
    near.keep_within(a.way, a.gained + a.fall.norm(), kStepShare * meshes_.at(on.part).thickness(), h,
                     after != nullptr);
  }
  each_pair(state, all, [&](const Swept& a, const Swept& b, const ContactRule&) {
    near.soft = true;
    const double thin =
        ContactFinder::kThinShare * std::min(meshes_.at(a.part).thickness(), meshes_.at(b.part).thickness());
    near.keep_within(a.way + b.way, a.gained + b.gained + (a.fall - b.fall).norm(), thin, h,
                     after != nullptr);
  });
  near.empty = near.empty && !near.soft;
}

}  // namespace pliant
