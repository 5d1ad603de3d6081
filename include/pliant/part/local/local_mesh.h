// A mesh of the material domain of a part, laid at the rest shape: of the surface of a shell, of the body of
// a solid.
#pragma once

#include <vector>

#include <pliant/local/nodes.h>
#include <pliant/shape/material.h>

namespace pliant {

class Part;
struct LocalSettings;

struct LocalMesh {
  std::vector<Material<double>> nodes;
  Nodes X;                     ///< where they are at rest, body frame, m
  Eigen::Matrix3Xi triangles;  ///< of the surface, counter-clockwise from outside
  Eigen::MatrixXi tetrahedra;  ///< 4, 10 or 15 nodes a column, see Solid; none of a shell
  VecX<double> mass;           ///< of each node, kg
  double density = 0;          ///< kg/m^3; of a shell kg/m^2
  bool shell() const { return tetrahedra.cols() == 0; }
  /// A third of the area of the triangles at each node, m^2; 0 inside.
  VecX<double> areas() const;
};

/// Its masses have the mass, the centre and the second moments of the part. Throws LocalFault where none that
/// are positive do.
LocalMesh make_local_mesh(const Part& part, const LocalSettings& settings);

/// Where a material point is among nodes: d = sum weight_i d_i.
struct NodeWeights {
  std::vector<int> node;
  std::vector<double> weight;
  friend bool operator==(const NodeWeights& a, const NodeWeights& b) {
    return a.node == b.node && a.weight == b.weight;
  }
};

/// Of a material point among the nodes of a mesh; none inside a shell.
NodeWeights mesh_weights(const Part& part, const LocalMesh& mesh, const Material<double>& m);

}  // namespace pliant
