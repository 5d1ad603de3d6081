// A mesh of the material domain of a part at rest: the surface of a shell, or the body of a solid.
// The NodeWeights of a material point give its rows of the shape matrix S of d = S q_d, Eq. (5).
#pragma once

#include <vector>

#include <pliant/local/nodes.h>
#include <pliant/shape/material.h>

namespace pliant {

class Part;
struct LocalSettings;

struct LocalMesh {
  std::vector<Material<double>> nodes;
  Nodes X;                     ///< positions of the nodes at rest, body frame, m
  Eigen::Matrix3Xi triangles;  ///< of the surface, counter-clockwise seen from outside
  Eigen::MatrixXi tetrahedra;  ///< one element (4, 10 or 15 nodes) per column, see Solid; none for a shell
  VecX<double> mass;           ///< lumped mass of each node, kg
  double density = 0;          ///< kg/m^3 of a solid, kg/m^2 of a shell
  bool shell() const { return tetrahedra.cols() == 0; }
  /// Returns a third of the area of the triangles around each node at rest, m^2; 0 for a node inside the
  /// body.
  VecX<double> areas() const;
};

/// Returns the mesh. Its nodal masses are lumped masses, changed by the smallest relative amounts that give
/// them the mass, the centre and the second moments of the part. Throws LocalFault if no changes give these
/// moments or if a changed mass is not positive, and std::invalid_argument as Surface and Solid do.
LocalMesh make_local_mesh(const Part& part, const LocalSettings& settings);

/// The weights of nodes at a material point: the displacement there is d = sum weight_i d_i.
struct NodeWeights {
  std::vector<int> node;
  std::vector<double> weight;
  friend bool operator==(const NodeWeights& a, const NodeWeights& b) {
    return a.node == b.node && a.weight == b.weight;
  }
};

/// Returns the weights of a material point over the nodes of a mesh; empty for a point inside a shell.
NodeWeights mesh_weights(const Part& part, const LocalMesh& mesh, const Material<double>& m);

}  // namespace pliant
