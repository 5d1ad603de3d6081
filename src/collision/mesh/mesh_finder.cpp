// Contact search of parts that deform locally, and their contribution to a neighbourhood.
#include <pliant/collision/mesh/mesh_finder.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <pliant/body/multibody.h>
#include <pliant/collision/box_tree.h>
#include <pliant/collision/mesh/mesh_touches.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

/// kMaxDepthInObstacle: largest depth of a vertex behind an obstacle, as a share of the thickness of the
/// part. A deeper vertex may be on the far side of the part: the top of a part that rests on a plate is
/// behind the lower face of the plate. kMaxStepShare: limit of the motion of a part near an obstacle in a
/// step, and of the deviation of an oscillating plane from its mean motion, as a share of the thickness of
/// the part.
constexpr double kMaxDepthInObstacle = 0.25, kMaxStepShare = 0.2;

}  // namespace

MeshFinder::MeshFinder(const Model& model, const std::vector<ObstacleMesh>& obstacles) : model_(&model) {
  const int n = static_cast<int>(model.parts().size());
  for (int i = 0; i < n && !rules_; ++i)
    if (deforms_locally(i)) rules_.emplace(model);
  // Cells in flat regions of parts without nodes are at most as large as the mean edge of the finest mesh of
  // nodes, `cell` (m).
  double cell = std::numeric_limits<double>::infinity();
  std::vector<int> without_nodes;
  auto add_mesh = [&](int i) {
    if (!deforms_locally(i)) return without_nodes.push_back(i);
    const ContactMesh& mesh = meshes_.try_emplace(i, model.parts()[at(i)], 0).first->second;
    cell = std::min(cell, mesh.mean_edge());
  };
  for (int i = 0; i < n; ++i) {
    if (!deforms_locally(i)) continue;
    for (std::size_t k = 0; k < model.body().contact.planes.size(); ++k) {
      const ContactRule rule = rules_->on_plane(i, static_cast<int>(k));
      if (!rule.touch) continue;
      add_mesh(i);
      planes_.push_back({i, k, rule});
    }
    for (std::size_t k = 0; k < obstacles.size(); ++k) {
      const ContactRule rule = rules_->on_obstacle(i, static_cast<int>(k));
      if (!rule.touch) continue;
      add_mesh(i);
      on_obstacles_.push_back({i, k, &obstacles[k], rule});
    }
    for (int j = 0; j < n; ++j) {
      if (j == i || (j < i && deforms_locally(j)) || !rules_->of_parts(std::min(i, j), std::max(i, j)).touch)
        continue;
      add_mesh(i);
      add_mesh(j);
    }
  }
  for (const int i : without_nodes) meshes_.try_emplace(i, model.parts()[at(i)], cell);
}

bool MeshFinder::deforms_locally(int part) const {
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
    if ((!deforms_locally(one.part) && !deforms_locally(other.part)) ||
        (model_->is_motionless(state, one.part) && model_->is_motionless(state, other.part)) ||
        (one.c - other.c).norm() > one.reach + other.reach)
      continue;
    const ContactRule rule = rules_->of_parts(one.part, other.part);
    if (rule.touch) act(one, other, rule);
  }
}

std::map<int, MeshFinder::BoundingBall> MeshFinder::balls(const State& state, double t) const {
  std::map<int, BoundingBall> all;
  for (const auto& [part, mesh] : meshes_) {
    BoundingBall ball{part, model_->position(state, part, t), 0, {}};
    if (!mesh.reach_uses_all_vertices()) {
      ball.reach = mesh.reach(*model_, state, part);
    } else {
      ball.p = mesh.positions(*model_, state, part);
      ball.reach = ball.p.colwise().norm().maxCoeff();
    }
    all.emplace(part, std::move(ball));
  }
  return all;
}

PlacedMesh MeshFinder::place(const State& state, double t, const BoundingBall& ball) const {
  const ContactMesh& mesh = meshes_.at(ball.part);
  const Mat3<double> R = model_->orientation(state, ball.part, t).toRotationMatrix();
  auto placed = [&](const Eigen::Matrix3Xd& p) { return PlacedMesh(mesh, (R * p).colwise() + ball.c); };
  return placed(ball.p.cols() > 0 ? ball.p : mesh.positions(*model_, state, ball.part));
}

