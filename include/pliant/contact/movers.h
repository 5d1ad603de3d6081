// What contacts push and moves as one: a part alone, or the parts that joints tie together, with its
// velocities as in body/group.h, and after these the rates of the local coordinates of those that a push
// moves in all of them: parts that deform by modes, and those whose elasticity is stepped implicitly. Other
// parts that deform at the nodes of a mesh have lumped masses: what pushes a node moves that node alone, and
// every node is a mover of its own, with its velocity in the world.
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

/// Whether what pushes a part moves all of its local coordinates; or nodes of it, each by itself.
bool moves_locally(const PartModel& m, const PartWorkspace<double>& w);
bool moves_by_nodes(const PartModel& m, const PartWorkspace<double>& w);

/// Some movers of a model, numbered as they are asked for.
class Movers {
 public:
  /// The model must outlive it. work: tells how parts answer to pushes (LocalWorkspace::response).
  Movers(const Model& model, const Workspace<double>& work);

  /// The number of what a part moves with, or of a node.
  int of_part(int part);
  int of_node(int part, int node);

  int n_x() const { return n_x_; }
  const std::vector<Mover>& all() const { return all_; }
  const Mover& operator[](int i) const { return all_[static_cast<std::size_t>(i)]; }
  /// Where the velocities of a part begin in those of its mover.
  static int first_in(const Mover& mover, int part);
  /// The same of the rates of its local coordinates, where they are among these; and how many they are.
  int first_local(const Mover& mover, int part) const;
  int n_local(int part) const { return n_local_[static_cast<std::size_t>(part)]; }
  /// Velocities of all movers. state: its coordinates may be those of an earlier time than those of work.
  VecX<double> velocities(const State& state, const Workspace<double>& work) const;

 private:
  int add(Mover mover, int size);

  const Model* model_;
  std::vector<Mover> all_;
  int n_x_ = 0;
  std::vector<int> n_local_;                // of each part
  std::vector<int> of_parts_;               // number of each part; -1: not there yet
  std::vector<std::vector<int>> of_nodes_;  // the same of the nodes of each part that deforms at them
};

}  // namespace pliant
