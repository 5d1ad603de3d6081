// Movers: groups of velocities that contact impulses change together. A mover is
// - a part without joints, or an island (parts that joints connect), with the velocities of
//   body/constraint/group.h. If an impulse moves all local coordinates of a part (deformation by modes, or
//   implicit elasticity), the mover also has the rates of these coordinates, after its other velocities;
// - a node of any other part that deforms locally. Its mass is lumped, so an impulse on a node moves this
//   node only. Its velocity is in the world frame.
#pragma once

#include <vector>

#include <pliant/body/dynamics.h>

namespace pliant {

struct Mover {
  int part = -1;                   ///< number of the part without joints, or of the part of the node
  int node = -1;                   ///< number of the node; -1: not a node
  const Island* island = nullptr;  ///< the island; nullptr: not an island
  int first = 0, size = 0;         ///< index and number of its velocities in the vector of all movers

  /// A range of numbers of parts.
  struct Parts {
    const int *first, *last;
    const int* begin() const { return first; }
    const int* end() const { return last; }
  };
  /// Returns the parts of the mover. Valid as long as the mover and its island exist.
  Parts parts() const {
    if (island == nullptr) return {&part, &part + 1};
    return {island->parts.data(), island->parts.data() + island->parts.size()};
  }
};

/// Returns whether an impulse on a part moves all of its local coordinates.
bool moves_locally(const PartModel& m, const PartWorkspace<double>& w);
/// Returns whether an impulse on a part moves single nodes.
bool moves_by_nodes(const PartModel& m, const PartWorkspace<double>& w);

/// The movers that some contacts need, numbered in the order in which they are requested.
class Movers {
 public:
  /// The model must outlive this object. work: determines how parts respond to impulses
  /// (LocalWorkspace::response).
  Movers(const Model& model, const Workspace<double>& work);

  /// Returns the number of the mover of a part, or of a node; adds the mover if it is new.
  int mover_of_part(int part);
  int mover_of_node(int part, int node);

  int n_x() const { return n_x_; }
  const std::vector<Mover>& all() const { return all_; }
  const Mover& operator[](int i) const { return all_[static_cast<std::size_t>(i)]; }
  /// Returns the index of the first velocity of a part in its mover.
  static int first_in(const Mover& mover, int part);
  /// Returns the index of the first rate of the local coordinates of a part in its mover. Valid if n_local(),
  /// the number of local coordinates that belong to the mover, is not zero.
  int first_local(const Mover& mover, int part) const;
  int n_local(int part) const { return n_local_[static_cast<std::size_t>(part)]; }
  /// Returns the velocities of all movers, n_x() numbers. work: the evaluation of their parts, which may
  /// belong to a later state than `state`.
  VecX<double> velocities(const State& state, const Workspace<double>& work) const;

 private:
  int add(Mover mover, int size);

  const Model* model_;
  std::vector<Mover> all_;
  int n_x_ = 0;
  std::vector<int> n_local_;      // of each part
  std::vector<int> part_movers_;  // number of the mover of each part; -1: not requested yet
  /// Number of the mover of each node of each part; empty if no node has a mover.
  std::vector<std::vector<int>> node_movers_;
};

}  // namespace pliant
