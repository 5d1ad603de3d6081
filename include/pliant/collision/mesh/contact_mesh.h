// The surface of a part as a closed triangle mesh, for contact of parts that deform locally: of such a part
// the mesh of its own nodes, of any other one a mesh laid over it.
#pragma once

#include <vector>

#include <pliant/body/model.h>

namespace pliant {

class ContactMesh {
 public:
  struct Edge {
    int from, to;     ///< vertices
    int left, right;  ///< triangles; in `left` it goes from `from` to `to`; right is -1 at a border
  };

  /// m: of a model that outlives it.
  explicit ContactMesh(const PartModel& m);

  const PartModel& part() const { return *part_; }
  const Eigen::Matrix3Xi& triangles() const { return triangles_; }
  const std::vector<Edge>& edges() const { return edges_; }
  /// The node of the part that a vertex is; -1 of a part that has none.
  int node(int vertex) const { return nodes_.empty() ? -1 : nodes_[static_cast<std::size_t>(vertex)]; }
  /// Of the vertices of a part that has no nodes.
  const std::vector<Material<double>>& material() const { return material_; }
  /// The least extent of the part at rest along the axes of its frame, m.
  double thickness() const { return thickness_; }
  /// Vertices in the body frame, m. number: of the part.
  Eigen::Matrix3Xd positions(const Model& model, const State& state, int number) const;
  /// Radius of a ball about the origin of the part's frame that it is in, m; of a part without nodes that
  /// changes estimated by few points.
  double reach(const Model& model, const State& state, int number) const;
  /// Whether that takes all vertices.
  bool reach_takes_all() const { return part_->local != nullptr; }
  /// No point of it moves faster against the frame of the part, m/s; estimated likewise.
  double speed(const State& state) const;

 private:
  const PartModel* part_;
  Eigen::Matrix3Xi triangles_;
  std::vector<Edge> edges_;
  std::vector<int> nodes_;
  std::vector<Material<double>> material_;
  std::vector<Material<double>> few_;  // of a part without nodes that changes: where it reaches the farthest
  Eigen::Matrix3Xd rigid_;             // vertices of a part that does not change, and how far they reach
  double rigid_reach_ = 0;
  mutable Eigen::Matrix3Xd last_;  // vertices of a part without nodes that changes, when they were last
  mutable VecX<double> last_q_s_;  // asked for, with these parameters
  Eigen::Matrix3Xd rest_;          // and of one that changes by local deformation alone, without it
  double thickness_;
};

/// The edges of a mesh of n vertices, in the order of its triangles.
std::vector<ContactMesh::Edge> mesh_edges(const Eigen::Matrix3Xi& triangles);

}  // namespace pliant
