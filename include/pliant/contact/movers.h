// Movers: the units that contacts push. A mover is a part without joints, or an island of parts that joints
// connect, with its velocities as in body/constraint/group.h, followed by the rates of local coordinates that
// one impulse changes all at once (parts with modes, and parts whose elasticity is implicit). Other parts
// with nodes have lumped masses: an impulse on a node moves that node alone, so that every node is a mover of
// its own, with its velocity in the world.
#pragma once

#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

struct Mover {
  int part = -1;                   ///< a part without joints
  int node = -1;                   ///< or a node of the part
  const Island* island = nullptr;  ///< or an island
  int first = 0, size = 0;         ///< first and number of its velocities among those of all movers
};

/// Return whether an impulse moves all local coordinates of a part, or single nodes.
bool moves_locally(const PartModel& m, const PartWorkspace<double>& w);
bool moves_by_nodes(const PartModel& m, const PartWorkspace<double>& w);

/// The movers of a problem, numbered in the order of their first use.
class Movers {
 public:
  /// The model must outlive the object. work: has the responses of parts to impulses
  /// (LocalWorkspace::response).
  Movers(const Model& model, const Workspace<double>& work);

  /// Returns the number of the mover of a part, or of a node.
  int of_part(int part);
  int of_node(int part, int node);

  int n_x() const { return n_x_; }
  const std::vector<Mover>& all() const { return all_; }
  const Mover& operator[](int i) const { return all_[static_cast<std::size_t>(i)]; }
  /// Returns the first velocity of a part in those of its mover.
  static int first_in(const Mover& mover, int part);
  /// Return the first rate of its local coordinates in those of its mover, and their number.
  int first_local(const Mover& mover, int part) const;
  int n_local(int part) const { return n_local_[static_cast<std::size_t>(part)]; }
  /// Returns the velocities of all movers. The state may be earlier than the evaluation in work.
  VecX<double> velocities(const State& state, const Workspace<double>& work) const;

 private:
  int add(Mover mover, int size);

  const Model* model_;
  std::vector<Mover> all_;
  int n_x_ = 0;
  std::vector<int> n_local_;                // by part
  std::vector<int> of_parts_;               // number of the mover of each part; -1: none yet
  std::vector<std::vector<int>> of_nodes_;  // number of the mover of each node
};

}  // namespace pliant
