#include "import_mesh.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <limits>
#include <new>
#include <sstream>
#include <stdexcept>
#include <string>
#include <system_error>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <assimp/Importer.hpp>

#include "mesh_bytes.h"

namespace pliant {
namespace {

/// Exit code of the process of an import that has no memory left.
constexpr int kOutOfMemory = 8;

/// The vertices and triangles of all meshes of a file.
struct Corners {
  std::vector<double> vertices;         ///< x, y, z of each vertex
  std::vector<std::int32_t> triangles;  ///< three numbers of vertices each
};

/// Adds a mesh at a node. A transformation with a negative determinant reverses the order of the corners.
void add_mesh(const aiMesh& mesh, const aiMatrix4x4& place, Corners& all) {
  const auto first = static_cast<std::int32_t>(all.vertices.size() / 3);
  for (unsigned i = 0; i < mesh.mNumVertices; ++i) {
    const aiVector3D x = place * mesh.mVertices[i];
    if (!std::isfinite(x.x) || !std::isfinite(x.y) || !std::isfinite(x.z))
      throw std::invalid_argument("vertex " + std::to_string(i) + " is not finite");
    for (const double value : {x.x, x.y, x.z}) all.vertices.push_back(value);
  }
  const bool mirrored = place.Determinant() < 0;
  for (unsigned f = 0; f < mesh.mNumFaces; ++f) {
    const aiFace& face = mesh.mFaces[f];
    if (face.mNumIndices < 3) continue;  // a point or a line
    for (const unsigned k : mirrored ? std::array<unsigned, 3>{0, 2, 1} : std::array<unsigned, 3>{0, 1, 2})
      all.triangles.push_back(first + static_cast<std::int32_t>(face.mIndices[k]));
  }
  if (all.triangles.size() > 3 * kMaxTriangles) throw std::invalid_argument("it has too many triangles");
}

void add_node(const aiScene& scene, const aiNode& node, const aiMatrix4x4& above, Corners& all) {
  const aiMatrix4x4 place = above * node.mTransformation;
  for (unsigned i = 0; i < node.mNumMeshes; ++i) add_mesh(*scene.mMeshes[node.mMeshes[i]], place, all);
  for (unsigned i = 0; i < node.mNumChildren; ++i) add_node(scene, *node.mChildren[i], place, all);
}

Corners import_here(const std::string& file) {
  Assimp::Importer importer;
  const aiScene* scene = importer.ReadFile(file, aiProcess_Triangulate | aiProcess_ValidateDataStructure);
  if (scene == nullptr || scene->mRootNode == nullptr) throw std::invalid_argument(importer.GetErrorString());
  Corners all;
  add_node(*scene, *scene->mRootNode, aiMatrix4x4(), all);
  return all;
}

/// Writes all bytes. Ends this process if the bytes cannot be written, for example after the parent has
/// ended.
void send(int to, const void* bytes, std::size_t count) {
  const char* at = static_cast<const char*>(bytes);
  while (count > 0) {
    const ssize_t written = ::write(to, at, count);
    if (written < 0 && errno == EINTR) continue;
    if (written <= 0) ::_exit(1);
    at += written;
    count -= static_cast<std::size_t>(written);
  }
}

/// Sends numbers, preceded by their count.
template <class Number>
void send(int to, const std::vector<Number>& numbers) {
  const std::uint64_t count = numbers.size();
  send(to, &count, sizeof count);
  send(to, numbers.data(), numbers.size() * sizeof(Number));
}

/// Runs in the import process. Sends an error message, which is empty if there is no error, and then the
/// vertices and triangles.
[[noreturn]] void import_and_send(const std::string& file, int to) {
  const rlimit seconds{kImportSeconds, kImportSeconds}, no_core{0, 0};
  ::setrlimit(RLIMIT_CPU, &seconds);
  ::setrlimit(RLIMIT_CORE, &no_core);
  std::ifstream status("/proc/self/statm");
  std::uint64_t pages = 0;
  if (status >> pages) {
    const rlim_t limit = pages * static_cast<std::uint64_t>(::sysconf(_SC_PAGESIZE)) + kImportBytes;
    const rlimit memory{limit, limit};
    ::setrlimit(RLIMIT_AS, &memory);
  }
  const int silent = ::open("/dev/null", O_WRONLY);
  if (silent >= 0) ::dup2(silent, STDERR_FILENO);
  try {
    Corners all;
    std::vector<char> message;
    try {
      all = import_here(file);
    } catch (const std::bad_alloc&) {
      ::_exit(kOutOfMemory);
    } catch (const std::exception& failure) {
      const std::string what = failure.what();
      message.assign(what.begin(), what.end());
    }
    send(to, message);
    send(to, all.vertices);
    send(to, all.triangles);
  } catch (...) {  // no exception may reach the code of the parent
    ::_exit(kOutOfMemory);
  }
  ::_exit(0);
}

/// Receives all bytes that a process sends. Returns false if this takes longer than kImportSeconds.
bool receive(int from, std::string& bytes) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(kImportSeconds);
  std::vector<char> buffer(1 << 16);
  for (;;) {
    const auto left =
        std::chrono::duration_cast<std::chrono::milliseconds>(end - std::chrono::steady_clock::now());
    if (left.count() <= 0) return false;
    pollfd ready{from, POLLIN, 0};
    const int found = ::poll(&ready, 1, static_cast<int>(left.count()));
    if (found < 0 && errno == EINTR) continue;
    if (found <= 0) return false;
    const ssize_t count = ::read(from, buffer.data(), buffer.size());
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) return true;
    bytes.append(buffer.data(), static_cast<std::size_t>(count));
  }
}

