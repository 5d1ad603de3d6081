#include <pliant/part/surface.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <stdexcept>

namespace pliant {

namespace {

/// Corners whose face turns away from the vertex normal by more than this get the normal of their face.
constexpr double kCreaseCosine = 0.5;

/// The ball pattern: rings of the upper cap, rings of the side, rings of the lower cap, on a grid of 2m x 2m
/// cells a face.
struct BallGrid {
  int m;
  std::map<std::array<int, 3>, int> index;  // cube lattice point -> vertex
  std::vector<Vec3<double>> direction;

  int vertex(int i, int j, int k) {
    const auto [at, fresh] = index.try_emplace({i, j, k}, static_cast<int>(direction.size()));
    if (fresh) direction.push_back(bend(i, j, k));
    return at->second;
  }

  /// Azimuth by steps round the square ring through (i, j), of half side ring.
  static double azimuth(int i, int j, int ring) {
    if (ring == 0) return 0;
    if (i == ring && std::abs(j) < ring) return kPi / 4 * j / ring;
    if (j == ring) return kPi / 2 - kPi / 4 * i / ring;
    if (i == -ring) return kPi - kPi / 4 * j / ring;
    if (j == -ring) return -kPi / 2 + kPi / 4 * i / ring;
    return kPi / 4 * j / ring;
  }
  static double exact(double x) { return std::abs(x) < 1e-15 ? 0.0 : x; }

