// Local coordinates of a part with a mesh, q_d: the displacements of its nodes, d of all nodes along x, then
// along y, then along z; after them what some energies have of their own (rotations of edges, say). Positions
// of nodes, and forces on them, stand in the same order.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// One row a node.
using Nodes = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Local coordinates, or their rates, wherever they stand: a column of numbers, of which no copy is made.
using Coordinates = Eigen::Ref<const VecX<double>>;

/// The first 3 n_nodes entries of local coordinates as nodes.
inline Eigen::Map<const Nodes> nodes(const Coordinates& q_d, Eigen::Index n_nodes) {
  return {q_d.data(), n_nodes, 3};
}
inline Eigen::Map<Nodes> nodes(VecX<double>& q_d, Eigen::Index n_nodes) {
  return {q_d.data(), n_nodes, 3};
}

}  // namespace pliant
