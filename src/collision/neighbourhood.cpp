// What a step comes near to, by balls about the parts and their way.
#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/body/multibody.h>
#include <pliant/math/index.h>

#include "finder_scratch.h"

namespace pliant {

namespace {

/// Most that a part may turn in a step over a plane, rad.
constexpr double kMostTurn = 0.5;
/// Ways that are so many times as long as they may be do not take a step back.
constexpr double kLittleMore = 1.125;

/// A bound of the speed at which parameters change a part of a radius (m), m/s; and of any point of it
/// against its frame's origin.
double speed_of_shape(const PartModel& m, const State& state, double reach) {
  return reach * state.v.segment(m.v0 + 6, m.n_s).lpNorm<1>() / m.part->size();
}
double speed_about(const PartModel& m, const State& state, double reach) {
  return reach * state.v.segment<3>(m.v0 + 3).norm() + speed_of_shape(m, state, reach);
}

}  // namespace

void ContactFinder::Neighbourhood::keep_within(double way, double gained, double most, double whole,
                                               bool taken) {
  const double little_more = kLittleMore * most;
  spare = std::min(spare, 0.5 * (little_more - std::min(way + gained, most)));
  if (!(way + gained > (taken ? little_more : most))) return;
  // In a share x of the step they go way x + gained x^2.
  h = std::min(h, whole * 2 * most / (way + std::sqrt(way * way + 4 * gained * most)));
}

void ContactFinder::place_ball(const State& state, const State* after, double t, double h, double reach,
                               int i) const {
  const PartModel& m = model_->parts()[at(i)];
  place(state, t, i);
  Scratch::Ball& ball = scratch_->balls[at(i)];
  // A parameter may be larger than at rest: the ball is about where the surface is.
  ball = {scratch_->parts[at(i)].c,    Vec3<double>::Zero(), Vec3<double>::Zero(), 0, 0,
          scratch_->parts[at(i)].reach};
  if (m.motion != nullptr) {
    const TimeVector::Passage passage = m.motion->over(t, h, ball.reach);
    ball.c_dot = passage.rate;
    ball.speed = passage.beside;
  }
  double spare = 0;
  if (m.q0 >= 0) {
    const Vec3<double> gravity = model_->body().gravity_at(t);
    ball.c_dot = state.v.segment<3>(m.v0);
    ball.speed = speed_about(m, state, ball.reach);
    if (after != nullptr) {
      ball.c_dot_gained = (after->q.segment<3>(m.q0) - state.q.segment<3>(m.q0)) / h - ball.c_dot;
      ball.gained = std::max(0.0, speed_about(m, *after, ball.reach) - ball.speed);
    } else if (!sleeps(state, i)) {
      ball.c_dot_gained = reach * h * gravity;
      spare = h * gravity.norm();
    }
  }
  ball.reach += h * (ball.fastest() + spare);
}

/// How fast any point of a part moves as it is seen from the frame of another, m/s, and how much faster it
/// may become as that frame turns, both at the rates of now, m/s^2: of what lies on a body and turns with it
/// little is left. Neither's motion is prescribed.
std::pair<double, double> ContactFinder::speed_seen(const State& state, int part, int from) const {
  struct Motion {
    Vec3<double> c_dot, omega;
    double of_shape;
  };
  auto motion_of = [&](int i) -> Motion {
    const PartModel& m = model_->parts()[at(i)];
    const Placed& there = scratch_->parts[at(i)];
    if (m.q0 < 0) return {Vec3<double>::Zero(), Vec3<double>::Zero(), 0};
    return {state.v.segment<3>(m.v0), there.R * state.v.segment<3>(m.v0 + 3),
            speed_of_shape(m, state, there.reach)};
  };
  const Motion a = motion_of(part), b = motion_of(from);
  const Placed &at_a = scratch_->parts[at(part)], &at_b = scratch_->parts[at(from)];
  const Vec3<double> against = a.c_dot - b.c_dot;
  return {(against - b.omega.cross(at_a.c - at_b.c)).norm() + (a.omega - b.omega).norm() * at_a.reach +
              a.of_shape + b.of_shape,
          b.omega.cross(against).norm()};
}

/// How far at least the ball of a part is from the box of another, m.
double ContactFinder::clearance(int ball, int box) const {
  const Placed &a = scratch_->parts[at(ball)], &b = scratch_->parts[at(box)];
  const double bulge = kBulge * model_->parts()[at(box)].part->size();
  return std::max(0.0, body_box(box).exteriorDistance(b.R.transpose() * (a.c - b.c)) - a.reach - bulge);
}

ContactFinder::Neighbourhood ContactFinder::neighbourhood(const State& state, double t, double h,
                                                          double reach) const {
  return neighbourhood(state, nullptr, t, h, reach);
}

ContactFinder::Neighbourhood ContactFinder::neighbourhood_of(const State& state, const State& after, double t,
                                                             double h, double reach,
                                                             const Neighbourhood& foreseen) const {
  const Vec3<double> fall = reach * h * h * model_->body().gravity_at(t);
  double further = 0;
  for (const int i : smooth_) {
    const PartModel& m = model_->parts()[at(i)];
    if (m.q0 < 0 || sleeps(state, i)) continue;
    const double about = scratch_->parts[at(i)].reach;
    const Vec3<double> way = after.q.segment<3>(m.q0) - state.q.segment<3>(m.q0);
    further =
        std::max(further, (way - h * state.v.segment<3>(m.v0) - fall).norm() +
                              h * std::max(0.0, speed_about(m, after, about) - speed_about(m, state, about)));
  }
  return further > foreseen.spare ? neighbourhood(state, &after, t, h, reach) : foreseen;
}

ContactFinder::Neighbourhood ContactFinder::neighbourhood(const State& state, const State* after, double t,
                                                          double h, double reach) const {
  Neighbourhood near;
  near.h = h;
  near.spare = h * h * model_->body().gravity_at(t).norm();
  Scratch& s = *scratch_;
  s.balls.resize(model_->parts().size());
  const bool taken = after != nullptr;
  double fastest = 0, thinnest = std::numeric_limits<double>::infinity();
  for (const int i : smooth_) {
    place_ball(state, after, t, h, reach, i);
    thinnest = std::min(thinnest, surfaces_[at(i)]->thickness());
    fastest = std::max(fastest, s.balls[at(i)].fastest());
  }
  const auto& planes = model_->body().contact.planes;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (!(planes[k].acts_before(t) || planes[k].acts_before(t + h))) continue;
    const double highest = planes[k].highest(t, h), beside = planes[k].point.over(t, h).beside;
    for (const int i : smooth_) {
      const Scratch::Ball& ball = s.balls[at(i)];
      if (sleeps(state, i) && planes[k].point.is_constant()) continue;
      if (!on_planes_[at(i) * planes.size() + k].touch ||
          !(planes[k].normal.dot(ball.c) - highest < ball.reach))
        continue;
      near.empty = false;
      // None is thin, but what spins may come round with its other end, and a plane may go to and fro.
      near.keep_within(h * (ball.speed + beside), h * ball.gained, kMostTurn * s.parts[at(i)].reach, h,
                       taken);
    }
  }
  const auto& obstacles = model_->body().contact.obstacles;
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    if (!(obstacles[k].acts_before(t) || obstacles[k].acts_before(t + h))) continue;
    for (const int i : smooth_) {
      if (sleeps(state, i)) continue;
      const Scratch::Ball& ball = s.balls[at(i)];
      const double way = h * (ball.c_dot.norm() + ball.speed),
                   gained = h * (ball.c_dot_gained.norm() + ball.gained),
                   thin = kThinShare * surfaces_[at(i)]->thickness();
      const bool changes = near.empty || way + gained > thin;
      if (changes && (!on_obstacles_[at(i) * obstacles.size() + k].touch ||
                      !obstacles_[k].comes_near(ball.c, ball.reach)))
        continue;
      near.empty = false;
      near.keep_within(way, gained, thin, h, taken);
    }
  }
  if (!any_pairs_) return near;
  if (!near.empty && 2 * h * fastest <= kThinShare * thinnest) {  // pairs would change nothing
    near.keep_within(2 * h * fastest, 0, kThinShare * thinnest, h, taken);
    return near;
  }
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
    const double thin = kThinShare * std::min(surfaces_[at(i)]->thickness(), surfaces_[at(j)]->thickness());
    double most = thin;
    const double gained = h * ((a.c_dot_gained - b.c_dot_gained).norm() + a.gained + b.gained);
    double way = h * ((a.c_dot - b.c_dot).norm() + a.speed + b.speed), bent = 0;
    if (way + gained > most) {
      most += std::max(clearance(i, j), clearance(j, i));
      const bool prescribed =
          model_->parts()[at(i)].motion != nullptr || model_->parts()[at(j)].motion != nullptr;
      const auto [speed, curvature] =
          s.parts[at(i)].reach < s.parts[at(j)].reach ? speed_seen(state, i, j) : speed_seen(state, j, i);
      if (!prescribed && h * (speed + 0.5 * h * curvature) < way) {
        way = h * speed;
        bent = 0.5 * h * h * curvature;
      }
    }
    // What is between them is not to be overshot by more than what is thin.
    const double eased = most + (kLittleMore - 1) * thin, whole = way + gained + bent;
    near.keep_within(way, gained + bent, taken ? eased / kLittleMore : most, h, taken);
    near.spare = std::min(near.spare, 0.5 * (eased - std::min(whole, most)));
  }
  return near;
}

}  // namespace pliant