/// Returns the numbers that send() has written at position `at` of the bytes, and moves `at` past them.
/// Throws std::invalid_argument if some of the numbers are missing.
template <class Number>
std::vector<Number> take(const std::string& bytes, std::size_t& at) {
  std::uint64_t count = 0;
  const auto incomplete = [] { return std::invalid_argument("the import crashed: the file is damaged"); };
  if (bytes.size() - at < sizeof count) throw incomplete();
  std::memcpy(&count, bytes.data() + at, sizeof count);
  at += sizeof count;
  if ((bytes.size() - at) / sizeof(Number) < count) throw incomplete();
  std::vector<Number> numbers(static_cast<std::size_t>(count));
  std::copy_n(bytes.data() + at, numbers.size() * sizeof(Number), reinterpret_cast<char*>(numbers.data()));
  at += numbers.size() * sizeof(Number);
  return numbers;
}

/// Runs the import in a separate process, and returns the bytes that this process sends.
std::string import_apart(const std::string& file) {
  int ends[2];
  if (::pipe2(ends, O_CLOEXEC) != 0)
    throw std::system_error(errno, std::generic_category(), "cannot start the import of " + file);
  const pid_t child = ::fork();
  if (child == 0) import_and_send(file, ends[1]);
  ::close(ends[1]);
  std::string bytes;
  const bool in_time = child > 0 && receive(ends[0], bytes);
  ::close(ends[0]);
  if (child < 0)
    throw std::system_error(errno, std::generic_category(), "cannot start the import of " + file);
  if (!in_time) ::kill(child, SIGKILL);
  int status = 0;
  while (::waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (!in_time)
    throw std::invalid_argument("the import takes longer than " + std::to_string(kImportSeconds) +
                                " s: the file is damaged or too large");
  if (WIFEXITED(status) && WEXITSTATUS(status) == kOutOfMemory)
    throw std::invalid_argument("the import needs more than " + std::to_string(kImportBytes >> 30) + " GiB");
  return bytes;
}

/// Adds a note if single precision moves vertices by more than 1e-6 of the size of the mesh.
void add_precision_note(RawMesh& mesh) {
  Vec3<double> low = mesh.vertices.front(), high = low;
  double farthest = 0;
  for (const Vec3<double>& x : mesh.vertices) {
    low = low.cwiseMin(x);
    high = high.cwiseMax(x);
    farthest = std::max(farthest, x.lpNorm<Eigen::Infinity>());
  }
  const double rounding = std::numeric_limits<float>::epsilon() * farthest, size = (high - low).maxCoeff();
  if (!(rounding > 1e-6 * size)) return;
  std::ostringstream note;
  note << "coordinates of this format are read in single precision, which moves vertices by up to "
       << rounding << " m; OBJ, PLY and STL files keep double precision";
  mesh.notes.push_back(note.str());
}

}  // namespace

RawMesh import_mesh(const std::filesystem::path& file) {
  read_mesh_bytes(file);  // throws FileError with the reason if the file cannot be read
  const std::string bytes = import_apart(file.string());
  std::size_t at = 0;
  const std::vector<char> message = take<char>(bytes, at);
  if (!message.empty()) throw std::invalid_argument(std::string(message.begin(), message.end()));
  const std::vector<double> vertices = take<double>(bytes, at);
  const std::vector<std::int32_t> triangles = take<std::int32_t>(bytes, at);
  RawMesh mesh;
  for (std::size_t i = 0; i + 3 <= vertices.size(); i += 3)
    mesh.vertices.emplace_back(vertices[i], vertices[i + 1], vertices[i + 2]);
  const auto count = static_cast<std::int32_t>(mesh.vertices.size());
  for (std::size_t i = 0; i + 3 <= triangles.size(); i += 3) {
    const std::array<int, 3> corners{triangles[i], triangles[i + 1], triangles[i + 2]};
    for (const int corner : corners)
      if (corner < 0 || corner >= count) throw std::invalid_argument("a triangle has an unknown vertex");
    mesh.triangles.push_back(corners);
  }
  if (mesh.triangles.empty()) throw std::invalid_argument("found no triangle");
  add_precision_note(mesh);
  return mesh;
}

}  // namespace pliant