  Vec3<double> bend(int i, int j, int k) const {
    const int ring = std::max(std::abs(i), std::abs(j));
    // Elevation: caps from the pole down to 45 degrees, sides from -45 to 45.
    const double u = std::abs(k) == m ? (k > 0 ? 1 : -1) * (kPi / 2 - kPi / 4 * ring / m) : kPi / 4 * k / m;
    const double v = azimuth(i, j, ring);
    double c = exact(std::cos(u)), s = exact(std::sin(u));
    if (std::abs(k) == m && ring == m) {  // the rim belongs to the side
      c = std::sqrt(0.5);
      s = k > 0 ? c : -c;
    }
    double cv = exact(std::cos(v)), sv = exact(std::sin(v));
    if (std::abs(i) == std::abs(j) && ring > 0) {  // the diagonals exactly
      cv = std::copysign(std::sqrt(0.5), i);
      sv = std::copysign(std::sqrt(0.5), j);
    }
    return {c * cv, c * sv, s};
  }
};

void quad(std::vector<std::array<int, 3>>& triangles, int a, int b, int c, int d) {
  triangles.push_back({a, b, c});
  triangles.push_back({a, c, d});
}

}  // namespace

Surface::Surface(const Part& part, int resolution) {
  if (resolution < 1 || resolution > 512)
    throw std::invalid_argument("surface resolution " + std::to_string(resolution) +
                                " must be from 1 to 512");
  const ParameterValues<double> rest = part.parameters().rest();
  const ShapeFace& shape = part.shape();
  std::vector<std::array<int, 3>> triangles;
  if (shape.mesh() == MeshPattern::ball) {
    const int m = resolution;
    BallGrid grid{m, {}, {}};
    for (int face = 0; face < 6; ++face) {
      // Each face of the cube: its outward axis and two axes that turn counter-clockwise seen from outside.
      const int axis = face / 2, sign = face % 2 == 0 ? 1 : -1;
      const int right = (axis + 1) % 3, up = (axis + 2) % 3;
      auto at = [&](int a, int b) {
        std::array<int, 3> p{};
        p[static_cast<std::size_t>(axis)] = sign * m;
        p[static_cast<std::size_t>(right)] = sign * a;
        p[static_cast<std::size_t>(up)] = b;
        return grid.vertex(p[0], p[1], p[2]);
      };
      for (int a = -m; a < m; ++a)
        for (int b = -m; b < m; ++b) {
          // Diagonals run away from the middle of the face, so that the pattern is symmetric.
          if ((a >= 0) == (b >= 0))
            quad(triangles, at(a, b), at(a + 1, b), at(a + 1, b + 1), at(a, b + 1));
          else
            quad(triangles, at(a + 1, b), at(a + 1, b + 1), at(a, b + 1), at(a, b));
        }
    }
    for (const Vec3<double>& g : grid.direction) material_.push_back(shape.mesh_label(g, rest.b.data()));
  } else {
    const int round = 8 * resolution, tube = 4 * resolution;
    for (int j = 0; j < round; ++j)
      for (int i = 0; i < tube; ++i)
        material_.push_back(shape.mesh_label({2 * kPi * i / tube, 2 * kPi * j / round, 0}, rest.b.data()));
    auto at = [&](int i, int j) { return (j % round) * tube + i % tube; };
    for (int j = 0; j < round; ++j)
      for (int i = 0; i < tube; ++i) quad(triangles, at(i, j), at(i, j + 1), at(i + 1, j + 1), at(i + 1, j));
  }
  triangles_.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (std::size_t t = 0; t < triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      triangles_(k, static_cast<Eigen::Index>(t)) = triangles[t][static_cast<std::size_t>(k)];
}

int Surface::resolution_for(const Part& part, int triangles) {
  const double per = part.shape().mesh() == MeshPattern::ball ? 48.0 : 64.0;
  return std::clamp(static_cast<int>(std::lround(std::sqrt(triangles / per))), 1, 512);
}

namespace {

/// Gives a mesh its normals; corners whose face turns away from that of their vertex have one of their own.
void set_normals(TriangleMesh& mesh, std::vector<Vec3<double>> normals) {
  mesh.corners = mesh.triangles;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Vec3<double> a = mesh.x.col(mesh.triangles(0, t)), b = mesh.x.col(mesh.triangles(1, t)),
                       c = mesh.x.col(mesh.triangles(2, t));
    const Vec3<double> face = (b - a).cross(c - a);
    const double area = face.norm();
    if (area == 0) continue;
    int added = -1;
    for (int k = 0; k < 3; ++k) {
      const Vec3<double>& n = normals[static_cast<std::size_t>(mesh.triangles(k, t))];
      if (n.dot(face) >= kCreaseCosine * area) continue;
      if (added < 0) {
        added = static_cast<int>(normals.size());
        normals.push_back(face / area);
      }
      mesh.corners(k, t) = added;
    }
  }
  mesh.normals.resize(3, static_cast<Eigen::Index>(normals.size()));
  for (std::size_t i = 0; i < normals.size(); ++i)
    mesh.normals.col(static_cast<Eigen::Index>(i)) = normals[i];
}

}  // namespace

TriangleMesh Surface::body_mesh(const Part& part, const ParameterValues<double>& values) const {
  TriangleMesh mesh;
  mesh.x = part.s(material_, values);
  mesh.triangles = triangles_;
  set_normals(mesh, part.normals(material_, values));
  return mesh;
}

TriangleMesh node_mesh(const LocalMesh& nodes, const Eigen::Ref<const Nodes>& x) {
  TriangleMesh mesh;
  mesh.x = x.transpose();
  mesh.triangles = nodes.triangles;
  std::vector<Vec3<double>> normals(static_cast<std::size_t>(x.rows()), Vec3<double>::Zero());
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const std::array<Vec3<double>, 3> corner{
        mesh.x.col(mesh.triangles(0, t)), mesh.x.col(mesh.triangles(1, t)), mesh.x.col(mesh.triangles(2, t))};
    for (std::size_t k = 0; k < 3; ++k) {
      // Weighted by the angle of the corner, so that the diagonals of a grid do not show.
      const Vec3<double> e1 = corner[(k + 1) % 3] - corner[k], e2 = corner[(k + 2) % 3] - corner[k];
      const Vec3<double> turn = e1.cross(e2);
      const double area = turn.norm();
      if (area > 0)
        normals[static_cast<std::size_t>(mesh.triangles(static_cast<Eigen::Index>(k), t))] +=
            std::atan2(area, e1.dot(e2)) / area * turn;
    }
  }
  for (Vec3<double>& n : normals) n.normalize();
  set_normals(mesh, std::move(normals));
  return mesh;
}

TriangleMesh Surface::world_mesh(const Part& part, const ParameterValues<double>& values,
                                 const Vec3<double>& c, const Eigen::Quaterniond& R) const {
  TriangleMesh mesh = body_mesh(part, values);
  const Mat3<double> turn = R.toRotationMatrix();
  mesh.x = (turn * mesh.x).colwise() + c;
  mesh.normals = turn * mesh.normals;
  return mesh;
}

double enclosed_volume(const TriangleMesh& mesh) {
  double six = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Vec3<double> a = mesh.x.col(mesh.triangles(0, t)), b = mesh.x.col(mesh.triangles(1, t)),
                       c = mesh.x.col(mesh.triangles(2, t));
    six += a.dot(b.cross(c));
  }
  return six / 6;
}

}  // namespace pliant
