// Meshes and pictures for the tests of the renderer.
#pragma once

#include <array>
#include <cmath>
#include <vector>

#include <pliant/io/format/image.h>
#include <pliant/render/picture.h>

namespace pliant::test {

/// Returns a sphere around `centre` with 2 * columns * (rows - 1) triangles.
inline TriangleMesh sphere(const Eigen::Vector3d& centre, double radius, int rows = 24, int columns = 48) {
  constexpr double kPi = 3.14159265358979323846;
  const int rings = rows - 1, poles = rings * columns;
  TriangleMesh mesh;
  mesh.normals.resize(3, poles + 2);
  for (int i = 0; i < rings; ++i)
    for (int j = 0; j < columns; ++j) {
      const double u = kPi * ((i + 1.0) / rows - 0.5), v = 2 * kPi * j / columns;
      mesh.normals.col(i * columns + j) << std::cos(u) * std::cos(v), std::cos(u) * std::sin(v), std::sin(u);
    }
  mesh.normals.col(poles) << 0, 0, -1;
  mesh.normals.col(poles + 1) << 0, 0, 1;
  mesh.x = (radius * mesh.normals).colwise() + centre;
  mesh.triangles.resize(3, 2 * columns * rings);
  int count = 0;
  for (int j = 0; j < columns; ++j) {
    const int k = (j + 1) % columns, last = (rings - 1) * columns;
    mesh.triangles.col(count++) << poles, k, j;
    mesh.triangles.col(count++) << poles + 1, last + j, last + k;
    for (int i = 0; i + 1 < rings; ++i) {
      const int low = i * columns, high = low + columns;
      mesh.triangles.col(count++) << low + j, low + k, high + k;
      mesh.triangles.col(count++) << low + j, high + k, high + j;
    }
  }
  mesh.corners = mesh.triangles;
  return mesh;
}

/// Returns a cube with edges of length 2 * half, 8 vertices and 6 normals, one for each face, rotated by
/// `turn` radians around z.
inline TriangleMesh cube(const Eigen::Vector3d& centre, double half, double turn) {
  TriangleMesh mesh;
  mesh.x.resize(3, 8);
  for (int i = 0; i < 8; ++i)
    mesh.x.col(i) << (i & 1 ? half : -half), (i & 2 ? half : -half), (i & 4 ? half : -half);
  mesh.normals.resize(3, 6);
  mesh.triangles.resize(3, 12);
  mesh.corners.resize(3, 12);
  for (int axis = 0; axis < 3; ++axis)
    for (int side = 0; side < 2; ++side) {
      const int face = 2 * axis + side, u = 1 << ((axis + 1) % 3), v = 1 << ((axis + 2) % 3),
                base = side << axis;
      mesh.normals.col(face) = (side ? 1 : -1) * Eigen::Vector3d::Unit(axis);
      const int second = side ? base + u : base + v, fourth = side ? base + v : base + u;
      mesh.triangles.col(2 * face) << base, second, base + u + v;
      mesh.triangles.col(2 * face + 1) << base, base + u + v, fourth;
      mesh.corners.col(2 * face).setConstant(face);
      mesh.corners.col(2 * face + 1).setConstant(face);
    }
  const Eigen::Matrix3d rotation = Eigen::AngleAxisd(turn, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  mesh.x = (rotation * mesh.x).colwise() + centre;
  mesh.normals = rotation * mesh.normals;
  return mesh;
}

/// A picture of two spheres, a cube, the ground and a track. origin: point of the ground below the middle, m.
struct Scene {
  std::vector<TriangleMesh> meshes;
  std::vector<VecX<double>> values;
  Picture picture;

  explicit Scene(const Eigen::Vector3d& origin = Eigen::Vector3d::Zero())
      : meshes{sphere(origin + Eigen::Vector3d(-1.2, 0, 0.6), 0.6),
               sphere(origin + Eigen::Vector3d(0.3, 0.4, 1.4), 0.5),
               cube(origin + Eigen::Vector3d(1.3, -0.3, 0.5), 0.5, 0.4)} {
    const Eigen::Vector3f colors[] = {{0.85f, 0.3f, 0.2f}, {0.2f, 0.6f, 0.5f}, {0.3f, 0.4f, 0.8f}};
    for (std::size_t i = 0; i < meshes.size(); ++i) picture.bodies.push_back({&meshes[i], colors[i]});
    picture.tracks.resize(1);
    for (int i = 0; i <= 100; ++i)
      picture.tracks[0].points.push_back(origin +
                                         Eigen::Vector3d(-2 + 0.04 * i, -0.5, 1 + std::sin(0.1 * i)));
    picture.ground.height = origin[2];
    picture.camera = automatic_camera(bounds(picture), 4.0 / 3);
  }
  /// Colours the spheres by the height of their vertices (m), and sets the colour scale of the picture.
  void color_by_height() {
    values.resize(2);
    for (std::size_t i = 0; i < 2; ++i) {
      values[i] = meshes[i].x.row(2).transpose();
      picture.bodies[i].values = &values[i];
    }
    picture.scale = {"height (m)", picture.ground.height, picture.ground.height + 2};
  }
  Scene(const Scene&) = delete;
  Scene& operator=(const Scene&) = delete;
};

/// Returns the position of a world point in the picture, in pixels from the left and from the top.
inline Eigen::Vector2d pixel_of(const Eigen::Vector3d& point, const Camera& camera, int width, int height) {
  const Eigen::Vector3d forward = (camera.target - camera.eye).normalized();
  const Eigen::Vector3d right = forward.cross(camera.up).normalized(), up = right.cross(forward);
  const Eigen::Vector3d d = point - camera.eye;
  const double scale = 0.5 * height / std::tan(0.5 * camera.field_of_view * 3.14159265358979323846 / 180);
  return {0.5 * width + scale * right.dot(d) / forward.dot(d),
          0.5 * height - scale * up.dot(d) / forward.dot(d)};
}

inline std::array<int, 3> pixel(const Image& image, int x, int y) {
  const std::size_t at = (static_cast<std::size_t>(y) * image.width + x) * 3;
  return {image.rgb.at(at), image.rgb.at(at + 1), image.rgb.at(at + 2)};
}

inline std::array<int, 3> pixel(const Image& image, const Eigen::Vector2d& at) {
  return pixel(image, static_cast<int>(std::floor(at[0])), static_cast<int>(std::floor(at[1])));
}

inline int brightness(const std::array<int, 3>& p) {
  return p[0] + p[1] + p[2];
}

}  // namespace pliant::test
