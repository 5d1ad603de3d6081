// All bodies of a picture in one vertex buffer and one index buffer. A vertex of the batch is a pair
// (position, normal). If the triangles at a mesh vertex have different normals there, the batch has one pair
// for each normal, so that sharp edges stay sharp. For bodies coloured by values a second buffer contains the
// level of every vertex on the scale.
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
    int first = 0;  ///< first entry in the index buffer
    int count = 0;  ///< number of entries
  };

  explicit MeshBatch(const gl::Functions& gl);

  /// Sends the bodies of a frame to the buffers, with positions relative to the target of the camera. Bodies
  /// with the triangles of the previous frame keep their indices. Throws std::invalid_argument that names the
  /// body whose mesh is missing, inconsistent, not finite or farther than 1e15 m from the target, or that
  /// does not have one finite value for each vertex.
  void update(const Picture& picture);

  const std::vector<Range>& ranges() const { return ranges_; }              ///< one per body
  const std::vector<Eigen::AlignedBox3f>& boxes() const { return boxes_; }  ///< one per body with triangles
  int index_count() const { return index_count_; }
  /// Binds the arrays: attribute 0 is the position, 1 the normal.
  void bind() const { gl_.bind_vertex_array(array_.name()); }
  /// Binds the arrays and, in addition, attribute 2: the level of the value on the scale, from 0 to 1. The
  /// picture must have a scale.
  void bind_levels() const { gl_.bind_vertex_array(leveled_array_.name()); }

 private:
  struct Topology {
    Eigen::Matrix3Xi triangles, corners;
    std::vector<int> position, normal;   // columns of x and of normals in the mesh, one for each batch vertex
    std::vector<std::uint32_t> indices;  // indices of batch vertices, from 0 in each body
  };
  static Topology make_topology(const TriangleMesh& mesh, std::size_t body);
  void set_attributes(const gl::VertexArray& array) const;
  /// Checks the meshes and rebuilds the changed topologies. Returns the number of batch vertices.
  std::size_t update_topologies(const std::vector<Picture::Body>& bodies);
  void upload_indices();
  void upload_vertices(const Picture& picture, std::size_t pairs);
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
