// The pairs of position and normal (mesh_batch.h) are computed once, and again only if the triangles change.
// Each frame only collects the positions and normals of the pairs.
#include "mesh_batch.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <stdexcept>
#include <string>

namespace pliant {
namespace {

constexpr double kMaxVertexDistance = 1e15;  // metres
constexpr int kFloatsPerVertex = 6;

[[noreturn]] void fail(std::size_t body, const std::string& what) {
  throw std::invalid_argument("picture: body " + std::to_string(body) + " " + what);
}

bool same(const Eigen::Matrix3Xi& a, const Eigen::Matrix3Xi& b) {
  return a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), sizeof(int) * static_cast<std::size_t>(a.size())) == 0;
}

void check_range(const Eigen::Matrix3Xi& indices, Eigen::Index columns, std::size_t body, const char* what) {
  if (indices.size() > 0 && (indices.minCoeff() < 0 || indices.maxCoeff() >= columns))
    fail(body, std::string("has triangles with ") + what + " that do not exist: expected indices from 0 to " +
                   std::to_string(columns - 1));
}

}  // namespace

MeshBatch::MeshBatch(const gl::Functions& gl)
    : gl_(gl), array_(gl), leveled_array_(gl), vertices_(gl), indices_(gl), levels_(gl) {
  set_attributes(leveled_array_);
  gl_.bind_buffer(gl::kArrayBuffer, levels_.name());
  gl_.vertex_attrib_pointer(2, 1, gl::kFloat, 0, sizeof(float), nullptr);
  gl_.enable_vertex_attrib_array(2);
  set_attributes(array_);
  gl_.bind_vertex_array(0);
}

void MeshBatch::set_attributes(const gl::VertexArray& array) const {
  gl_.bind_vertex_array(array.name());
  gl_.bind_buffer(gl::kElementArrayBuffer, indices_.name());
  gl_.bind_buffer(gl::kArrayBuffer, vertices_.name());
  constexpr int kStride = kFloatsPerVertex * sizeof(float);
  gl_.vertex_attrib_pointer(0, 3, gl::kFloat, 0, kStride, nullptr);
  gl_.vertex_attrib_pointer(1, 3, gl::kFloat, 0, kStride, reinterpret_cast<const void*>(3 * sizeof(float)));
  gl_.enable_vertex_attrib_array(0);
  gl_.enable_vertex_attrib_array(1);
}

MeshBatch::Topology MeshBatch::make_topology(const TriangleMesh& mesh, std::size_t body) {
  if (mesh.triangles.cols() != mesh.corners.cols())
    fail(body, "must have one triple of normals for each triangle");
  check_range(mesh.triangles, mesh.x.cols(), body, "vertices");
  check_range(mesh.corners, mesh.normals.cols(), body, "normals");

  Topology topology{mesh.triangles, mesh.corners, {}, {}, {}};
  topology.indices.reserve(static_cast<std::size_t>(mesh.triangles.size()));
  // The pairs with one position form a linked list: first[position], then next[pair].
  std::vector<int> first(static_cast<std::size_t>(mesh.x.cols()), -1), next;
  for (Eigen::Index k = 0; k < mesh.triangles.size(); ++k) {
    const int position = mesh.triangles.data()[k], normal = mesh.corners.data()[k];
    int pair = first[position];
    while (pair >= 0 && topology.normal[pair] != normal) pair = next[pair];
    if (pair < 0) {
      pair = static_cast<int>(next.size());
      next.push_back(first[position]);
      first[position] = pair;
      topology.position.push_back(position);
      topology.normal.push_back(normal);
    }
    topology.indices.push_back(static_cast<std::uint32_t>(pair));
  }
  return topology;
}

void MeshBatch::upload_indices() {
  std::vector<std::uint32_t> all;
  std::uint32_t offset = 0;
  ranges_.clear();
  for (const Topology& topology : topologies_) {
    ranges_.push_back({static_cast<int>(all.size()), static_cast<int>(topology.indices.size())});
    for (const std::uint32_t index : topology.indices) all.push_back(offset + index);
    offset += static_cast<std::uint32_t>(topology.position.size());
  }
  if (all.size() > static_cast<std::size_t>(std::numeric_limits<int>::max() / kFloatsPerVertex))
    throw std::invalid_argument("picture: too many triangles");
  index_count_ = static_cast<int>(all.size());
  bind();
  gl_.buffer_data(gl::kElementArrayBuffer, static_cast<std::ptrdiff_t>(all.size() * sizeof all[0]),
                  all.data(), gl::kStaticDraw);
}

