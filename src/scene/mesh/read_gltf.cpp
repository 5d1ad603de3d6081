#include "read_gltf.h"

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include <Eigen/Geometry>

#include "binary_number.h"
#include "gltf_buffers.h"
#include "gltf_json.h"
#include "words.h"

namespace pliant {

namespace gltf {

namespace {

/// The two parts of a glTF file: JSON text and binary data.
struct Parts {
  std::string json, binary;
};

/// Returns the chunks of a GLB file: a header of 12 bytes, then chunks with their length and type.
Parts split_glb(const MeshBytes& file) {
  constexpr std::uint32_t json_type = 0x4e4f534a, binary_type = 0x004e4942;
  const std::string& bytes = file.bytes;
  if (bytes.size() < 12 || bytes.compare(0, 4, "glTF") != 0)
    fail_at_byte(file, 0, "other bytes", "glTF, the first bytes of a GLB file");
  Parts parts;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::size_t length = binary_number<std::uint32_t>(bytes.data() + at);
    const auto type = binary_number<std::uint32_t>(bytes.data() + at + 4);
    if (length > bytes.size() - at - 8)
      fail_at_byte(file, at, "a chunk of " + std::to_string(length) + " bytes",
                   "at most " + std::to_string(bytes.size() - at - 8) + ", the rest of the file");
    if (type == json_type && parts.json.empty()) parts.json = bytes.substr(at + 8, length);
    if (type == binary_type && parts.binary.empty()) parts.binary = bytes.substr(at + 8, length);
    at += 8 + length;
  }
  if (parts.json.empty()) fail_at_byte(file, 12, "no JSON chunk", "a JSON chunk");
  return parts;
}

/// Returns the transformation of a node, relative to its parent.
Eigen::Affine3d transformation(const Value& node) {
  const auto numbers = [&](const char* key, std::size_t n, auto fallback) {
    const Value list = node[key];
    if (!list.exists()) return fallback;
    if (list.size() != n) list.fail(std::to_string(list.size()) + " numbers", std::to_string(n) + " numbers");
    for (std::size_t k = 0; k < n; ++k) fallback(static_cast<Eigen::Index>(k)) = list[k].number();
    return fallback;
  };
  if (node["matrix"].exists()) {  // column by column
    const Eigen::Matrix<double, 16, 1> m = numbers("matrix", 16, Eigen::Matrix<double, 16, 1>::Zero().eval());
    Eigen::Affine3d place;
    place.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
    if (place.matrix().row(3) != Eigen::RowVector4d(0, 0, 0, 1))
      node["matrix"].fail("a last row that is not 0 0 0 1", "an affine transformation");
    return place;
  }
  const Vec3<double> translation = numbers("translation", 3, Vec3<double>(0, 0, 0)),
                     scale = numbers("scale", 3, Vec3<double>(1, 1, 1));
  const Eigen::Vector4d xyzw = numbers("rotation", 4, Eigen::Vector4d(0, 0, 0, 1));
  if (!(std::abs(xyzw.norm() - 1) < 1e-2))
    node["rotation"].fail("a quaternion of length " + std::to_string(xyzw.norm()), "length 1");
  return Eigen::Translation3d(translation) * Eigen::Quaterniond(Eigen::Vector4d(xyzw.normalized())) *
         Eigen::Scaling(scale);
}

class GltfReader {
 public:
  GltfReader(const Value& root, std::string binary, std::filesystem::path folder)
      : root_(root), buffers_(root, std::move(binary), std::move(folder)) {}

  RawMesh read() {
    const Value version = root_["asset"]["version"];
    if (version.text().compare(0, 2, "2.") != 0) version.fail(quoted_word(version.text()), "version 2.0");
    refuse_extensions();
    visited_.resize(root_["nodes"].size());
    for (const std::size_t node : roots()) open_.push_back({node, Eigen::Affine3d::Identity()});
    while (!open_.empty()) {
      const auto [node, above] = open_.back();
      open_.pop_back();
      add_node(node, above);
    }
    if (mesh_.triangles.empty()) root_.fail("no triangle in its scene", "one or more meshes of triangles");
    if (loose_ > 0)
      mesh_.notes.push_back(counted(loose_, "set of lines or points is", "sets of lines or points are") +
                            " ignored");
    return std::move(mesh_);
  }

 private:
  struct Open {
    std::size_t node;
    Eigen::Affine3d above;
  };

