// Mesh files of a cube [0, 1] x [0, 1] x [0, 1] in all formats, for tests.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <string>
#include <vector>

namespace mesh_samples {

using Vertex = std::array<double, 3>;

inline const std::vector<Vertex>& cube_vertices() {
  static const std::vector<Vertex> all{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                       {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
  return all;
}
/// Returns the corners of the faces, counter-clockwise seen from outside.
inline const std::vector<std::array<int, 4>>& cube_faces() {
  static const std::vector<std::array<int, 4>> all{{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4},
                                                   {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  return all;
}

/// Returns the lines v and f of a cube that is moved along x. first: number of vertices before this cube.
inline std::string obj_cube(double along_x = 0, int first = 0) {
  std::ostringstream text;
  for (const Vertex& v : cube_vertices())
    text << "v " << v[0] + along_x << " " << v[1] << " " << v[2] << "\n";
  for (const auto& f : cube_faces()) {
    text << "f";
    for (const int corner : f) text << " " << corner + 1 + first;
    text << "\n";
  }
  return text.str();
}

template <class T>
void put(std::string& bytes, T value, bool swap = false) {
  std::array<char, sizeof(T)> raw;
  std::memcpy(raw.data(), &value, sizeof(T));
  if (swap) std::reverse(raw.begin(), raw.end());
  bytes.append(raw.data(), raw.size());
}

/// Returns a PLY file. format: ascii, binary_little_endian or binary_big_endian. The machine is
/// little-endian. extra: bytes between the header and the data.
inline std::string ply_cube(const std::string& format, const std::string& extra = "") {
  std::string header = "ply\nformat " + format +
                       " 1.0\ncomment a cube\nelement vertex 8\nproperty double x\nproperty double y\n"
                       "property double z\nproperty uchar red\nelement face 6\n"
                       "property list uchar int vertex_indices\nend_header\n";
  std::string bytes;
  std::ostringstream text;
  const bool swap = format == "binary_big_endian";
  for (const Vertex& v : cube_vertices()) {
    text << v[0] << " " << v[1] << " " << v[2] << " 7\n";
    for (const double x : v) put(bytes, x, swap);
    put(bytes, std::uint8_t{7});
  }
  for (const auto& f : cube_faces()) {
    text << "4 " << f[0] << " " << f[1] << " " << f[2] << " " << f[3] << "\n";
    put(bytes, std::uint8_t{4});
    for (const int corner : f) put(bytes, static_cast<std::int32_t>(corner), swap);
  }
  return header + extra + (format == "ascii" ? text.str() : bytes);
}

inline std::vector<std::array<int, 3>> cube_triangles() {
  std::vector<std::array<int, 3>> all;
  for (const auto& f : cube_faces()) {
    all.push_back({f[0], f[1], f[2]});
    all.push_back({f[0], f[2], f[3]});
  }
  return all;
}

inline std::string stl_text_cube() {
  std::ostringstream text;
  text << "solid cube\n";
  for (const auto& t : cube_triangles()) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int corner : t) {
      const Vertex& v = cube_vertices()[static_cast<std::size_t>(corner)];
      text << "vertex " << v[0] << " " << v[1] << " " << v[2] << "\n";
    }
    text << "endloop\nendfacet\n";
  }
  text << "endsolid cube\n";
  return text.str();
}

inline std::string stl_binary_cube() {
  std::string bytes(80, '\0');
  put(bytes, std::uint32_t{12});
  for (const auto& t : cube_triangles()) {
    bytes.append(12, '\0');
    for (const int corner : t)
      for (const double x : cube_vertices()[static_cast<std::size_t>(corner)])
        put(bytes, static_cast<float>(x));
    bytes.append(2, '\0');
  }
  return bytes;
}

/// Returns the vertices (floats) and then the corners (16-bit integers) of the cube, 168 bytes.
inline std::string gltf_data() {
  std::string bytes;
  for (const Vertex& v : cube_vertices())
    for (const double x : v) put(bytes, static_cast<float>(x));
  for (const auto& t : cube_triangles())
    for (const int corner : t) put(bytes, static_cast<std::uint16_t>(corner));
  return bytes;
}

inline std::string base64(const std::string& bytes) {
  const char* digits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  unsigned bits = 0;
  int n = 0;
  for (const char c : bytes) {
    bits = (bits << 8) | static_cast<unsigned char>(c);
    for (n += 8; n >= 6; n -= 6) text += digits[(bits >> (n - 6)) & 63];
  }
  if (n > 0) text += digits[(bits << (6 - n)) & 63];
  return text + std::string((4 - text.size() % 4) % 4, '=');
}

/// Returns the JSON text of a glTF file. nodes: JSON array of the nodes; node 0 is the root, and mesh 0 is
/// the cube. uri: address of the data; empty for a GLB file.
inline std::string gltf_json(const std::string& nodes, const std::string& uri) {
  return R"({"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": )" + nodes +
         R"(, "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
    "accessors": [{"bufferView": 0, "componentType": 5126, "count": 8, "type": "VEC3"},
                  {"bufferView": 1, "componentType": 5123, "count": 36, "type": "SCALAR"}],
    "bufferViews": [{"buffer": 0, "byteLength": 96}, {"buffer": 0, "byteOffset": 96, "byteLength": 72}],
    "buffers": [{"byteLength": 168)" +
         (uri.empty() ? "" : ", \"uri\": \"" + uri + "\"") + "}]}";
}
inline std::string gltf_cube(const std::string& nodes = "[{\"mesh\": 0}]") {
  return gltf_json(nodes, "data:application/octet-stream;base64," + base64(gltf_data()));
}
inline std::string glb_cube() {
  std::string json = gltf_json("[{\"mesh\": 0}]", "");
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string bytes = "glTF";
  put(bytes, std::uint32_t{2});
  put(bytes, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + 168));
  put(bytes, static_cast<std::uint32_t>(json.size()));
  bytes += "JSON" + json;
  put(bytes, std::uint32_t{168});
  return bytes + "BIN" + '\0' + gltf_data();
}

struct Sample {
  std::string name, bytes;
};
/// Returns the cube in every format.
inline std::vector<Sample> cubes() {
  return {{"cube.obj", obj_cube()},
          {"text.ply", ply_cube("ascii")},
          {"little.ply", ply_cube("binary_little_endian")},
          {"big.ply", ply_cube("binary_big_endian")},
          {"text.stl", stl_text_cube()},
          {"binary.stl", stl_binary_cube()},
          {"cube.gltf", gltf_cube()},
          {"cube.glb", glb_cube()}};
}

}  // namespace mesh_samples
