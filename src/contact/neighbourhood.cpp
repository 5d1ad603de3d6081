// What a step comes near to, by balls about the parts and their way.
#include <algorithm>
#include <limits>

#include <pliant/body/multibody.h>
#include <pliant/math/index.h>

#include "finder_scratch.h"

namespace pliant {

namespace {

/// Share of the thinner of two parts that they may move against each other in a step.
constexpr double kThinShare = 0.4;
/// Most that a part may turn in a step over a plane, rad.
constexpr double kMostTurn = 0.5;

}  // namespace

ContactFinder::Neighbourhood ContactFinder::neighbourhood(const State& state, double t, double h) const {
  Neighbourhood near;
  near.h = h;
  Scratch& s = *scratch_;
  s.balls.resize(model_->parts().size());
  const double free_fall = model_->body().gravity_at(t).norm() * h;
  double fastest = 0, thinnest = std::numeric_limits<double>::infinity();
  for (const int i : smooth_) {
    const PartModel& m = model_->parts()[at(i)];
    place(state, t, i);
    Scratch::Ball& ball = s.balls[at(i)];
    // A parameter may be larger than at rest: the ball is about where the surface is.
    ball = {s.parts[at(i)].c, Vec3<double>::Zero(), 0, s.parts[at(i)].reach};
    thinnest = std::min(thinnest, surfaces_[at(i)]->thickness());
    if (m.motion != nullptr) {
      const MovingFrame now = m.motion->at(t), then = m.motion->at(t + h);
      ball.c_dot = (then.c - now.c) / h;
      ball.speed = ball.reach * std::max(now.omega.norm(), then.omega.norm()) +
                   std::max((now.c_dot - ball.c_dot).norm(), (then.c_dot - ball.c_dot).norm());
      ball.reach += h * (ball.c_dot.norm() + ball.speed);
      fastest = std::max(fastest, ball.c_dot.norm() + ball.speed);
    }
    if (m.q0 < 0) continue;
    const auto v = state.v.segment(m.v0, m.n_v());
    ball.c_dot = v.head<3>();
    ball.speed = ball.reach * (v.segment<3>(3).norm() + v.tail(m.n_s).lpNorm<1>() / m.part->size());
    const double speed = ball.c_dot.norm() + ball.speed;
    ball.reach += h * (speed + (sleeps(state, i) ? 0 : free_fall));
    fastest = std::max(fastest, speed);
  }
  const auto& planes = model_->body().contact.planes;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (!(planes[k].acts_at(t) || planes[k].acts_at(t + h))) continue;
    for (const double when : {t, t + h}) {
      const Vec3<double> point = planes[k].point.value(when);
      for (const int i : smooth_) {
        const Scratch::Ball& ball = s.balls[at(i)];
        if (sleeps(state, i) && planes[k].point.is_constant()) continue;
        if (!on_planes_[at(i) * planes.size() + k].touch ||
            !(planes[k].normal.dot(ball.c - point) < ball.reach))
          continue;
        near.empty = false;
        // None is thin, but what spins may come round with its other end.
        if (const double turn = h * ball.speed / s.parts[at(i)].reach; turn > kMostTurn)
          near.h = std::min(near.h, h * kMostTurn / turn);
      }
    }
  }
  const auto& obstacles = model_->body().contact.obstacles;
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    if (!(obstacles[k].acts_at(t) || obstacles[k].acts_at(t + h))) continue;
    for (const int i : smooth_) {
      if (sleeps(state, i)) continue;
      const Scratch::Ball& ball = s.balls[at(i)];
      const double way = h * (ball.c_dot.norm() + ball.speed),
                   thin = kThinShare * surfaces_[at(i)]->thickness();
      if (!near.empty && way <= thin) continue;  // it would change nothing
      if (!on_obstacles_[at(i) * obstacles.size() + k].touch || !obstacles_[k].comes_near(ball.c, ball.reach))
        continue;
      near.empty = false;
      if (way > thin) near.h = std::min(near.h, h * thin / way);
    }
  }
  if (!any_pairs_) return near;
  if (!near.empty && 2 * h * fastest <= kThinShare * thinnest) return near;  // pairs would change nothing
  s.boxes.clear();
  for (const int i : smooth_) {
    const Scratch::Ball& ball = s.balls[at(i)];
    s.boxes.emplace_back(ball.c.array() - ball.reach, ball.c.array() + ball.reach);
  }
  s.tree.build(s.boxes);
  s.tree.near_pairs(0, s.pairs);
  for (const auto& [one, other] : s.pairs) {
    const int i = smooth_[at(one)], j = smooth_[at(other)];
    if (model_->lies_still(state, i) && model_->lies_still(state, j)) continue;
    if (!rules_.of_parts(i, j).touch) continue;
    const Scratch::Ball &a = s.balls[at(i)], &b = s.balls[at(j)];
    if ((a.c - b.c).norm() > a.reach + b.reach) continue;
    near.empty = false;
    const double way = h * ((a.c_dot - b.c_dot).norm() + a.speed + b.speed);
    const double thin = kThinShare * std::min(surfaces_[at(i)]->thickness(), surfaces_[at(j)]->thickness());
    if (way > thin) near.h = std::min(near.h, h * thin / way);
  }
  return near;
}

}  // namespace pliant
