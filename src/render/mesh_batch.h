// All bodies of a picture in one vertex and one index buffer. A vertex is a pair (position, normal): where
// several corners of a mesh vertex carry different normals it appears once for each, so sharp edges stay
// sharp. Where a body is coloured by values, a second buffer holds the level of every vertex on the scale.
#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/render/picture.h>

#include "render/gl/gl_objects.h"

namespace pliant {

class MeshBatch {
 public:
  struct Range {
    int first = 0;  ///< index
    int count = 0;  ///< indices
  };

  explicit MeshBatch(const gl::Functions& gl);

  /// Takes the bodies of a frame; the camera's target is subtracted from their places. Bodies with the
  /// triangles of the frame before keep their indices. Throws std::invalid_argument naming the body whose
  /// mesh is missing, inconsistent, not finite or farther than 1e15 m from origin, or whose values are not
  /// one a vertex, finite.
  void update(const Picture& picture);

  const std::vector<Range>& ranges() const { return ranges_; }              ///< one a body
  const std::vector<Eigen::AlignedBox3f>& boxes() const { return boxes_; }  ///< one a body that has triangles
  int index_count() const { return index_count_; }
  /// Attribute 0 is the position, 1 the normal.
  void bind() const { gl_.bind_vertex_array(array_.name()); }
  /// And 2 the level of the value on the picture's scale, which it must have.
  void bind_levels() const { gl_.bind_vertex_array(leveled_array_.name()); }

 private:
  struct Topology {
    Eigen::Matrix3Xi triangles, corners;
    std::vector<int> position, normal;   // columns of the mesh, one a batch vertex
    std::vector<std::uint32_t> indices;  // of batch vertices, from 0 in each body
  };
  static Topology make_topology(const TriangleMesh& mesh, std::size_t body);
  void lay_attributes(const gl::VertexArray& array) const;
  void upload_indices();
  void upload_levels(const Picture& picture);

  const gl::Functions& gl_;
  gl::VertexArray array_, leveled_array_;
  gl::Buffer vertices_, indices_, levels_;
  std::vector<Topology> topologies_;
  std::vector<Range> ranges_;
  std::vector<Eigen::AlignedBox3f> boxes_;
  std::vector<float> scratch_;
  int index_count_ = 0;
};

}  // namespace pliant
