// Meshes of tetrahedra for balls and tori.
#include <pliant/part/mesh/solid.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/LU>

#include <pliant/local/solid/tetrahedron.h>
#include <pliant/part/mesh/ball_pattern.h>
#include <pliant/part/mesh/surface.h>

namespace pliant {

namespace {

/// Minimum Jacobian determinant of an element, relative to the cube of its longest edge.
constexpr double kFlat = 1e-9;
/// Maximum number of linear elements. The maximum of quadratic and enriched elements is a quarter of this
/// number. More elements would need more than a few gigabytes.
constexpr double kMaxElements = 2e6;

/// Corner nodes and elements. The first nodes are the vertices of the surface.
struct Corners {
  std::vector<Material<double>> material;
  std::vector<std::array<int, 4>> elements;
  /// Returns the material point of the surface in the middle of an edge or a triangle. The argument is the
  /// list of its vertices.
  std::function<Material<double>(const std::vector<int>&)> middle;
};

/// Returns the material point with the radial coordinate w in the direction g, or at the angles g of a torus
/// (ShapeInterface::mesh_label()).
struct Labels {
  const ShapeInterface& shape;
  ShapeParameters a;
  Material<double> operator()(const Vec3<double>& g, double w) const {
    Material<double> m = shape.mesh_label(g, a);
    m.w = w;
    return m;
  }
};

Corners ball_corners(const Labels& label, const Surface& surface, int m) {
  Corners corners;
  corners.material = surface.material();
  const BallSurface ball(m);
  std::map<LatticePoint, int> index = ball.index;
  for (int i = 1 - m; i < m; ++i)
    for (int j = 1 - m; j < m; ++j)
      for (int k = 1 - m; k < m; ++k) {
        const LatticePoint p{i, j, k};
        const int shell = ball_shell(p);
        index[p] = static_cast<int>(corners.material.size());
        corners.material.push_back(
            shell == 0 ? material_from(0, 1, 1, 0, 0)
                       : label(ball_direction(p), static_cast<double>(shell) / static_cast<double>(m)));
      }
  for (int i = -m; i < m; ++i)
    for (int j = -m; j < m; ++j)
      for (int k = -m; k < m; ++k) {
        // The corners of an element follow a path that starts at the corner of the cell nearest to the centre
        // and has one step along each axis. The six orders of the axes give the six elements of the cell.
        const std::array<int, 3> step{i < 0 ? -1 : 1, j < 0 ? -1 : 1, k < 0 ? -1 : 1};
        const LatticePoint inner{i < 0 ? i + 1 : i, j < 0 ? j + 1 : j, k < 0 ? k + 1 : k};
        std::array<std::size_t, 3> axes{0, 1, 2};
        do {
          LatticePoint p = inner;
          std::array<int, 4> element{index.at(p)};
          for (std::size_t c = 0; c < 3; ++c) {
            p[axes[c]] += step[axes[c]];
            element[c + 1] = index.at(p);
          }
          const bool even = (axes[1] + 3 - axes[0]) % 3 == 1;
          if (even != (step[0] * step[1] * step[2] > 0)) std::swap(element[2], element[3]);
          corners.elements.push_back(element);
        } while (std::next_permutation(axes.begin(), axes.end()));
      }
  corners.middle = [label, points = ball.points](const std::vector<int>& vertices) {
    LatticePoint sum{};
    for (int v : vertices)
      for (std::size_t r = 0; r < 3; ++r) sum[r] += points[static_cast<std::size_t>(v)][r];
    return label(ball_direction(sum), 1);
  };
  return corners;
}

/// A section of a tube: rings of 4n points, n = m, m - 2, ... > 0, and the point in the middle. Edges of a
/// triangle are directed from the first node to the second and third, and from the second to the third. An
/// edge along a ring has the direction of increasing angle; any other edge points inwards. A triangle and its
/// copy at the next angle around the axis are the ends of a prism of three elements. The diagonals of the
/// outer sides of the prisms are those of the Surface.
struct TubeSection {
  struct Node {
    int ring, step;  ///< n and the number of the point in the ring; ring 0 is the middle
  };
  std::vector<Node> nodes;
  std::vector<std::array<int, 3>> triangles;
  std::vector<bool> outwards;  ///< whether a triangle has one node on the outer and two on the inner ring