  /// Refuses compressed meshes.
  void refuse_extensions() const {
    const Value required = root_["extensionsRequired"];
    for (std::size_t k = 0; k < required.size(); ++k)
      for (const char* known : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
        if (required[k].text() == known) required[k].fail(known, "a mesh without compression");
  }

  /// Returns the root nodes of the default scene, or of the first scene. If the file has no scenes, returns
  /// all nodes without a parent.
  std::vector<std::size_t> roots() const {
    const Value scenes = root_["scenes"], nodes = root_["nodes"];
    std::vector<std::size_t> found;
    if (scenes.size() > 0) {
      const Value listed = scenes[root_["scene"].integer(scenes.size() - 1, 0)]["nodes"];
      for (std::size_t k = 0; k < listed.size(); ++k)
        found.push_back(listed[k].integer(last(nodes, listed[k])));
      return found;
    }
    std::vector<bool> is_child(nodes.size());
    for (std::size_t n = 0; n < nodes.size(); ++n) {
      const Value children = nodes[n]["children"];
      for (std::size_t k = 0; k < children.size(); ++k)
        is_child[children[k].integer(nodes.size() - 1)] = true;
    }
    for (std::size_t n = 0; n < nodes.size(); ++n)
      if (!is_child[n]) found.push_back(n);
    return found;
  }

  /// Returns the largest valid index of an array. index: the value that must be such an index; an empty array
  /// is a fault at this value.
  static std::size_t last(const Value& array, const Value& index) {
    if (array.size() == 0) index.fail("an index", "no index, because the file has no objects of this kind");
    return array.size() - 1;
  }

  void add_node(std::size_t number, const Eigen::Affine3d& above) {
    const Value nodes = root_["nodes"], node = nodes[number];
    if (visited_[number]) node.fail("a node that is a child twice, or of itself", "a tree of nodes");
    visited_[number] = true;
    const Eigen::Affine3d place = above * transformation(node);
    const Value children = node["children"], mesh = node["mesh"];
    for (std::size_t k = children.size(); k > 0; --k)
      open_.push_back({children[k - 1].integer(nodes.size() - 1), place});
    if (!mesh.exists()) return;
    const Value meshes = root_["meshes"], primitives = meshes[mesh.integer(last(meshes, mesh))]["primitives"];
    for (std::size_t k = 0; k < primitives.size(); ++k) add_primitive(primitives[k], place);
  }

  void add_primitive(const Value& primitive, const Eigen::Affine3d& place) {
    constexpr std::size_t triangles = 4, strip = 5, fan = 6;
    const std::size_t mode = primitive["mode"].integer(fan, triangles);
    if (mode < triangles) {
      ++loose_;
      return;
    }
    const std::vector<Vec3<double>> x = buffers_.vectors(primitive["attributes"]["POSITION"]);
    std::vector<std::size_t> corners;
    if (primitive["indices"].exists())
      corners = buffers_.integers(primitive["indices"], x.size());
    else
      for (std::size_t k = 0; k < x.size(); ++k) corners.push_back(k);
    if (mesh_.triangles.size() + corners.size() > kMaxTriangles ||
        mesh_.vertices.size() + x.size() > 3 * kMaxTriangles)
      primitive.fail("more than " + std::to_string(kMaxTriangles) + " triangles in all nodes",
                     "a smaller mesh");
    const int first = static_cast<int>(mesh_.vertices.size());
    const bool mirrored = place.linear().determinant() < 0;
    for (const Vec3<double>& own : x) add_vertex(place * own, primitive);
    const std::size_t n = mode == triangles    ? corners.size() / 3
                          : corners.size() < 3 ? 0
                                               : corners.size() - 2;
    for (std::size_t t = 0; t < n; ++t) {
      const std::size_t odd = t % 2;
      std::array<std::size_t, 3> of =
          mode == triangles ? std::array<std::size_t, 3>{3 * t, 3 * t + 1, 3 * t + 2}
          : mode == strip   ? std::array<std::size_t, 3>{t, t + 1 + odd, t + 2 - odd}
                            : std::array<std::size_t, 3>{0, t + 1, t + 2};
      if (mirrored) std::swap(of[1], of[2]);
      mesh_.triangles.push_back({first + static_cast<int>(corners[of[0]]),
                                 first + static_cast<int>(corners[of[1]]),
                                 first + static_cast<int>(corners[of[2]])});
    }
  }

  void add_vertex(const Vec3<double>& x, const Value& primitive) {
    if (!x.allFinite()) primitive.fail("a vertex that its nodes move to infinity", "finite transformations");
    mesh_.vertices.push_back(x);
  }

  Value root_;
  Buffers buffers_;
  RawMesh mesh_;
  std::vector<Open> open_;
  std::vector<bool> visited_;
  std::size_t loose_ = 0;
};

}  // namespace

}  // namespace gltf

RawMesh read_gltf(const MeshBytes& file, const std::filesystem::path& folder) {
  using namespace gltf;
  const bool binary = file.bytes.compare(0, 4, "glTF") == 0;
  Parts parts = binary ? split_glb(file) : Parts{file.bytes, {}};
  const JsonDocument document = parse_json(file.name, std::move(parts.json));
  return GltfReader(Value(file.name, &document.root(), ""), std::move(parts.binary), folder).read();
}

}  // namespace pliant
