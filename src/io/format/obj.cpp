// OBJ text is written line by line into a block that fits into the cache. Each full block goes to a file or a
// string.
#include <pliant/io/format/obj.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <memory>

#include <pliant/io/format/whole_file.h>

namespace pliant {
namespace {

constexpr std::size_t kLongestNumber = 26;
constexpr std::size_t kLongestLine = 3 * (2 * kLongestNumber + 3) + 8;

using Sink = std::function<void(const char*, std::size_t)>;

/// A text buffer that passes its content to a sink when it is full.
class Block {
 public:
  explicit Block(Sink sink) : sink_(std::move(sink)), bytes_(new char[kSize]) {}

  /// Returns a pointer to space for one line. The caller reports the end of the written text by wrote().
  char* line() {
    if (used_ + kLongestLine > kSize) flush();
    return bytes_.get() + used_;
  }
  void wrote(const char* end) { used_ = static_cast<std::size_t>(end - bytes_.get()); }
  void text(const std::string& text) {
    flush();
    sink_(text.data(), text.size());
  }
  void flush() {
    sink_(bytes_.get(), used_);
    used_ = 0;
  }

 private:
  static constexpr std::size_t kSize = std::size_t{1} << 17;

  Sink sink_;
  std::unique_ptr<char[]> bytes_;
  std::size_t used_ = 0;
};

char* put(char* at, double x) {
  return std::to_chars(at, at + kLongestNumber, x).ptr;
}

char* put(char* at, std::int64_t n) {
  return std::to_chars(at, at + kLongestNumber, n).ptr;
}

// Writes a component of a unit vector with six decimals: "-0.577350".
char* put_unit(char* at, double x) {
  auto millionths = static_cast<int>(std::lround(std::clamp(x, -1.0, 1.0) * 1e6));
  if (millionths < 0) {
    *at++ = '-';
    millionths = -millionths;
  }
  *at++ = millionths == 1000000 ? '1' : '0';
  *at++ = '.';
  int rest = millionths % 1000000;
  for (int i = 5; i >= 0; --i) {
    at[i] = static_cast<char>('0' + rest % 10);
    rest /= 10;
  }
  return at + 6;
}

// Returns a name that is valid for a group in an OBJ file. Characters with codes up to 0x20 (the
// space), '#' and backslashes would end or change the name, so each becomes '_'.
std::string group_name(const std::string& name) {
  std::string group = name;
  for (char& c : group)
    if (static_cast<unsigned char>(c) <= ' ' || c == '#' || c == '\\') c = '_';
  return group;
}

// Writes the lines of one mesh. vertex, normal: numbers in the file, from 1, of the first vertex and the
// first normal of the mesh.
void add_mesh(Block& block, const TriangleMesh& mesh, std::int64_t vertex, std::int64_t normal) {
  for (Eigen::Index i = 0; i < mesh.x.cols(); ++i) {
    char* at = block.line();
    *at++ = 'v';
    for (int k = 0; k < 3; ++k) {
      *at++ = ' ';
      at = put(at, mesh.x(k, i));
    }
    *at++ = '\n';
    block.wrote(at);
  }
  for (Eigen::Index i = 0; i < mesh.normals.cols(); ++i) {
    char* at = block.line();
    *at++ = 'v';
    *at++ = 'n';
    for (int k = 0; k < 3; ++k) {
      *at++ = ' ';
      at = put_unit(at, mesh.normals(k, i));
    }
    *at++ = '\n';
    block.wrote(at);
  }
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    char* at = block.line();
    *at++ = 'f';
    for (int k = 0; k < 3; ++k) {
      *at++ = ' ';
      at = put(at, vertex + mesh.triangles(k, i));
      *at++ = '/';
      *at++ = '/';
      at = put(at, normal + mesh.corners(k, i));
    }
    *at++ = '\n';
    block.wrote(at);
  }
}

void write_text(const std::vector<NamedMesh>& meshes, const std::string& material_file, Sink sink) {
  Block block(std::move(sink));
  block.text("# pliant\n" + (material_file.empty() ? "" : "mtllib " + material_file + "\n"));
  std::int64_t vertex = 1, normal = 1;
  for (const NamedMesh& named : meshes) {
    const std::string group = group_name(named.name);
    block.text("g " + group + "\n" + (material_file.empty() ? "" : "usemtl " + group + "\n"));
    add_mesh(block, named.mesh, vertex, normal);
    vertex += named.mesh.x.cols();
    normal += named.mesh.normals.cols();
  }
  block.flush();
}

}  // namespace

std::string obj_text(const std::vector<NamedMesh>& meshes, const std::string& material_file) {
  std::string text;
  write_text(meshes, material_file, [&](const char* bytes, std::size_t size) { text.append(bytes, size); });
  return text;
}

std::string mtl_text(const std::vector<NamedMesh>& meshes) {
  std::string text = "# pliant\n";
  for (const NamedMesh& named : meshes) {
    text += "newmtl " + group_name(named.name) + "\nKd";
    for (const double channel : named.color) {
      char number[kLongestNumber];
      text += ' ';
      text.append(number, put(number, channel));
    }
    text += "\nKs 0.2 0.2 0.2\nNs 40\nillum 2\n";
  }
  return text;
}

void write_obj(const std::filesystem::path& path, const std::vector<NamedMesh>& meshes,
               const std::string& material_file) {
  WholeFile file(path);
  write_text(meshes, material_file, [&](const char* bytes, std::size_t size) { file.write(bytes, size); });
  file.become_target();
}

void write_obj(const std::filesystem::path& path, const Simulation& simulation, const Part& part,
               const Surface& surface) {
  const Model& model = simulation.model();
  const int i = model.body().index(part);
  if (path.has_parent_path()) std::filesystem::create_directories(path.parent_path());
  write_obj(path, {{part.name(),
                    {},
                    surface.world_mesh(part, model.values(simulation.state(), i),
                                       model.position(simulation.state(), i),
                                       model.orientation(simulation.state(), i))}});
}

}  // namespace pliant