  explicit TubeSection(int m) {
    for (int n = m; n > 0; n -= 2) {
      const int ring = static_cast<int>(nodes.size()), inside = ring + 4 * n;
      for (int i = 0; i < 4 * n; ++i) nodes.push_back({n, i});
      auto outer = [&](int i) { return ring + i % (4 * n); };
      auto add = [&](std::array<int, 3> nodes_of, bool points_out) {
        triangles.push_back(nodes_of);
        outwards.push_back(points_out);
      };
      for (int side = 0; side < 4; ++side)
        for (int k = 0; k < n; ++k) {
          const int o = side * n + k;
          if (n <= 2) {
            add({outer(o), outer(o + 1), inside}, false);
            continue;
          }
          // The inner points of this side are opposite the outer points 1 .. n - 1 of this side.
          auto inner = [&](int step) { return inside + (side * (n - 2) + step - 1) % (4 * (n - 2)); };
          if (k == 0 || k == n - 1) {
            add({outer(o), outer(o + 1), inner(k == 0 ? 1 : n - 1)}, false);
          } else if (2 * k < n) {
            add({outer(o), outer(o + 1), inner(k + 1)}, false);
            add({outer(o), inner(k), inner(k + 1)}, true);
          } else {
            add({outer(o), outer(o + 1), inner(k)}, false);
            add({outer(o + 1), inner(k), inner(k + 1)}, true);
          }
        }
    }
    nodes.push_back({0, 0});
  }
};

Corners torus_corners(const Labels& label, const Surface& surface, int m) {
  Corners corners;
  corners.material = surface.material();
  const int round = 8 * m, tube = 4 * m;
  const TubeSection section(m);
  const int n_section = static_cast<int>(section.nodes.size()), n_inside = n_section - tube;
  auto at = [&](int node, int j) {
    return node < tube ? (j % round) * tube + node : round * tube + (j % round) * n_inside + node - tube;
  };
  for (int j = 0; j < round; ++j)
    for (int i = tube; i < n_section; ++i) {
      const auto [ring, step] = section.nodes[static_cast<std::size_t>(i)];
      const double angle = ring > 0 ? 2 * kPi * step / (4 * ring) : 0.0;
      corners.material.push_back(
          label({angle, 2 * kPi * j / round, 0}, static_cast<double>(ring) / static_cast<double>(m)));
    }
  for (int j = 0; j < round; ++j)
    for (std::size_t t = 0; t < section.triangles.size(); ++t) {
      const auto [a, b, c] = section.triangles[t];
      const int a0 = at(a, j), b0 = at(b, j), c0 = at(c, j), a1 = at(a, j + 1), b1 = at(b, j + 1),
                c1 = at(c, j + 1);
      for (std::array<int, 4> element :
           {std::array<int, 4>{a0, b0, c0, c1}, {a0, b0, c1, b1}, {a0, a1, b1, c1}}) {
        if (!section.outwards[t]) std::swap(element[2], element[3]);
        corners.elements.push_back(element);
      }
    }
  corners.middle = [label, round, tube](const std::vector<int>& vertices) {
    // The mean of the angles of neighbouring vertices, in steps of the grid; both angles are periodic.
    const int from = vertices[0];
    double along = 0, across = 0;
    auto step = [](int p, int q, int n) { return std::remainder(q - p, n); };
    for (int v : vertices) {
      across += step(from % tube, v % tube, tube) / static_cast<double>(vertices.size());
      along += step(from / tube, v / tube, round) / static_cast<double>(vertices.size());
    }
    return label({2 * kPi * (from % tube + across) / tube, 2 * kPi * (from / tube + along) / round, 0}, 1);
  };
  return corners;
}

/// Returns the smallest Jacobian determinant of an element over given points, relative to the cube of its
/// longest edge.
template <class Element>
double min_jacobian(const Vec3<double>* x, const std::vector<TetrahedronPoint>& points) {
  double longest = 0, smallest = kInfinity;
  for (const auto& [a, b] : kTetrahedronEdges) longest = std::max(longest, (x[a] - x[b]).norm());
  for (const TetrahedronPoint& at : points)
    smallest = std::min(smallest, Element::template gradient<double>(at, x).determinant());
  return smallest / (longest * longest * longest);
}

/// Returns the amplitude of the bubble function of a node of an enriched element: of a face (10 to 13) or of
/// the middle (14).
Vec3<double> bubble_sizes(const Vec3<double>* x, std::size_t node) {
  Vec3<double> size;
  for (int r = 0; r < 3; ++r) {
    double face[4], middle;
    EnrichedTetrahedron::bubbles(x, r, face, middle);
    size[r] = node == 14 ? middle : face[node - 10];
  }
  return size;
}

/// Returns the points of an element whose barycentric coordinates are multiples of 1/4.
std::vector<TetrahedronPoint> spread_points() {
  std::vector<TetrahedronPoint> points;
  constexpr int n = 4;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      for (int k = 0; i + j + k <= n; ++k)
        points.push_back({{1.0 * (n - i - j - k) / n, 1.0 * i / n, 1.0 * j / n, 1.0 * k / n}, 0});
  return points;
}

/// Adds the nodes of quadratic and enriched elements to the corner nodes.
class ElementNodes {
 public:
  ElementNodes(const Labels& label, Corners corners)
      : label_(label), corners_(std::move(corners)), material_(std::move(corners_.material)) {}

