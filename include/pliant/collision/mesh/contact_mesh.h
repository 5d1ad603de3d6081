// The surface of a part as a closed triangle mesh, for contact of parts that deform locally. The mesh of such
// a part consists of its own surface nodes. Any other part gets a mesh of points of its surface.
#pragma once

#include <vector>

#include <pliant/body/model.h>

namespace pliant {

class ContactMesh {
 public:
  struct Edge {
    int from, to;     ///< vertices
    int left, right;  ///< triangles; `left` has the edge in the order from, to; right is -1 at a border
  };

  /// m: part of a model that outlives this object. cell: largest extent of cells in flat regions of a
  /// part without nodes, m (sparse_surface()); not used for a part with nodes.
  ContactMesh(const PartModel& m, double cell);

  const PartModel& part() const { return *part_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  const std::vector<Edge>& edges() const { return edges_; }
  /// Returns the node of the part at a vertex; -1 for a part without nodes.
  int node(int vertex) const { return nodes_.empty() ? -1 : nodes_[static_cast<std::size_t>(vertex)]; }
  /// Material points of the vertices of a part without nodes.
  const std::vector<Material<double>>& material() const { return material_; }
  /// The least extent of the part at rest along the axes of its frame, m.
  double thickness() const { return thickness_; }
  /// Mean length of the edges at rest, m.
  double mean_edge() const { return mean_edge_; }
  /// Computes the vertices: one column for each, body frame, m. number: number of the part.
  Eigen::Matrix3Xd positions(const Model& model, const State& state, int number) const;
  /// Radius of a ball about the origin of the part's frame that contains the part, m. For a part without
  /// nodes and with dynamic parameters the radius is estimated from few points.
  double reach(const Model& model, const State& state, int number) const;
  /// Whether reach() evaluates all vertices.
  bool reach_uses_all_vertices() const { return part_->local != nullptr; }
  /// Largest speed of a point of the part relative to its frame, m/s. It is estimated from the points that
  /// reach() uses.
  double speed(const State& state) const;

 private:
  const PartModel* part_;
  Eigen::Matrix3Xi triangles_;
  std::vector<Edge> edges_;
  std::vector<int> nodes_;
  std::vector<Material<double>> material_;
  std::vector<Material<double>>
      coarse_;              // points for reach() of a part without nodes, with dynamic parameters
  Eigen::Matrix3Xd rigid_;  // vertices of a part of constant shape
  double rigid_reach_ = 0;  // largest distance of a vertex in rigid_ from the origin of the frame, m
  // For a part without nodes and with dynamic parameters: the result of the last call of positions(), and q_s
  // of that call.
  mutable Eigen::Matrix3Xd last_;
  mutable VecX<double> last_q_s_;
  Eigen::Matrix3Xd
      rest_;  // vertices at d = 0 of a part with local deformation and without dynamic parameters
  double thickness_, mean_edge_ = 0;
};

/// Returns the edges of a mesh, in the order of its triangles (columns of vertex numbers).
std::vector<ContactMesh::Edge> mesh_edges(const Eigen::Matrix3Xi& triangles);

}  // namespace pliant
