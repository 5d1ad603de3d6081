// Function bodies of clusters.h, and of the functions of Simulation that join the counters of clusters.
// Clusters::advance() lists the stages of an interval.
#pragma once

#include <pliant/simulate/clusters.h>

#include <algorithm>
#include <cmath>
#include <map>

#include <pliant/body/speed_scale.h>
#include <pliant/contact/contact_pairs.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/simulate/partial_state.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

namespace clusters {

/// Largest number of simulations that are kept for clusters with the same first part.
inline constexpr std::size_t kMaxKept = 4;
/// A simulation that is not used is kept for this number of intervals, or up to twice as many.
inline constexpr long kKeptFor = 64;
/// A time is regarded as the end of an interval if its distance from the end is below this share of the
/// interval.
inline constexpr double kAtEnd = 1e-9;

/// Least travel of a part in an interval, in radii of the ball that contains the part. Bodies with smaller
/// gaps step together, so that they can rest on each other.
inline constexpr double kMinTravel = 1e-5;

/// Returns an estimate of the distance that a point of a part moves relative to the origin of its frame in h
/// seconds, m: by the angular velocity, and by the rates of the parameters.
inline double turn(const PartModel& m, const VecX<double>& v, double h, double radius) {
  return h * (radius * v.segment<3>(m.v0 + 3).norm() + shape_speed(m, v.segment(m.v0, 6 + m.n_s), radius));
}

/// Returns a box around a ball, m.
inline Eigen::AlignedBox3d ball_box(const Vec3<double>& centre, double radius) {
  return {centre.array() - radius, centre.array() + radius};
}

}  // namespace clusters

PLIANT_INLINE Clusters::Clusters(Simulation& whole)
    : whole_(whole),
      kept_(whole.model_.parts().size()),
      connected_(whole.model_.connected_parts()),
      sets_(connected_),
      boxes_(whole.model_.parts().size()),
      travel_(whole.model_.parts().size()),
      turned_(whole.model_.parts().size()),
      cluster_of_(whole.model_.parts().size()) {
  find_anchors();
}

PLIANT_INLINE Clusters::~Clusters() = default;

/// Finds the parts without coordinates that joints or loads connect with moving parts.
PLIANT_INLINE void Clusters::find_anchors() {
  const Model& model = whole_.model_;
  auto add = [&](int one, int other) {
    if (one < 0 || other < 0) return;
    const bool moves = model.parts()[at(one)].q0 >= 0, other_moves = model.parts()[at(other)].q0 >= 0;
    if (moves && !other_moves) anchors_.emplace_back(one, other);
    if (other_moves && !moves) anchors_.emplace_back(other, one);
  };
  for (const JointModel& joint : model.joints())
    for (const PortRef& ref : joint.at) add(joint.sides.front().part, ref.part);
  for (const auto& [one, other] : model.load_connections()) add(one, other);
}

PLIANT_INLINE double Clusters::end_of_interval(double t) const {
  const double interval = whole_.model_.body().contact.interval;
  return interval * (std::floor(t / interval + clusters::kAtEnd) + 1);
}

PLIANT_INLINE void Clusters::advance(double end) {
  if (++intervals_ % clusters::kKeptFor == 0) drop_unused();
  const double t = whole_.time();
  whole_.contact_->wake_driven(t, end - t, whole_.state_);
  predict_travel(end);  // 1 predict where each part can be
  sets_ = connected_;
  clusters_.clear();
  for (bool left = true; left;) {
    join_parts_that_meet();  // 2 join the parts that can meet
    divide();
    left = false;
    for (Cluster& cluster : clusters_)  // 3 simulate; a part may travel farther than predicted
      if (!cluster.done) left = simulate(cluster, end) || left;
  }
  commit(end);  // 4 join the states of the clusters
}