  const std::vector<std::array<int, 4>>& corners() const { return corners_.elements; }
  std::vector<Material<double>> take_material() { return std::move(material_); }

  /// Fills rows 3 to 5 of a boundary triangle and, if enriched, row 6.
  void add_boundary_nodes(Eigen::Ref<Eigen::VectorXi> triangle, bool enriched) {
    for (int k = 0; k < 3; ++k)
      triangle[3 + k] = node_between({triangle[k], triangle[(k + 1) % 3]}, corners_.middle);
    if (enriched) triangle[6] = node_between({triangle[0], triangle[1], triangle[2]}, corners_.middle);
  }
  /// Fills rows 4 to 9 of an element. In the undeformed shape, the node of an inner edge is in the middle
  /// between the ends of the edge.
  void add_edge_nodes(const std::array<int, 4>& corner, Eigen::Ref<Eigen::VectorXi> element) {
    for (std::size_t k = 0; k < 6; ++k)
      element[static_cast<Eigen::Index>(4 + k)] =
          node_between({corner[kTetrahedronEdges[k][0]], corner[kTetrahedronEdges[k][1]]},
                       [&](const std::vector<int>& ends) { return at(0.5 * (e(ends[0]) + e(ends[1]))); });
  }
  /// Fills rows 10 to 14 of an element. Nodes on inner faces and in the middle are placed so that the
  /// amplitudes of the bubble functions are zero.
  void add_bubble_nodes(const std::array<int, 4>& corner, Eigen::Ref<Eigen::VectorXi> element) {
    std::array<Vec3<double>, 15> x;
    for (std::size_t k = 0; k < 10; ++k) x[k] = e(element[static_cast<Eigen::Index>(k)]);
    auto without_bubble = [&](std::size_t node) {
      x[node].setZero();
      const Vec3<double> size = bubble_sizes(x.data(), node);
      return Vec3<double>(-size);
    };
    for (std::size_t f = 0; f < 4; ++f) {
      std::vector<int> face(corner.begin(), corner.end());
      face.erase(face.begin() + static_cast<std::ptrdiff_t>(f));
      const int node =
          node_between(face, [&](const std::vector<int>&) { return at(without_bubble(10 + f)); });
      element[static_cast<Eigen::Index>(10 + f)] = node;
      x[10 + f] = e(node);
    }
    element[14] = n_nodes();
    material_.push_back(at(without_bubble(14)));
  }

 private:
  int n_nodes() const { return static_cast<int>(material_.size()); }
  Vec3<double> e(int node) const {
    return label_.shape.e(material_[static_cast<std::size_t>(node)], label_.a);
  }
  Material<double> at(const Vec3<double>& x) const { return label_.shape.label(x, label_.a); }
  /// Returns the node of the edge or face with the corner nodes `ends`. If the node is new, place(ends) gives
  /// its material point.
  template <class Place>
  int node_between(std::vector<int> ends, const Place& place) {
    std::sort(ends.begin(), ends.end());
    const auto [found, is_new] = between_.try_emplace(ends, n_nodes());
    if (is_new) material_.push_back(place(found->first));
    return found->second;
  }