/// Velocity of a point x (m, world) of a part by its prescribed motion, m/s, world.
Vec3<double> MeshFinder::frame_velocity(int part, double t, const Vec3<double>& x) const {
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

// This function is longer than 60 lines, because planes, obstacles and pairs share the placed meshes.
void MeshFinder::find(const State& state, double t, std::vector<Contact>& found) const {
  // A mesh is placed in the world at its first use, because the bounding balls exclude most pairs.
  const std::map<int, BoundingBall> balls = this->balls(state, t);
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
    const BoundingBall& ball = balls.at(on.part);
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
      contact.prescribed_velocity = {moving[0].d, moving[1].d, moving[2].d};
      contact.friction = on.rule.friction;
      contact.restitution = on.rule.restitution;
      found.push_back(contact);
    }
  }
  std::vector<MeshTouch> touches;
  for (const OnObstacle& on : on_obstacles_) {
    if (!model_->body().contact.obstacles[on.obstacle].acts_before(t) || sleeps(state, on.part)) continue;
    touches.clear();
    const BoundingBall& ball = balls.at(on.part);
    if (!on.mesh->is_within(ball.c, ball.reach)) continue;
    const PlacedMesh& m = mesh_of(on.part);
    find_touches(m, *on.mesh, kMaxDepthInObstacle * m.mesh->thickness(), touches);
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
  each_pair(state, balls, [&](const BoundingBall& one, const BoundingBall& other, const ContactRule& rule) {
    touches.clear();
    const PlacedMesh &a = mesh_of(one.part), &b = mesh_of(other.part);
    find_touches(a, b, touches);
    auto add = [&](Contact contact) {
      contact.prescribed_velocity =
          frame_velocity(other.part, t, contact.x) - frame_velocity(one.part, t, contact.x);
      contact.friction = rule.friction;
      contact.restitution = rule.restitution;
      found.push_back(contact);
    };
    if (is_deep_overlap(state, t, one, other, a, b, touches))
      return add(separation_contact(state, t, one, other, a, b));
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

// This function is longer than 60 lines, because the bounds of the motion are computed once and used for
// planes, obstacles and pairs.
void MeshFinder::approach(const State& state, const State* after, double t, double h, double reach,
                          ContactFinder::Neighbourhood& near) const {
  struct Swept {
    int part;
    Vec3<double> c;
    double travel;         // bound of the motion of any point at the velocities of the start, m, world
    double travel_change;  // bound of the additional motion by the change of these velocities, m
    Vec3<double> fall;     // displacement by gravity, m
    double reach;          // radius of a ball about c, including the motion, m
  };
  const Vec3<double> g = model_->body().gravity_at(t);
  std::map<int, Swept> all;
  for (const auto& [part, mesh] : meshes_) {
    const PartModel& m = model_->parts()[at(part)];
    Swept swept{
        part, model_->position(state, part, t), 0, 0, Vec3<double>::Zero(), mesh.reach(*model_, state, part)};
    if (m.q0 >= 0) {
      auto speed = [&, &surface = mesh](const State& of, const Vec3<double>& fallen) {
        const auto v = of.v.segment(m.v0, m.n_v());
        return (v.head<3>() - fallen).norm() + swept.reach * v.segment<3>(3).norm() + surface.speed(of);
      };
      const bool falls = !sleeps(state, part);
      swept.travel = h * speed(state, Vec3<double>::Zero());
      if (falls) swept.fall = reach * h * h * g;
      if (after != nullptr && falls)
        swept.travel_change = std::max(0.0, h * speed(*after, h * g) - swept.travel);
      swept.reach +=
          swept.travel + swept.travel_change + (after == nullptr ? h * h * g.norm() : swept.fall.norm());
    } else if (m.motion != nullptr) {
      const TimeVector::MeanRate mean = m.motion->over(t, h, swept.reach);
      swept.travel = h * (mean.rate.norm() + mean.max_deviation);
      swept.reach += swept.travel;
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
    // No part can pass through a half space. Only the oscillation of a plane limits the step.
    near.limit_travel(h * plane.point.over(t, h).max_deviation, 0,
                      kMaxStepShare * meshes_.at(on.part).thickness(), h, after != nullptr);
  }
  for (const OnObstacle& on : on_obstacles_) {
    const ContactObstacle& obstacle = model_->body().contact.obstacles[on.obstacle];
    if ((!obstacle.acts_before(t) && !obstacle.acts_before(t + h)) || sleeps(state, on.part)) continue;
    const Swept& a = all.at(on.part);
    if (!on.mesh->is_within(a.c, a.reach)) continue;
    near.soft = true;
    near.limit_travel(a.travel, a.travel_change + a.fall.norm(),
                      kMaxStepShare * meshes_.at(on.part).thickness(), h, after != nullptr);
  }
  each_pair(state, all, [&](const Swept& a, const Swept& b, const ContactRule&) {
    near.soft = true;
    const double allowed_travel = ContactFinder::kMaxTravelShare *
                                  std::min(meshes_.at(a.part).thickness(), meshes_.at(b.part).thickness());
    near.limit_travel(a.travel + b.travel, a.travel_change + b.travel_change + (a.fall - b.fall).norm(),
                      allowed_travel, h, after != nullptr);
  });
  near.empty = near.empty && !near.soft;
}

}  // namespace pliant
