#include "read_obj.h"

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>

#include "polygons.h"
#include "words.h"

namespace pliant {

namespace {

/// Statements without influence on the surface: normals, texture, names, materials, display.
constexpr std::string_view kIgnored[] = {
    "vn",     "vt",       "g",        "o",          "s",         "mg",    "usemtl", "mtllib", "usemap",
    "maplib", "c_interp", "d_interp", "bevel",      "lod",       "ctech", "stech",  "vp",     "cstype",
    "deg",    "bmat",     "step",     "shadow_obj", "trace_obj", "end",   "con"};

class ObjReader {
 public:
  explicit ObjReader(const MeshBytes& file) : file_(file), words_(file) {}

  RawMesh read() {
    if (!file_.bytes.empty()) do
        statement();
      while (words_.next_line());
    if (max_corner_ >= 0 && max_corner_ >= static_cast<long long>(mesh_.vertices.size()))
      fail_at_byte(file_, max_corner_at_, "a face with vertex " + std::to_string(max_corner_ + 1),
                   "vertices from 1 to " + std::to_string(mesh_.vertices.size()) + ", the number of lines v");
    if (faces_.sizes.empty()) fail_at_byte(file_, file_.bytes.size(), "no face", "lines v and lines f");
    add_polygons(faces_, file_.name, mesh_);
    if (loose_ > 0)
      mesh_.notes.push_back(counted(loose_, "line or point is", "lines and points are") + " ignored");
    return std::move(mesh_);
  }

 private:
  void statement() {
    const std::string_view key = words_.on_line();
    if (key.empty()) return;
    if (key == "v") return vertex();
    if (key == "f" || key == "fo") return face();
    if (key == "l" || key == "p") {
      ++loose_;
      return;
    }
    if (std::find(std::begin(kIgnored), std::end(kIgnored), key) == std::end(kIgnored))
      words_.fail("a statement of an OBJ file, such as v, vn, vt, f, g, o, s, usemtl or mtllib");
  }

  void vertex() {
    constexpr const char* axes[] = {"coordinate x of a vertex", "coordinate y of a vertex",
                                    "coordinate z of a vertex"};
    Vec3<double> x;
    for (int k = 0; k < 3; ++k) x[k] = words_.number(words_.on_line(), axes[k]);
    // A weight or a colour may follow.
    for (int more = 0; more < 5; ++more) {
      const std::string_view word = words_.on_line();
      if (word.empty()) break;
      if (more == 4) words_.fail("the end of the line after the coordinates, weight and colour of a vertex");
      words_.number(word, "weight or colour of a vertex");
    }
    if (mesh_.vertices.size() >= static_cast<std::size_t>(std::numeric_limits<int>::max()))
      words_.fail("at most 2147483647 vertices");
    mesh_.vertices.push_back(x);
  }

  void face() {
    int n = 0;
    for (std::string_view word = words_.on_line(); !word.empty(); word = words_.on_line(), ++n)
      faces_.corners.push_back(corner(word));
    if (n < 3) words_.fail("a face with three or more corners");
    faces_.sizes.push_back(n);
  }

  /// Returns the vertex of a corner VERTEX, VERTEX/TEXTURE, VERTEX//NORMAL or VERTEX/TEXTURE/NORMAL, counted
  /// from 0. Negative numbers count backwards from the last vertex.
  int corner(std::string_view word) {
    const long long n = static_cast<long long>(mesh_.vertices.size()), max = std::numeric_limits<int>::max();
    const std::size_t slash = word.find('/');
    constexpr const char* meaning = "number of a vertex, counted from 1 or backwards from -1";
    const long long number = words_.integer(word.substr(0, slash), -n, max, meaning);
    if (number == 0) words_.fail(std::string(meaning) + ", never 0");
    if (slash != std::string_view::npos) check_rest(word.substr(slash + 1));
    const long long vertex = number > 0 ? number - 1 : n + number;
    if (vertex > max_corner_) {
      max_corner_ = vertex;
      max_corner_at_ = words_.position() - word.size();
    }
    return static_cast<int>(vertex);
  }

  void check_rest(std::string_view rest) const {
    const std::size_t slash = rest.find('/');
    for (const std::string_view number :
         {rest.substr(0, slash),
          slash == std::string_view::npos ? std::string_view() : rest.substr(slash + 1)})
      if (!number.empty())
        words_.integer(number, std::numeric_limits<int>::min(), std::numeric_limits<int>::max(),
                       "number of a texture coordinate or normal");
  }

  const MeshBytes& file_;
  Words words_;
  RawMesh mesh_;
  Polygons faces_;
  long long max_corner_ = -1;
  std::size_t max_corner_at_ = 0, loose_ = 0;
};

}  // namespace

RawMesh read_obj(const MeshBytes& file) {
  return ObjReader(file).read();
}

}  // namespace pliant