/// Predicts the travel of each part until `end` (s), with gravity as the only force.
PLIANT_INLINE void Clusters::predict_travel(double end) {
  const Model& model = whole_.model_;
  const State& state = whole_.state_;
  const double t = state.time(), h = end - t;
  const Vec3<double> fall = 0.5 * h * h * model.body().gravity_at(t);
  for (std::size_t i = 0; i < boxes_.size(); ++i) {
    const PartModel& m = model.parts()[i];
    const int part = static_cast<int>(i);
    const double radius = whole_.contact_->finder().reach(state, part);
    const Vec3<double> c = model.position(state, part);
    Vec3<double> shift = Vec3<double>::Zero();
    double spare = clusters::kMinTravel * radius;
    travel_[i] = 0;
    if (m.q0 >= 0 && !sleeps(state, part)) {
      shift = h * state.v.segment<3>(m.v0) + fall;
      spare += fall.norm();
      travel_[i] = clusters::turn(m, state.v, h, radius);
    } else if (m.motion != nullptr) {
      const TimeVector::MeanRate mean = m.motion->over(t, h, radius);
      shift = h * mean.rate;
      spare += h * mean.max_deviation;
    }
    travel_[i] += shift.norm() + spare;
    boxes_[i] = clusters::ball_box(c, radius + spare).merged(clusters::ball_box(c + shift, radius + spare));
  }
}

/// Joins the sets of parts that can meet, and of parts that sleep together. A sleeping part in a set with an
/// awake part may wake and reach other parts. The search is therefore repeated until no set grows.
PLIANT_INLINE void Clusters::join_parts_that_meet() {
  const State& state = whole_.state_;
  reached_ = anchors_;
  std::map<double, int> sleepers;
  for (int i = 0; i < static_cast<int>(state.at_rest.size()); ++i)
    if (sleeps(state, i)) sets_.unite(i, sleepers.emplace(state.at_rest[at(i)], i).first->second);
  for (const CachedContact& cached : state.contact_cache)
    if (cached.between[1] >= 0) join(cached.between[0], cached.between[1]);
  tree_.build(boxes_);
  tree_.near_pairs(0, pairs_);
  mark_awake();
  for (bool grown = true; grown;) {
    grown = false;
    for (const auto& [i, j] : pairs_)
      if (can_meet(i, j)) grown = join(i, j) || grown;
    if (sleepers.empty()) break;  // all moving parts are awake
    mark_awake();
  }
}

/// Marks the sets with a part that is awake.
PLIANT_INLINE void Clusters::mark_awake() {
  awake_.assign(boxes_.size(), false);
  for (int i = 0; i < static_cast<int>(boxes_.size()); ++i)
    if (whole_.model_.parts()[at(i)].q0 >= 0 && !sleeps(whole_.state_, i)) awake_[at(sets_.root(i))] = true;
}

/// Joins two parts that can meet. If one of the parts cannot move, records that the other part can reach it.
/// Returns whether two sets have become one.
PLIANT_INLINE bool Clusters::join(int i, int j) {
  auto moves = [&](int part) { return whole_.model_.parts()[at(part)].q0 >= 0; };
  if (moves(i) && moves(j)) {
    const bool apart = sets_.root(i) != sets_.root(j);
    sets_.unite(i, j);
    return apart;
  }
  if (moves(i) || moves(j)) reached_.emplace_back(moves(i) ? i : j, moves(i) ? j : i);
  return false;
}

/// Returns whether two parts whose boxes meet can touch in this interval: whether their gap at the start of
/// the interval is smaller than the sum of their travels.
PLIANT_INLINE bool Clusters::can_meet(int i, int j) {
  const std::vector<PartModel>& parts = whole_.model_.parts();
  const ContactFinder& finder = whole_.contact_->finder();
  auto moves = [&](int part) { return parts[at(part)].q0 >= 0; };
  auto is_still = [&](int part) {
    return moves(part) ? !awake_[at(sets_.root(part))] : parts[at(part)].motion == nullptr;
  };
  if (!(moves(i) || moves(j)) || (is_still(i) && is_still(j))) return false;
  if (moves(i) && moves(j) && sets_.root(i) == sets_.root(j)) return false;  // already in one set
  if (!finder.may_touch(i, j)) return false;
  Contact pair;
  pair.a.part = i;
  pair.b.part = j;
  const double travel = travel_[at(i)] + travel_[at(j)];
  return finder.min_gap(whole_.state_, whole_.time(), pair, travel) < travel;
}

