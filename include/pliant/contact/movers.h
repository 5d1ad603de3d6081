// What contacts push and moves as one: a part alone, or the parts that joints tie together, with its
// velocities as in body/group.h. Parts that deform at the nodes of a mesh have lumped masses: what pushes a
// node moves that node alone, and every node is a mover of its own, with its velocity in the world.
#pragma once

#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

struct Mover {
  int part = -1;                   ///< a part alone
  int node = -1;                   ///< or this node of it
  const Island* island = nullptr;  ///< or this
  int first = 0, size = 0;         ///< of its velocities among those of all movers
};

/// Some movers of a model, numbered as they are asked for.
class Movers {
 public:
  /// The model must outlive it.
  explicit Movers(const Model& model);

  /// The number of what a part moves with, or of a node.
  int of_part(int part);
  int of_node(int part, int node);

  int n_x() const { return n_x_; }
  const std::vector<Mover>& all() const { return all_; }
  const Mover& operator[](int i) const { return all_[static_cast<std::size_t>(i)]; }
  /// Where the velocities of a part begin in those of its mover.
  static int first_in(const Mover& mover, int part);
  /// Velocities of all movers. state: its coordinates may be those of an earlier time than those of work.
  VecX<double> velocities(const State& state, const Workspace<double>& work) const;

 private:
  int add(Mover mover, int size);

  const Model* model_;
  std::vector<Mover> all_;
  int n_x_ = 0;
  std::vector<int> of_parts_;               // number of each part; -1: not there yet
  std::vector<std::vector<int>> of_nodes_;  // the same of the nodes of each part that deforms at them
};

}  // namespace pliant
