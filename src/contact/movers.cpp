#include <pliant/contact/movers.h>

#include <algorithm>

#include <pliant/body/group.h>
#include <pliant/contact/node_motion.h>

namespace pliant {

namespace {
std::size_t at(int i) {
  return static_cast<std::size_t>(i);
}
}  // namespace

Movers::Movers(const Model& model)
    : model_(&model), of_parts_(model.parts().size(), -1), of_nodes_(model.parts().size()) {}

int Movers::add(Mover mover, int size) {
  mover.first = n_x_;
  mover.size = size;
  n_x_ += size;
  all_.push_back(mover);
  return static_cast<int>(all_.size()) - 1;
}

int Movers::of_part(int part) {
  int& number = of_parts_[at(part)];
  if (number >= 0) return number;
  const PartModel& m = model_->parts()[at(part)];
  if (m.island < 0) return number = add({part, -1, nullptr}, m.n_x());
  const Island& island = model_->islands()[at(m.island)];
  const int added = add({-1, -1, &island}, island.n_v);
  for (const int other : island.parts) of_parts_[at(other)] = added;
  return added;
}

int Movers::of_node(int part, int node) {
  std::vector<int>& numbers = of_nodes_[at(part)];
  if (numbers.empty()) numbers.resize(model_->parts()[at(part)].local->mesh().nodes.size(), -1);
  int& number = numbers[at(node)];
  if (number < 0) number = add({part, node, nullptr}, 3);
  return number;
}

int Movers::first_in(const Mover& mover, int part) {
  if (mover.island == nullptr) return 0;
  const auto& parts = mover.island->parts;
  return mover.island
      ->first[at(static_cast<int>(std::find(parts.begin(), parts.end(), part) - parts.begin()))];
}

VecX<double> Movers::velocities(const State& state, const Workspace<double>& work) const {
  VecX<double> x(n_x_);
  for (const Mover& mover : all_) {
    if (mover.node >= 0) continue;
    auto take = [&](int part, int first) {
      const PartModel& m = model_->parts()[at(part)];
      take_velocity(m, work.parts[at(part)], state.v, x.segment(mover.first + first, m.n_x()));
    };
    if (mover.island == nullptr) {
      take(mover.part, 0);
      continue;
    }
    for (std::size_t i = 0; i < mover.island->parts.size(); ++i)
      take(mover.island->parts[i], mover.island->first[i]);
  }
  std::vector<int> nodes, firsts;
  Eigen::Matrix3Xd x_dot;
  for (std::size_t part = 0; part < of_nodes_.size(); ++part) {
    nodes.clear();
    firsts.clear();
    for (std::size_t i = 0; i < of_nodes_[part].size(); ++i)
      if (const int number = of_nodes_[part][i]; number >= 0) {
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
