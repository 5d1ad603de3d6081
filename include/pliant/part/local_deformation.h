// The local deformation of a part, d = S q_d: displacements of the nodes of a mesh of its material domain in
// the part's frame, with their masses and elastic energies. Rigid motion and changes of the global parameters
// could be written in d as well; reference conditions take that out (design 1.3):
//   W^T d = 0,   W_k = m_k G0_k(q_s),   G0 = [I, -[s]x, J]
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include <pliant/local/nodal_energy.h>
#include <pliant/shape/material.h>

namespace pliant {

class Part;

/// A mesh of the material domain of a part.
struct LocalMesh {
  std::vector<Material<double>> nodes;
  Nodes X;                     ///< where they are at rest, body frame, m
  Eigen::Matrix3Xi triangles;  ///< of the surface, counter-clockwise from outside
  Eigen::MatrixXi tetrahedra;  ///< 4 or 15 nodes a column, see Solid; none of a shell
  VecX<double> mass;           ///< of each node, kg
  double density = 0;          ///< kg/m^3; of a shell kg/m^2
  bool shell() const { return tetrahedra.cols() == 0; }
  /// A third of the area of the triangles at each node, m^2; 0 inside.
  VecX<double> areas() const;
};

/// How a part is to deform locally.
struct LocalSettings {
  int resolution = 8;  ///< edges along a quarter of a great circle, see Surface and Solid
  int order = 1;       ///< of the elements of a solid: 1 straight, 4 nodes; 2 curved, 15 nodes
  /// Lays an energy on the mesh (part/local_laws.h has those that scenes know).
  using Law = std::function<std::unique_ptr<NodalEnergy>(const LocalMesh&)>;
  std::vector<Law> energies;
  /// At time 0, from the place of a node at rest (body frame, m): m and m/s; none: zero.
  std::function<Vec3<double>(const Vec3<double>&)> displacement, velocity;
  double alpha = 0, beta = 0;  ///< D = alpha M + beta K of the nodes, 1/s and s
};

/// Where a material point is among the nodes: d = sum weight_i d_i.
struct NodeWeights {
  std::vector<int> node;
  std::vector<double> weight;
  friend bool operator==(const NodeWeights& a, const NodeWeights& b) {
    return a.node == b.node && a.weight == b.weight;
  }
};

class LocalDeformation {
 public:
  /// Throws std::invalid_argument when the mesh or an energy cannot be laid.
  LocalDeformation(const Part& part, const LocalSettings& settings);

  const LocalMesh& mesh() const { return mesh_; }
  Eigen::Index n_nodes() const { return mesh_.X.rows(); }
  /// Number of local coordinates: three a node, and those that energies have of their own.
  Eigen::Index n_d() const { return inertia_.size(); }
  /// Diagonal of the mass matrix of the local coordinates.
  const VecX<double>& inertia() const { return inertia_; }
  /// 1 / inertia.
  const VecX<double>& mobility() const { return mobility_; }
  const std::vector<Material<Pack>>& packs() const { return packs_; }
  const std::vector<std::unique_ptr<NodalEnergy>>& energies() const { return energies_; }
  /// Local coordinates and their rates at time 0; the reference conditions are not met yet.
  const VecX<double>& initial() const { return initial_; }
  const VecX<double>& initial_rate() const { return initial_rate_; }
  double alpha() const { return alpha_; }
  double beta() const { return beta_; }
  /// Of a material point; none where the local deformation does not reach, inside a shell.
  NodeWeights weights(const Part& part, const Material<double>& m) const;

 private:
  LocalMesh mesh_;
  std::vector<Material<Pack>> packs_;
  VecX<double> inertia_, mobility_, initial_, initial_rate_;
  std::vector<std::unique_ptr<NodalEnergy>> energies_;
  double alpha_, beta_;
};

}  // namespace pliant
