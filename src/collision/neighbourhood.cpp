// The neighbourhood of a step. Each part is enclosed in a ball that includes its motion in the step. Parts
// whose balls meet may touch, and their relative motion limits the step.
#include <algorithm>
#include <cmath>
#include <limits>

#include <pliant/body/multibody.h>
#include <pliant/body/speed_scale.h>
#include <pliant/math/index.h>

#include "finder_scratch.h"

namespace pliant {

namespace {

/// Largest rotation of a part over a plane in a step, rad. The points of the part may move by this angle
/// times the reach of the part.
constexpr double kMaxTurnOverPlane = 0.5;
/// A step that is done is kept if no motion is larger than its limit times this factor.
constexpr double kToleratedTravel = 1.125;

/// Estimates the largest speed of a point of a part relative to the origin of its frame, m/s. reach: radius
/// of a ball about the origin that contains the part, m.
double speed_about_origin(const PartModel& m, const State& state, double reach) {
  const auto v = state.v.segment(m.v0, 6 + m.n_s);
  return reach * v.segment<3>(3).norm() + shape_speed(m, v, reach);
}

}  // namespace

void ContactFinder::Neighbourhood::limit_travel(double travel, double change, double max_travel, double whole,
                                                bool done) {
  const double tolerated = kToleratedTravel * max_travel;
  spare = std::min(spare, 0.5 * (tolerated - std::min(travel + change, max_travel)));
  if (!(travel + change > (done ? tolerated : max_travel))) return;
  // In a share x of the step the sides move by travel x + change x^2.
  h = std::min(h, whole * 2 * max_travel / (travel + std::sqrt(travel * travel + 4 * change * max_travel)));
}

void ContactFinder::place_ball(const State& state, const State* after, double t, double h, double reach,
                               int i) const {
  const PartModel& m = model_->parts()[at(i)];
  place(state, t, i);
  Scratch::Ball& ball = scratch_->balls[at(i)];
  // The radius is the reach of the current shape, which may be larger than the rest shape.
  ball = {scratch_->parts[at(i)].c,    Vec3<double>::Zero(), Vec3<double>::Zero(), 0, 0,
          scratch_->parts[at(i)].reach};
  if (m.motion != nullptr) {
    const TimeVector::MeanRate mean = m.motion->over(t, h, ball.reach);
    ball.c_dot = mean.rate;
    ball.speed = mean.max_deviation;
  }
  double spare = 0;
  if (m.q0 >= 0) {
    const Vec3<double> gravity = model_->body().gravity_at(t);
    ball.c_dot = state.v.segment<3>(m.v0);
    ball.speed = speed_about_origin(m, state, ball.reach);
    if (after != nullptr) {
      ball.c_dot_change = (after->q.segment<3>(m.q0) - state.q.segment<3>(m.q0)) / h - ball.c_dot;
      ball.speed_change = std::max(0.0, speed_about_origin(m, *after, ball.reach) - ball.speed);
    } else if (!sleeps(state, i)) {
      ball.c_dot_change = reach * h * gravity;
      spare = h * gravity.norm();
    }
  }
  ball.reach += h * (ball.fastest() + spare);
}

/// Returns two bounds at the current velocities. The first is the speed of a part in the rotating frame of
/// another part, `from`, m/s. The second is the rate at which the rotation of that frame increases this
/// speed, m/s^2. Both are small for a part that rests on a turning part. Neither motion may be prescribed.
std::pair<double, double> ContactFinder::relative_speed(const State& state, int part, int from) const {
  struct Motion {
    Vec3<double> c_dot, omega;
    double of_shape;
  };
  auto motion_of = [&](int i) -> Motion {
    const PartModel& m = model_->parts()[at(i)];
    const Placed& there = scratch_->parts[at(i)];
    if (m.q0 < 0) return {Vec3<double>::Zero(), Vec3<double>::Zero(), 0};
    return {state.v.segment<3>(m.v0), there.R * state.v.segment<3>(m.v0 + 3),
            shape_speed(m, state.v.segment(m.v0, 6 + m.n_s), there.reach)};
  };
  const Motion a = motion_of(part), b = motion_of(from);
  const Placed &at_a = scratch_->parts[at(part)], &at_b = scratch_->parts[at(from)];
  const Vec3<double> against = a.c_dot - b.c_dot;
  return {(against - b.omega.cross(at_a.c - at_b.c)).norm() + (a.omega - b.omega).norm() * at_a.reach +
              a.of_shape + b.of_shape,
          b.omega.cross(against).norm()};
}

/// Returns a lower bound of the distance between two parts, m: the distance between the ball of one part and
/// the box of the other; 0 if they overlap. ball, box: the numbers of these parts.
double ContactFinder::clearance(int ball, int box) const {
  const Placed &a = scratch_->parts[at(ball)], &b = scratch_->parts[at(box)];
  const double bulge = kBulge * model_->parts()[at(box)].size;
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
  for (const int i : smooth_parts_) {
    const PartModel& m = model_->parts()[at(i)];
    if (m.q0 < 0 || sleeps(state, i)) continue;
    const double about = scratch_->parts[at(i)].reach;
    const Vec3<double> travel = after.q.segment<3>(m.q0) - state.q.segment<3>(m.q0);
    further = std::max(further, (travel - h * state.v.segment<3>(m.v0) - fall).norm() +
                                    h * std::max(0.0, speed_about_origin(m, after, about) -
                                                          speed_about_origin(m, state, about)));
  }
  return further > foreseen.spare ? neighbourhood(state, &after, t, h, reach) : foreseen;
}

// This function is longer than 60 lines, because planes, obstacles and pairs update one result in this order.
// The search of pairs is skipped if no pair can change that result.
ContactFinder::Neighbourhood ContactFinder::neighbourhood(const State& state, const State* after, double t,
                                                          double h, double reach) const {
  Neighbourhood near;
  near.h = h;
  near.spare = h * h * model_->body().gravity_at(t).norm();
  Scratch& s = *scratch_;
  s.balls.resize(model_->parts().size());
  const bool done = after != nullptr;
  double fastest = 0, thinnest = std::numeric_limits<double>::infinity();
  for (const int i : smooth_parts_) {
    place_ball(state, after, t, h, reach, i);
    thinnest = std::min(thinnest, surfaces_[at(i)]->thickness());
    fastest = std::max(fastest, s.balls[at(i)].fastest());
  }
  const auto& planes = model_->body().contact.planes;
  for (std::size_t k = 0; k < planes.size(); ++k) {
    if (!(planes[k].acts_before(t) || planes[k].acts_before(t + h))) continue;
    const double highest = planes[k].highest(t, h), max_deviation = planes[k].point.over(t, h).max_deviation;
    for (const int i : smooth_parts_) {
      const Scratch::Ball& ball = s.balls[at(i)];
      if (sleeps(state, i) && planes[k].point.is_constant()) continue;
      if (!on_planes_[at(i) * planes.size() + k].touch ||
          !(planes[k].normal.dot(ball.c) - highest < ball.reach))
        continue;
      near.empty = false;
      // No part can pass through a half space. But a spinning part may turn its other end below the plane,
      // and a plane may oscillate.
      near.limit_travel(h * (ball.speed + max_deviation), h * ball.speed_change,
                        kMaxTurnOverPlane * s.parts[at(i)].reach, h, done);
    }
  }
  const auto& obstacles = model_->body().contact.obstacles;
  for (std::size_t k = 0; k < obstacles.size(); ++k) {
    if (!(obstacles[k].acts_before(t) || obstacles[k].acts_before(t + h))) continue;
    for (const int i : smooth_parts_) {
      if (sleeps(state, i)) continue;
      const Scratch::Ball& ball = s.balls[at(i)];
      const double travel = h * (ball.c_dot.norm() + ball.speed),
                   change = h * (ball.c_dot_change.norm() + ball.speed_change),
                   allowed_travel = kMaxTravelShare * surfaces_[at(i)]->thickness();
      const bool changes = near.empty || travel + change > allowed_travel;
      if (changes && (!on_obstacles_[at(i) * obstacles.size() + k].touch ||
                      !(*obstacles_)[k].is_within(ball.c, ball.reach)))
        continue;
      near.empty = false;
      near.limit_travel(travel, change, allowed_travel, h, done);
    }
  }
  if (!has_pairs_) return near;
  if (!near.empty && 2 * h * fastest <= kMaxTravelShare * thinnest) {  // pairs cannot change the result
    near.limit_travel(2 * h * fastest, 0, kMaxTravelShare * thinnest, h, done);
    return near;
  }
  s.boxes.clear();
  for (const int i : smooth_parts_) {
    const Scratch::Ball& ball = s.balls[at(i)];
    s.boxes.emplace_back(ball.c.array() - ball.reach, ball.c.array() + ball.reach);
  }
  s.tree.build(s.boxes);
  s.tree.near_pairs(0, s.pairs);
  for (const auto& [one, other] : s.pairs) {
    const int i = smooth_parts_[at(one)], j = smooth_parts_[at(other)];
    if (model_->is_motionless(state, i) && model_->is_motionless(state, j)) continue;
    if (!rule_of(i, j).touch) continue;
    const Scratch::Ball &a = s.balls[at(i)], &b = s.balls[at(j)];
    if ((a.c - b.c).norm() > a.reach + b.reach) continue;
    near.empty = false;
    const double allowed_travel =
        kMaxTravelShare * std::min(surfaces_[at(i)]->thickness(), surfaces_[at(j)]->thickness());
    double max_travel = allowed_travel;
    const double change = h * ((a.c_dot_change - b.c_dot_change).norm() + a.speed_change + b.speed_change);
    double travel = h * ((a.c_dot - b.c_dot).norm() + a.speed + b.speed), turning = 0;
    if (travel + change > max_travel) {
      max_travel += std::max(clearance(i, j), clearance(j, i));
      const bool prescribed =
          model_->parts()[at(i)].motion != nullptr || model_->parts()[at(j)].motion != nullptr;
      const auto [speed, curvature] = s.parts[at(i)].reach < s.parts[at(j)].reach
                                          ? relative_speed(state, i, j)
                                          : relative_speed(state, j, i);
      if (!prescribed && h * (speed + 0.5 * h * curvature) < travel) {
        travel = h * speed;
        turning = 0.5 * h * h * curvature;
      }
    }
    // The limit max_travel includes the free distance between the parts. The tolerance is a share of the
    // thickness of the thinner part alone.
    const double tolerated = max_travel + (kToleratedTravel - 1) * allowed_travel,
                 whole = travel + change + turning;
    near.limit_travel(travel, change + turning, done ? tolerated / kToleratedTravel : max_travel, h, done);
    near.spare = std::min(near.spare, 0.5 * (tolerated - std::min(whole, max_travel)));
  }
  return near;
}

}  // namespace pliant
