// Storage of the local coordinates q_d of a part with a mesh, Eq. (6). The vector contains the x
// displacements of all nodes, then all y, then all z displacements. Then follow the own coordinates of the
// energies, for example the edge rotations of bending. Positions and forces of nodes are also stored in this
// order.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// Vectors at nodes, one row for each node.
using Nodes = Eigen::Matrix<double, Eigen::Dynamic, 3>;

/// Local coordinates or their rates, by reference: a contiguous column of numbers that is not copied.
using Coordinates = Eigen::Ref<const VecX<double>>;

/// Views the first 3 n_nodes entries of local coordinates as one row for each node.
inline Eigen::Map<const Nodes> nodes(const Coordinates& q_d, Eigen::Index n_nodes) {
  return {q_d.data(), n_nodes, 3};
}
inline Eigen::Map<Nodes> nodes(VecX<double>& q_d, Eigen::Index n_nodes) {
  return {q_d.data(), n_nodes, 3};
}

}  // namespace pliant
