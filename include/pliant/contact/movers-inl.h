// Function bodies of movers.h: numbers of movers, and their velocities.
#pragma once

#include <pliant/contact/movers.h>

#include <algorithm>

#include <pliant/body/constraint/group.h>
#include <pliant/collision/mesh/node_motion.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

PLIANT_INLINE bool moves_locally(const PartModel& m, const PartWorkspace<double>& w) {
  return m.local != nullptr && (m.local->modal() != nullptr || (w.local && w.local->response != nullptr));
}

PLIANT_INLINE bool moves_by_nodes(const PartModel& m, const PartWorkspace<double>& w) {
  return m.local != nullptr && !moves_locally(m, w);
}

PLIANT_INLINE Movers::Movers(const Model& model, const Workspace<double>& work)
    : model_(&model), part_movers_(model.parts().size(), -1) {
  n_local_.reserve(model.parts().size());
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const PartModel& m = model.parts()[i];
    n_local_.push_back(moves_locally(m, work.parts[i]) ? static_cast<int>(m.n_d()) : 0);
  }
}

PLIANT_INLINE int Movers::add(Mover mover, int size) {
  mover.first = n_x_;
  mover.size = size;
  n_x_ += size;
  all_.push_back(mover);
  return static_cast<int>(all_.size()) - 1;
}

PLIANT_INLINE int Movers::mover_of_part(int part) {
  int& number = part_movers_[at(part)];
  if (number >= 0) return number;
  const PartModel& m = model_->parts()[at(part)];
  if (m.island < 0) return number = add({part, -1, nullptr}, m.n_x() + n_local(part));
  const Island& island = model_->islands()[at(m.island)];
  int size = island.n_v;
  for (const int other : island.parts) size += n_local(other);
  const int added = add({-1, -1, &island}, size);
  for (const int other : island.parts) part_movers_[at(other)] = added;
  return added;
}

PLIANT_INLINE int Movers::mover_of_node(int part, int node) {
  node_movers_.resize(model_->parts().size());
  std::vector<int>& numbers = node_movers_[at(part)];
  if (numbers.empty()) numbers.resize(model_->parts()[at(part)].local->mesh().nodes.size(), -1);
  int& number = numbers[at(node)];
  if (number < 0) number = add({part, node, nullptr}, 3);
  return number;
}

PLIANT_INLINE int Movers::first_in(const Mover& mover, int part) {
  if (mover.island == nullptr) return 0;
  const auto& parts = mover.island->parts;
  return mover.island
      ->first[at(static_cast<int>(std::find(parts.begin(), parts.end(), part) - parts.begin()))];
}

PLIANT_INLINE int Movers::first_local(const Mover& mover, int part) const {
  if (mover.island == nullptr) return model_->parts()[at(part)].n_x();
  int first = mover.island->n_v;
  for (const int other : mover.island->parts) {
    if (other == part) break;
    first += n_local(other);
  }
  return first;
}

PLIANT_INLINE VecX<double> Movers::velocities(const State& state, const Workspace<double>& work) const {
  VecX<double> x(n_x_);
  for (const Mover& mover : all_) {
    if (mover.node >= 0) continue;
    auto gather = [&](int part, int first) {
      const PartModel& m = model_->parts()[at(part)];
      gather_velocity(m, work.parts[at(part)], state.v, x.segment(mover.first + first, m.n_x()));
      if (const int n = n_local(part); n > 0)
        x.segment(mover.first + first_local(mover, part), n) = state.v.segment(m.v0 + 6 + m.n_s, n);
    };
    if (mover.island == nullptr) {
      gather(mover.part, 0);
      continue;
    }
    for (std::size_t i = 0; i < mover.island->parts.size(); ++i)
      gather(mover.island->parts[i], mover.island->first[i]);
  }
  std::vector<int> nodes, firsts;
  Eigen::Matrix3Xd x_dot;
  for (std::size_t part = 0; part < node_movers_.size(); ++part) {
    nodes.clear();
    firsts.clear();
    for (std::size_t i = 0; i < node_movers_[part].size(); ++i)
      if (const int number = node_movers_[part][i]; number >= 0) {
        nodes.push_back(static_cast<int>(i));
        firsts.push_back(all_[at(number)].first);
      }
    if (nodes.empty()) continue;
    node_velocities(*model_, state, static_cast<int>(part), nodes, x_dot);
    for (std::size_t i = 0; i < nodes.size(); ++i)
      x.segment<3>(firsts[i]) = x_dot.col(static_cast<Eigen::Index>(i));
  }
  return x;
}

}  // namespace pliant
