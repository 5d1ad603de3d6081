// Text is written into one block that is reserved for the longest lines there can be, without a check a
// number.
#include <pliant/io/obj.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>

#include <pliant/io/whole_file.h>

namespace pliant {
namespace {

constexpr std::size_t kLongestNumber = 26;
constexpr std::size_t kLongestLine = 3 * (2 * kLongestNumber + 2) + 8;

char* put(char* at, double x) {
  return std::to_chars(at, at + kLongestNumber, x).ptr;
}

char* put(char* at, std::int64_t n) {
  return std::to_chars(at, at + kLongestNumber, n).ptr;
}

// A component of a unit vector with six decimals: "-0.577350".
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

// Names of groups end at a blank.
std::string group_name(const std::string& name) {
  std::string group = name;
  for (char& c : group)
    if (static_cast<unsigned char>(c) <= ' ' || c == '#' || c == '\\') c = '_';
  return group;
}

// Lines of one mesh. vertex, normal: numbers of its first, from 1.
void add_mesh(std::string& text, const TriangleMesh& mesh, std::int64_t vertex, std::int64_t normal) {
  const std::size_t begin = text.size();
  const auto lines = static_cast<std::size_t>(mesh.x.cols() + mesh.normals.cols() + mesh.triangles.cols());
  text.resize(begin + lines * kLongestLine);
  char* at = text.data() + begin;
  for (Eigen::Index i = 0; i < mesh.x.cols(); ++i) {
    *at++ = 'v';
    for (int k = 0; k < 3; ++k) {
      *at++ = ' ';
      at = put(at, mesh.x(k, i));
    }
    *at++ = '\n';
  }
  for (Eigen::Index i = 0; i < mesh.normals.cols(); ++i) {
    *at++ = 'v';
    *at++ = 'n';
    for (int k = 0; k < 3; ++k) {
      *at++ = ' ';
      at = put_unit(at, mesh.normals(k, i));
    }
    *at++ = '\n';
  }
  for (Eigen::Index i = 0; i < mesh.triangles.cols(); ++i) {
    *at++ = 'f';
    for (int k = 0; k < 3; ++k) {
      *at++ = ' ';
      at = put(at, vertex + mesh.triangles(k, i));
      *at++ = '/';
      *at++ = '/';
      at = put(at, normal + mesh.corners(k, i));
    }
    *at++ = '\n';
  }
  text.resize(static_cast<std::size_t>(at - text.data()));
}

}  // namespace

std::string obj_text(const std::vector<NamedMesh>& meshes, const std::string& material_file) {
  std::string text = "# pliant\n";
  if (!material_file.empty()) text += "mtllib " + material_file + "\n";
  std::int64_t vertex = 1, normal = 1;
  for (const NamedMesh& named : meshes) {
    const std::string group = group_name(named.name);
    text += "g " + group + "\n";
    if (!material_file.empty()) text += "usemtl " + group + "\n";
    add_mesh(text, named.mesh, vertex, normal);
    vertex += named.mesh.x.cols();
    normal += named.mesh.normals.cols();
  }
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
  const std::string text = obj_text(meshes, material_file);
  write_whole_file(path, text.data(), text.size());
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