  const Labels& label_;
  Corners corners_;
  std::vector<Material<double>> material_;
  std::map<std::vector<int>, int> between_;
};

void check_resolution(const Part& part, int resolution, Solid::Order order) {
  if (resolution < 1 || resolution > 64)
    throw std::invalid_argument("part '" + part.name() + "': solid resolution " + std::to_string(resolution) +
                                " must be from 1 to 64");
  const double elements = 48 * std::pow(resolution, 3),
               most = order == Solid::Order::linear ? kMaxElements : kMaxElements / 4;
  if (elements <= most) return;
  std::ostringstream message;
  message << "part '" << part.name() << "': solid resolution " << resolution << " makes some " << elements
          << " elements of this order; expected at most " << most;
  throw std::invalid_argument(message.str());
}

/// Throws std::invalid_argument if an element is flat or turned inside out at rest. s: positions of the nodes
/// at rest.
void check_elements(const Part& part, int resolution, const Eigen::MatrixXi& elements,
                    const Eigen::Matrix3Xd& s) {
  const std::vector<TetrahedronPoint> points = spread_points();
  for (Eigen::Index t = 0; t < elements.cols(); ++t) {
    std::array<Vec3<double>, 15> x;
    for (Eigen::Index k = 0; k < elements.rows(); ++k) x[static_cast<std::size_t>(k)] = s.col(elements(k, t));
    const double smallest = elements.rows() == 15 ? min_jacobian<EnrichedTetrahedron>(x.data(), points)
                            : elements.rows() == 10
                                ? min_jacobian<QuadraticTetrahedron>(x.data(), points)
                                : min_jacobian<LinearTetrahedron>(x.data(), {LinearTetrahedron::rule[0]});
    if (smallest > kFlat) continue;
    const Vec3<double> middle = (x[0] + x[1] + x[2] + x[3]) / 4;
    std::ostringstream text;
    text << "part '" << part.name() << "': at resolution " << resolution
         << " an element of its solid mesh is " << (smallest < -kFlat ? "turned inside out" : "flat")
         << " near (" << middle[0] << ", " << middle[1] << ", " << middle[2]
         << ") at the rest shape; use a finer resolution or a milder rest shape";
    throw std::invalid_argument(text.str());
  }
}

}  // namespace

Solid::Solid(const Part& part, int resolution, Order order) {
  check_resolution(part, resolution, order);
  const ParameterValues<double> rest = part.parameters().rest();
  const ShapeInterface& shape = part.shape();
  const Surface surface(part, resolution);
  n_surface_ = static_cast<int>(surface.material().size());
  const Labels label{shape, rest.b.data()};
  ElementNodes nodes(label, shape.mesh() == MeshPattern::ball ? ball_corners(label, surface, resolution)
                                                              : torus_corners(label, surface, resolution));
  const bool enriched = order == Order::enriched, quadratic = order == Order::quadratic || enriched;
  elements_.resize(enriched ? 15 : quadratic ? 10 : 4, static_cast<Eigen::Index>(nodes.corners().size()));
  boundary_.resize(enriched ? 7 : quadratic ? 6 : 3, surface.triangles().cols());
  boundary_.topRows<3>() = surface.triangles();
  if (quadratic)
    for (Eigen::Index t = 0; t < boundary_.cols(); ++t) nodes.add_boundary_nodes(boundary_.col(t), enriched);
  for (std::size_t t = 0; t < nodes.corners().size(); ++t) {
    const std::array<int, 4>& corner = nodes.corners()[t];
    auto element = elements_.col(static_cast<Eigen::Index>(t));
    for (int k = 0; k < 4; ++k) element[k] = corner[static_cast<std::size_t>(k)];
    if (quadratic) nodes.add_edge_nodes(corner, element);
    if (enriched) nodes.add_bubble_nodes(corner, element);
  }
  material_ = nodes.take_material();
  check_elements(part, resolution, elements_, part.s(material_, rest));
}

}  // namespace pliant
