#include <pliant/io/format/ply.h>

#include <cmath>
#include <cstdint>

#include <pliant/io/format/whole_file.h>

namespace pliant {
namespace {

template <class Value>
void put(std::string& bytes, Value value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

/// A sum of normals shorter than this is zero apart from rounding errors. The vertex then gets the normal of
/// its first triangle.
constexpr double kNoNormal = 1e-9;

Eigen::Matrix3Xd vertex_normals(const TriangleMesh& mesh) {
  Eigen::Matrix3Xd sums = Eigen::Matrix3Xd::Zero(3, mesh.x.cols()), first = sums;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int vertex = mesh.triangles(k, t);
      const auto normal = mesh.normals.col(mesh.corners(k, t));
      if (first.col(vertex).isZero(0)) first.col(vertex) = normal;
      sums.col(vertex) += normal;
    }
  for (Eigen::Index vertex = 0; vertex < sums.cols(); ++vertex) {
    const double length = sums.col(vertex).norm();
    sums.col(vertex) = length > kNoNormal ? Vec3<double>(sums.col(vertex) / length) : first.col(vertex);
  }
  return sums;
}

}  // namespace

std::string ply_bytes(const std::vector<NamedMesh>& meshes, const std::string& values) {
  Eigen::Index vertices = 0, triangles = 0;
  for (const NamedMesh& named : meshes) {
    vertices += named.mesh.x.cols();
    triangles += named.mesh.triangles.cols();
  }
#if __BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__
  std::string bytes = "ply\nformat binary_little_endian 1.0\n";
#else
  std::string bytes = "ply\nformat binary_big_endian 1.0\n";
#endif
  for (std::size_t i = 0; i < meshes.size(); ++i)
    bytes += "comment part " + std::to_string(i) + " " + meshes[i].name + "\n";
  bytes += "element vertex " + std::to_string(vertices) + "\n";
  for (const char* property : {"double x", "double y", "double z", "float nx", "float ny", "float nz",
                               "uchar red", "uchar green", "uchar blue", "int part"})
    bytes += std::string("property ") + property + "\n";
  if (!values.empty()) bytes += "property double " + values + "\n";
  bytes +=
      "element face " + std::to_string(triangles) + "\nproperty list uchar int vertex_indices\nend_header\n";

  bytes.reserve(bytes.size() + static_cast<std::size_t>(vertices) * (values.empty() ? 43 : 51) +
                static_cast<std::size_t>(triangles) * 13);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    const TriangleMesh& mesh = meshes[i].mesh;
    const Eigen::Matrix3Xd normals = vertex_normals(mesh);
    for (Eigen::Index k = 0; k < mesh.x.cols(); ++k) {
      for (int axis = 0; axis < 3; ++axis) put(bytes, mesh.x(axis, k));
      for (int axis = 0; axis < 3; ++axis) put(bytes, static_cast<float>(normals(axis, k)));
      for (const double channel : meshes[i].color)
        put(bytes, static_cast<std::uint8_t>(std::lround(255 * channel)));
      put(bytes, static_cast<std::int32_t>(i));
      if (!values.empty()) put(bytes, meshes[i].values[k]);
    }
  }
  std::int32_t first = 0;
  for (const NamedMesh& named : meshes) {
    for (Eigen::Index t = 0; t < named.mesh.triangles.cols(); ++t) {
      put(bytes, std::uint8_t{3});
      for (int k = 0; k < 3; ++k) put(bytes, static_cast<std::int32_t>(first + named.mesh.triangles(k, t)));
    }
    first += static_cast<std::int32_t>(named.mesh.x.cols());
  }
  return bytes;
}

void write_ply(const std::filesystem::path& path, const std::vector<NamedMesh>& meshes,
               const std::string& values) {
  const std::string bytes = ply_bytes(meshes, values);
  write_whole_file(path, bytes.data(), bytes.size());
}

}  // namespace pliant
