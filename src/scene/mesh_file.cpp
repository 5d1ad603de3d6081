#include <pliant/scene/mesh_file.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <vector>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include <pliant/math/types.h>
#include <pliant/scene/json/text_file.h>

namespace pliant {

namespace {

constexpr std::size_t kMaxBytes = std::size_t{256} << 20;
constexpr std::array<const char*, 5> kEndings{".obj", ".ply", ".stl", ".gltf", ".glb"};
constexpr const char* kPrefix = "obstacle_";
constexpr const char* kSuffix = ".ply";

/// The vertices and triangles of all meshes of a file.
struct Corners {
  std::vector<Vec3<double>> vertices;
  std::vector<Eigen::Vector3i> triangles;
};

void add_mesh(const aiMesh& mesh, const aiMatrix4x4& place, Corners& all) {
  const int first = static_cast<int>(all.vertices.size());
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D own = mesh.mVertices[i];
    if (!std::isfinite(own.x) || !std::isfinite(own.y) || !std::isfinite(own.z)) {
      std::ostringstream message;
      message << "vertex " << i << " is not finite: (" << own.x << ", " << own.y << ", " << own.z << ")";
      throw std::invalid_argument(message.str());
    }
    const aiVector3D x = place * own;
    all.vertices.emplace_back(x.x, x.y, x.z);
  }
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices != 3)
      throw std::invalid_argument("face " + std::to_string(f) +
                                  " is a point or a line; expected triangles and polygons");
    Eigen::Vector3i triangle;
    for (unsigned k = 0; k < 3; ++k) {
      if (face.mIndices[k] >= mesh.mNumVertices)
        throw std::invalid_argument("triangle " + std::to_string(f) + " refers to vertex " +
                                    std::to_string(face.mIndices[k]) + ", and the mesh has " +
                                    std::to_string(mesh.mNumVertices) + " vertices");
      triangle[k] = first + static_cast<int>(face.mIndices[k]);
    }
    all.triangles.push_back(triangle);
  }
}

void add_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, Corners& all) {
  const aiMatrix4x4 place = above * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) add_mesh(*scene.mMeshes[node.mMeshes[i]], place, all);
  for (unsigned i = 0; i < node.mNumChildren; ++i) add_node(scene, *node.mChildren[i], place, all);
}

}  // namespace

MeshFile read_mesh_file(const std::filesystem::path& file) {
  std::string ending = file.extension().string();
  for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  if (std::find(kEndings.begin(), kEndings.end(), ending) == kEndings.end())
    throw std::invalid_argument("expected a file .obj, .ply, .stl, .gltf or .glb");
  read_text_file(file.string(), kMaxBytes);  // throws FileError with the reason if the file cannot be read

  Assimp::Importer importer;
  // The importer is not asked to join vertices: it would also merge vertices that are only near each other.
  // ObstacleMesh merges the vertices at equal positions.
  const aiScene* scene =
      importer.ReadFile(file.string(), aiProcess_Triangulate | aiProcess_ValidateDataStructure);
  if (scene == nullptr || scene->mRootNode == nullptr)
    throw std::invalid_argument(std::string("the file is not a mesh: ") + importer.GetErrorString());
  Corners all;
  add_node(*scene, *scene->mRootNode, aiMatrix4x4(), all);

  MeshFile mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(all.vertices.size()));
  mesh.triangles.resize(3, static_cast<Eigen::Index>(all.triangles.size()));
  for (std::size_t i = 0; i < all.vertices.size(); ++i)
    mesh.vertices.col(static_cast<Eigen::Index>(i)) = all.vertices[i];
  for (std::size_t t = 0; t < all.triangles.size(); ++t)
    mesh.triangles.col(static_cast<Eigen::Index>(t)) = all.triangles[t];
  return mesh;
}

std::string recorded_mesh_name(const std::string& obstacle) {
  return kPrefix + obstacle + kSuffix;
}

bool is_recorded_mesh(const std::string& file_name) {
  const std::string head = kPrefix, tail = kSuffix;
  return file_name.size() > head.size() + tail.size() && file_name.compare(0, head.size(), head) == 0 &&
         file_name.compare(file_name.size() - tail.size(), tail.size(), tail) == 0;
}

}  // namespace pliant