void MeshBatch::upload_levels(const Picture& picture) {
  scratch_.clear();
  for (std::size_t i = 0; i < picture.bodies.size(); ++i) {
    const std::vector<int>& position = topologies_[i].position;
    const VecX<double>* values = picture.bodies[i].values;
    if (values == nullptr) {
      scratch_.resize(scratch_.size() + position.size(), 0);
      continue;
    }
    if (values->size() != picture.bodies[i].mesh->x.cols() || !values->allFinite())
      fail(i, "must have one finite value for each vertex");
    const double low = picture.scale->low, span = picture.scale->high - low;
    for (const int vertex : position)
      scratch_.push_back(static_cast<float>(std::clamp(((*values)[vertex] - low) / span, 0.0, 1.0)));
  }
  gl_.bind_buffer(gl::kArrayBuffer, levels_.name());
  gl_.buffer_data(gl::kArrayBuffer, static_cast<std::ptrdiff_t>(scratch_.size() * sizeof(float)),
                  scratch_.data(), gl::kStreamDraw);
}

std::size_t MeshBatch::update_topologies(const std::vector<Picture::Body>& bodies) {
  bool changed = topologies_.size() != bodies.size();
  topologies_.resize(bodies.size());
  std::size_t pairs = 0;
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    if (!bodies[i].mesh) fail(i, "has no mesh");
    const TriangleMesh& mesh = *bodies[i].mesh;
    Topology& topology = topologies_[i];
    if (!same(topology.triangles, mesh.triangles) || !same(topology.corners, mesh.corners)) {
      topology = {};  // if the next line throws, later frames must not use the old topology
      topology = make_topology(mesh, i);
      changed = true;
    } else if (!topology.position.empty()) {
      check_range(mesh.triangles, mesh.x.cols(), i, "vertices");
      check_range(mesh.corners, mesh.normals.cols(), i, "normals");
    }
    pairs += topology.position.size();
  }
  if (changed) {
    ranges_.clear();
    upload_indices();
  }
  return pairs;
}

void MeshBatch::upload_vertices(const Picture& picture, std::size_t pairs) {
  const std::vector<Picture::Body>& bodies = picture.bodies;
  boxes_.clear();
  scratch_.resize(pairs * kFloatsPerVertex);
  float* out = scratch_.data();
  for (std::size_t i = 0; i < bodies.size(); ++i) {
    const TriangleMesh& mesh = *bodies[i].mesh;
    const Topology& topology = topologies_[i];
    if (topology.position.empty()) continue;
    Eigen::AlignedBox3f box;
    bool good = true;
    for (std::size_t k = 0; k < topology.position.size(); ++k, out += kFloatsPerVertex) {
      const Eigen::Vector3d p = mesh.x.col(topology.position[k]) - picture.camera.target,
                            n = mesh.normals.col(topology.normal[k]);
      // Each comparison is negated, so that NaN fails.
      good = good && !(!(p.cwiseAbs().maxCoeff() <= kMaxVertexDistance) || !(n.cwiseAbs().maxCoeff() <= 2) ||
                       p.hasNaN() || n.hasNaN());
      if (!good) break;
      const Eigen::Vector3f single = p.cast<float>();
      Eigen::Map<Eigen::Vector3f>(out, 3) = single;
      Eigen::Map<Eigen::Vector3f>(out + 3, 3) = n.cast<float>();
      box.extend(single);
    }
    if (!good)
      fail(i,
           "is not finite, has normals that are not unit vectors or is farther than 1e15 m from the target");
    boxes_.push_back(box);
  }
  gl_.bind_buffer(gl::kArrayBuffer, vertices_.name());
  gl_.buffer_data(gl::kArrayBuffer, static_cast<std::ptrdiff_t>(scratch_.size() * sizeof(float)),
                  scratch_.data(), gl::kStreamDraw);
}

void MeshBatch::update(const Picture& picture) {
  const std::size_t pairs = update_topologies(picture.bodies);
  upload_vertices(picture, pairs);
  if (picture.scale) upload_levels(picture);
}

}  // namespace pliant