/// Makes a cluster of each set with an awake part. A cluster whose parts have not changed keeps its
/// simulation.
PLIANT_INLINE void Clusters::divide() {
  const Model& model = whole_.model_;
  const State& state = whole_.state_;
  clusters_.clear();
  std::fill(cluster_of_.begin(), cluster_of_.end(), -1);
  const int n = static_cast<int>(boxes_.size());
  auto moves = [&](int i) { return model.parts()[at(i)].q0 >= 0; };
  for (int i = 0; i < n; ++i) {
    int& number = cluster_of_[at(sets_.root(i))];
    if (!moves(i) || sleeps(state, i) || number >= 0) continue;
    number = static_cast<int>(clusters_.size());
    clusters_.emplace_back();
  }
  for (int i = 0; i < n; ++i)
    if (const int number = cluster_of_[at(sets_.root(i))]; moves(i) && number >= 0)
      clusters_[at(number)].parts.push_back(i);
  for (const auto& [part, immobile] : reached_)
    if (const int number = cluster_of_[at(sets_.root(part))]; number >= 0)
      clusters_[at(number)].parts.push_back(immobile);
  for (Cluster& cluster : clusters_) {
    const int first = cluster.parts.front();
    std::sort(cluster.parts.begin(), cluster.parts.end());
    cluster.parts.erase(std::unique(cluster.parts.begin(), cluster.parts.end()), cluster.parts.end());
    Kept& found = kept(first, cluster.parts);
    cluster.simulation = found.simulation.get();
    cluster.done = std::exchange(found.last_use, intervals_) == intervals_;
  }
}

/// Returns the simulation of a set of parts, whose first part with coordinates is `first`. For a new set,
/// makes a simulation; if kMaxKept simulations are already kept, it replaces the least recently used one.
PLIANT_INLINE Clusters::Kept& Clusters::kept(int first, const std::vector<int>& parts) {
  std::vector<Kept>& all = kept_[at(first)];
  for (Kept& one : all)
    if (one.parts == parts) return one;
  if (all.size() == clusters::kMaxKept)
    all.erase(std::min_element(all.begin(), all.end(),
                               [](const Kept& a, const Kept& b) { return a.last_use < b.last_use; }));
  all.push_back({parts, std::unique_ptr<Simulation>(new Simulation(whole_, parts)), 0});
  return all.back();
}

/// Drops the simulations that were not used for a while.
PLIANT_INLINE void Clusters::drop_unused() {
  for (std::vector<Kept>& all : kept_)
    all.erase(std::remove_if(all.begin(), all.end(),
                             [&](const Kept& one) { return one.last_use < intervals_ - clusters::kKeptFor; }),
              all.end());
}

/// Simulates a cluster to the end of the interval. Returns whether a part has travelled farther than
/// predicted.
PLIANT_INLINE bool Clusters::simulate(Cluster& cluster, double end) {
  Simulation& of = *cluster.simulation;
  extract_state(whole_.model_, whole_.state_, of.model_, of.state_);
  of.interval_ = whole_.interval_;
  of.forget_counters();  // an earlier result of this simulation may not have been used
  for (const int part : cluster.parts) turned_[at(part)] = 0;
  cluster.done = true;
  bool farther = false;
  while (of.time() < end) {
    of.begin_step();
    of.controlled_step(end);
    of.record_contact_errors();
    of.record_without_inertia();
    farther = include_path(of, of.last_good_, of.time() - of.last_good_.time()) || farther;
  }
  return farther;
}

