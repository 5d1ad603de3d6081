#include <pliant/contact/mesh_finder.h>

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include <pliant/body/multibody.h>
#include <pliant/contact/mesh_touches.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

/// Share of the thinner of two parts that they may move against each other in a step.
constexpr double kThinStep = 0.4;
/// An obstacle holds what is no deeper behind it than this share of the part's thickness: beyond may be the
/// far side of the part, over a plate that it lies on. In a step it moves by less.
constexpr double kDeepest = 0.25, kStepShare = 0.2;

}  // namespace

MeshFinder::MeshFinder(const Model& model, const std::vector<ObstacleMesh>& obstacles) : model_(&model) {
  const ContactRules rules(model);
  const int n = static_cast<int>(model.parts().size());
  auto soft = [&](int i) { return model.parts()[at(i)].local != nullptr; };
  auto need = [&](int i) { meshes_.try_emplace(i, model.parts()[at(i)]); };
  for (int i = 0; i < n; ++i) {
    if (!soft(i)) continue;
    for (std::size_t k = 0; k < model.body().contact.planes.size(); ++k) {
      const ContactRule rule = rules.on_plane(i, static_cast<int>(k));
      if (!rule.touch) continue;
      need(i);
      planes_.push_back({i, k, rule});
    }
    for (std::size_t k = 0; k < obstacles.size(); ++k) {
      const ContactRule rule = rules.on_obstacle(i, static_cast<int>(k));
      if (!rule.touch) continue;
      need(i);
      on_obstacles_.push_back({i, k, &obstacles[k], rule});
    }
  }
  for (int i = 0; i < n; ++i)
    for (int j = i + 1; j < n; ++j) {
      if (!soft(i) && !soft(j)) continue;
      const ContactRule rule = rules.of_parts(i, j);
      if (!rule.touch) continue;
      need(i);
      need(j);
      pairs_.push_back({i, j, rule});
    }
}

PlacedMesh MeshFinder::place(const State& state, double t, int part) const {
  const ContactMesh& mesh = meshes_.at(part);
  const Mat3<double> R = model_->orientation(state, part, t).toRotationMatrix();
  return PlacedMesh(mesh,
                    (R * mesh.positions(*model_, state, part)).colwise() + model_->position(state, part, t));
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
  struct Around {
    Vec3<double> c;
    double reach;
  };
  std::map<int, Around> balls;
  for (const auto& [part, mesh] : meshes_)
    balls.emplace(part, Around{model_->position(state, part, t), mesh.reach(*model_, state, part)});
  std::map<int, PlacedMesh> placed;
  auto mesh_of = [&](int part) -> const PlacedMesh& {
    const auto known = placed.find(part);
    return known != placed.end() ? known->second : placed.emplace(part, place(state, t, part)).first->second;
  };
  for (const OnPlane& on : planes_) {
    const ContactPlane& plane = model_->body().contact.planes[on.plane];
    if (!plane.acts_at(t) || (sleeps(state, on.part) && plane.point.is_constant())) continue;
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
    if (!model_->body().contact.obstacles[on.obstacle].acts_at(t) || sleeps(state, on.part)) continue;
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
  for (const Pair& pair : pairs_) {
    if (model_->lies_still(state, pair.a) && model_->lies_still(state, pair.b)) continue;
    touches.clear();
    const Around &ball_a = balls.at(pair.a), &ball_b = balls.at(pair.b);
    if ((ball_a.c - ball_b.c).norm() > ball_a.reach + ball_b.reach) continue;
    const PlacedMesh &a = mesh_of(pair.a), &b = mesh_of(pair.b);
    find_touches(a, b, touches);
    for (const MeshTouch& touch : touches) {
      Contact contact;
      contact.a = side(a, pair.a, state, touch.a, touch.x);
      contact.b = side(b, pair.b, state, touch.b, touch.x - touch.gap * touch.normal);
      contact.x = touch.x;
      contact.normal = touch.normal;
      contact.gap = touch.gap;
      contact.carried = carries(pair.b, t, touch.x) - carries(pair.a, t, touch.x);
      contact.friction = pair.rule.friction;
      contact.restitution = pair.rule.restitution;
      found.push_back(contact);
    }
  }
}

void MeshFinder::approach(const State& state, double t, double h, ContactFinder::Neighbourhood& near) const {
  struct Swept {
    Vec3<double> c;
    double speed, reach;  // of any point in the world, m/s; about c, with the way of a step, m
  };
  std::map<int, Swept> all;
  for (const auto& [part, mesh] : meshes_) {
    const PartModel& m = model_->parts()[at(part)];
    Swept swept{model_->position(state, part, t), 0, mesh.reach(*model_, state, part)};
    if (m.q0 >= 0) {
      const auto v = state.v.segment(m.v0, m.n_v());
      swept.speed = v.head<3>().norm() + swept.reach * v.segment<3>(3).norm() + mesh.speed(state);
      swept.reach += h * (swept.speed + model_->body().gravity_at(t).norm() * h);
    } else if (m.motion != nullptr) {
      for (const double when : {t, t + h}) {
        const MovingFrame frame = m.motion->at(when);
        swept.speed = std::max(swept.speed, frame.c_dot.norm() + swept.reach * frame.omega.norm());
      }
      swept.reach += h * swept.speed;
    }
    all.emplace(part, swept);
  }
  for (const OnPlane& on : planes_) {
    const ContactPlane& plane = model_->body().contact.planes[on.plane];
    if (!plane.acts_at(t) && !plane.acts_at(t + h)) continue;
    if (sleeps(state, on.part) && plane.point.is_constant()) continue;
    const Swept& a = all.at(on.part);
    for (const double when : {t, t + h})
      if (plane.normal.dot(a.c - plane.point.value(when)) < a.reach) near.empty = false;
  }
  for (const OnObstacle& on : on_obstacles_) {
    const ContactObstacle& obstacle = model_->body().contact.obstacles[on.obstacle];
    if ((!obstacle.acts_at(t) && !obstacle.acts_at(t + h)) || sleeps(state, on.part)) continue;
    const Swept& a = all.at(on.part);
    if (!on.mesh->comes_near(a.c, a.reach)) continue;
    near.empty = false;
    const double way = h * a.speed, thin = kStepShare * meshes_.at(on.part).thickness();
    if (way > thin) near.h = std::min(near.h, h * thin / way);
  }
  for (const Pair& pair : pairs_) {
    if (model_->lies_still(state, pair.a) && model_->lies_still(state, pair.b)) continue;
    const Swept &a = all.at(pair.a), &b = all.at(pair.b);
    if ((a.c - b.c).norm() > a.reach + b.reach) continue;
    near.empty = false;
    const double way = h * (a.speed + b.speed);
    const double thin = kThinStep * std::min(meshes_.at(pair.a).thickness(), meshes_.at(pair.b).thickness());
    if (way > thin) near.h = std::min(near.h, h * thin / way);
  }
}

}  // namespace pliant