/// Extends the boxes and travels of the parts of a cluster by their paths in a step of h seconds. before: the
/// state at the start of the step. Returns whether a box or a travel has grown.
PLIANT_INLINE bool Clusters::include_path(const Simulation& of, const State& before, double h) {
  const Model& model = of.model_;
  const State& after = of.state_;
  bool grown = false;
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel &m = model.parts()[i], &in_whole = whole_.model_.parts()[at(model.part_numbers()[i])];
    if (m.q0 < 0) continue;
    const int part = static_cast<int>(i);
    const auto number = at(model.part_numbers()[i]);
    const double radius =
        std::max(of.contact_->finder().reach(before, part), of.contact_->finder().reach(after, part));
    // A path with one impact stays between the tangents at its ends.
    const Vec3<double> c = before.q.segment<3>(m.q0), c_after = after.q.segment<3>(m.q0),
                       start = whole_.state_.q.segment<3>(in_whole.q0);
    Eigen::AlignedBox3d path = clusters::ball_box(c, radius);
    double shift = 0;
    for (const Vec3<double>& place : {c_after, Vec3<double>(c + h * before.v.segment<3>(m.v0)),
                                      Vec3<double>(c_after - h * after.v.segment<3>(m.v0))}) {
      path.extend(clusters::ball_box(place, radius));
      shift = std::max(shift, (place - start).norm());
    }
    turned_[number] +=
        std::max(clusters::turn(m, before.v, h, radius), clusters::turn(m, after.v, h, radius));
    const double travel = shift + turned_[number];
    if (boxes_[number].contains(path) && travel <= travel_[number]) continue;
    boxes_[number].extend(path);
    travel_[number] = std::max(travel_[number], travel);
    grown = true;
  }
  return grown;
}

/// Joins the states, records and counters of the clusters.
PLIANT_INLINE void Clusters::commit(double end) {
  const Model& model = whole_.model_;
  State& state = whole_.state_;
  auto stepped = [&](int part) { return part >= 0 && cluster_of_[at(sets_.root(part))] >= 0; };
  state.contact_cache.erase(std::remove_if(state.contact_cache.begin(), state.contact_cache.end(),
                                           [&](const CachedContact& cached) {
                                             return stepped(cached.between[0]) || stepped(cached.between[1]);
                                           }),
                            state.contact_cache.end());
  for (const Cluster& cluster : clusters_) {
    Simulation& of = *cluster.simulation;
    insert_state(of.model_, of.state_, model, state);
    whole_.contact_->absorb(*of.contact_);
    whole_.absorb(of);
  }
  std::stable_sort(state.contact_cache.begin(), state.contact_cache.end(), ByPair{});
  state.error = state.contact_residual = state.contact_cache_age = 0;
  for (const StepMemory& memory : state.step_memory) {
    state.error = std::max(state.error, memory.error);
    state.contact_residual = std::max(state.contact_residual, memory.contact_residual);
    state.contact_cache_age = std::max(state.contact_cache_age, memory.contact_cache_age);
  }
  state.start = end;
  state.step = 0;
  state.h = model.body().contact.interval;
}

PLIANT_INLINE void Simulation::forget_counters() {
  step_counters_ = {};
  forget_evaluations();
}

/// Sets the numbers of evaluations in the workspace to zero.
PLIANT_INLINE void Simulation::forget_evaluations() {
  for (PartWorkspace<double>& w : work_.parts) w.counters = {};
  for (RigidWorkspace& w : work_.rigid) w.counters = {};
  output_counters_ = {};
}

/// Adds the counters of a cluster, and records the velocities without inertia of its parts.
PLIANT_INLINE void Simulation::absorb(Simulation& cluster) {
  step_counters_ += cluster.step_counters_;
  absorbed_counters_ += cluster.counters();
  if (!slow_progress_) slow_progress_ = cluster.slow_progress_;
  cluster.forget_counters();
  for (std::size_t i = 0; i < cluster.work_.without_inertia.size(); ++i) {
    if (cluster.work_.without_inertia[i] == 0) continue;
    const PartModel &from = cluster.model_.parts()[i],
                    &to = model_.parts()[static_cast<std::size_t>(cluster.model_.part_numbers()[i])];
    for (int k = 0; k < 6 + from.n_s; ++k)
      if (cluster.without_inertia_[static_cast<std::size_t>(from.v0 + k)])
        without_inertia_[static_cast<std::size_t>(to.v0 + k)] = true;
  }
}

PLIANT_INLINE std::vector<std::vector<int>> Clusters::parts() const {
  std::vector<std::vector<int>> parts;
  for (const Cluster& cluster : clusters_) parts.push_back(cluster.parts);
  return parts;
}

}  // namespace pliant
