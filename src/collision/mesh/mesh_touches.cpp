// Tests of vertices against faces and of edges against edges, for two meshes.
#include <pliant/collision/mesh/mesh_touches.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>

#include <pliant/math/index.h>

namespace pliant {

namespace {

/// Largest depth of two crossing edges, as a share of the length of the shorter edge. In deeper overlaps a
/// vertex is inside the other mesh and gives the contact.
constexpr double kEdgeDepth = 0.5;
/// Edges are parallel if the sine of the angle between them is below this.
constexpr double kParallel = 1e-9;
/// Distances to two triangles whose squares differ by less than this share are equal: the nearest point is on
/// a common edge or corner.
constexpr double kTie = 1e-9;
/// A point is straight behind a triangle if its squared distances to the triangle and to the plane of the
/// triangle agree to this share.
constexpr double kStraightAbove = 1e-6;
/// The bounds in NearestOf::may_be_straight_behind() are widened for rounding by the share kBehindSlack of
/// lengths and of squares of lengths. The foot of a point that is straight behind a face may be outside the
/// face by less than kFootOutside times the depth, because kStraightAbove bounds the square of this ratio.
constexpr double kBehindSlack = 1e-5, kFootOutside = 1.1e-3;
/// An edge is not sharp if the sine of the angle between the normals of its triangles is at most this.
constexpr double kNoTurn = 1e-6;
/// For the search of triangles of an obstacle, the box of a part is enlarged by this share of the largest
/// depth that the search accepts.
constexpr double kMargin = 0.1;
/// Tolerance, as a sine, of the test that a normal at a corner of an obstacle points outward.
constexpr double kOutwardSine = 1e-3;
/// The triangles of a ridge are the two sides of a plate if the cosine of the angle between their normals is
/// below this.
constexpr double kBackToBack = -0.999999;

/// Returns the point of a triangle that is nearest to x, as weights of the corners p0, p1, p2; their sum
/// is 1.
Vec3<double> nearest_weights(const Vec3<double>& x, const Vec3<double>& p0, const Vec3<double>& p1,
                             const Vec3<double>& p2) {
  const Vec3<double> e1 = p1 - p0, e2 = p2 - p0, d = x - p0;
  const double a = e1.dot(e1), b = e1.dot(e2), c = e2.dot(e2), d1 = e1.dot(d), d2 = e2.dot(d);
  const double area = a * c - b * b, s = c * d1 - b * d2, t = a * d2 - b * d1;
  if (area > 0 && s >= 0 && t >= 0 && s + t <= area) return {1 - (s + t) / area, s / area, t / area};
  auto along = [](double dot, double length2) {
    return length2 > 0 ? std::clamp(dot / length2, 0.0, 1.0) : 0.0;
  };
  const double on_1 = along(d1, a), on_2 = along(d2, c),
               on_3 = along((x - p1).dot(p2 - p1), (p2 - p1).squaredNorm());
  const std::array<Vec3<double>, 3> border{Vec3<double>(1 - on_1, on_1, 0), Vec3<double>(1 - on_2, 0, on_2),
                                           Vec3<double>(0, 1 - on_3, on_3)};
  auto distance = [&](const Vec3<double>& w) {
    return (w[0] * p0 + w[1] * p1 + w[2] * p2 - x).squaredNorm();
  };
  return *std::min_element(border.begin(), border.end(), [&](const auto& one, const auto& other) {
    return distance(one) < distance(other);
  });
}

/// The vertices, edges and faces of a mesh that may be inside another one, with data for repeated use.
struct Candidates {
  struct Face {
    Eigen::Vector3i corner;
    Vec3<double> p0, p1, p2, normal, centre;
    double radius;  ///< of a ball about the centre that contains the face, m
  };
  std::vector<int> vertices, edges;
  std::vector<Face> faces;
};

/// A convex edge.
struct SharpEdge {
  int from, to;              ///< vertices
  Vec3<double> p, along;     ///< position of `from`, and the vector to `to`, m
  Vec3<double> n1, n2, n21;  ///< normals of its two sides, see sharp_elements(); and n2 x n1
};

Vec3<double> normal_of(const PlacedMesh& m, int triangle) {
  const auto corner = m.mesh->triangles().col(triangle);
  const Vec3<double> p0 = m.x.col(corner[0]), p1 = m.x.col(corner[1]), p2 = m.x.col(corner[2]);
  return (p1 - p0).cross(p2 - p0).normalized();
}

Candidates::Face face_of(const Eigen::Vector3i& corner, const Eigen::Matrix3Xd& x,
                         const Vec3<double>& normal) {
  const Vec3<double> p0 = x.col(corner[0]), p1 = x.col(corner[1]), p2 = x.col(corner[2]),
                     centre = (p0 + p1 + p2) / 3;
  const double radius = std::sqrt(
      std::max({(p0 - centre).squaredNorm(), (p1 - centre).squaredNorm(), (p2 - centre).squaredNorm()}));
  return {corner, p0, p1, p2, normal, centre, radius};
}

/// Returns the vertices, edges and faces of a mesh that meet a box and reach the height min_height (m).
/// height: the coordinate of each vertex along a direction towards the other mesh, m. Border edges are
/// excluded.
Candidates candidates(const PlacedMesh& m, const Eigen::AlignedBox3d& box, const VecX<double>& height,
                      double min_height) {
  Candidates chosen;
  for (int k = 0; k < m.x.cols(); ++k)
    if (height[k] >= min_height && box.contains(m.x.col(k))) chosen.vertices.push_back(k);
  const std::vector<ContactMesh::Edge>& edges = m.mesh->edges();
  for (int k = 0; k < static_cast<int>(edges.size()); ++k) {
    const ContactMesh::Edge& e = edges[at(k)];
    if (std::max(height[e.from], height[e.to]) < min_height || e.right < 0) continue;
    const Vec3<double> from = m.x.col(e.from), to = m.x.col(e.to);
    if (!(from.cwiseMax(to).array() < box.min().array()).any() &&
        !(from.cwiseMin(to).array() > box.max().array()).any())
      chosen.edges.push_back(k);
  }
  const Eigen::Matrix3Xi& triangles = m.mesh->triangles();
  for (int t = 0; t < triangles.cols(); ++t) {
    const auto corner = triangles.col(t);
    if (std::max({height[corner[0]], height[corner[1]], height[corner[2]]}) < min_height) continue;
    const Vec3<double> p0 = m.x.col(corner[0]), p1 = m.x.col(corner[1]), p2 = m.x.col(corner[2]);
    if ((p0.cwiseMax(p1).cwiseMax(p2).array() < box.min().array()).any() ||
        (p0.cwiseMin(p1).cwiseMin(p2).array() > box.max().array()).any())
      continue;
    chosen.faces.push_back(face_of(corner, m.x, normal_of(m, t)));
  }
  return chosen;
}

/// Removes the candidates that are entirely below min_height.
void keep_above(Candidates& chosen, const PlacedMesh& m, const VecX<double>& height, double min_height) {
  auto keep = [](auto& all, auto&& top) {
    all.erase(std::remove_if(all.begin(), all.end(), [&](const auto& one) { return !top(one); }), all.end());
  };
  keep(chosen.vertices, [&](int k) { return height[k] >= min_height; });
  keep(chosen.edges, [&](int k) {
    const ContactMesh::Edge& e = m.mesh->edges()[at(k)];
    return std::max(height[e.from], height[e.to]) >= min_height;
  });
  keep(chosen.faces,
       [&](const Candidates::Face& face) { return height(face.corner).maxCoeff() >= min_height; });
}

/// Returns the convex edges among some edges of a mesh. edges: numbers of edges of the mesh.
std::vector<SharpEdge> sharp_edges(const PlacedMesh& m, const std::vector<int>& edges) {
  std::vector<SharpEdge> sharp;
  for (const int k : edges) {
    const ContactMesh::Edge& e = m.mesh->edges()[at(k)];
    const Vec3<double> from = m.x.col(e.from), along = m.x.col(e.to) - from;
    const Vec3<double> n1 = normal_of(m, e.left), n2 = normal_of(m, e.right), n21 = n2.cross(n1);
    if (-n21.dot(along) > kNoTurn * along.norm()) sharp.push_back({e.from, e.to, from, along, n1, n2, n21});
  }
  return sharp;
}

/// The face that is nearest to a point.
struct NearestFace {
  const Candidates::Face* face = nullptr;
  Vec3<double> weight = Vec3<double>::Zero();               ///< weights of its corners in the nearest point
  double square = std::numeric_limits<double>::infinity();  ///< squared distance, m^2
  double gap = 0;                                           ///< height over the plane of the face, m

  /// The nearest point.
  Vec3<double> foot() const { return weight[0] * face->p0 + weight[1] * face->p1 + weight[2] * face->p2; }
  bool is_straight_behind() const { return gap < 0 && square <= gap * gap * (1 + kStraightAbove); }
};

/// Finds the face that is nearest to a point, among some faces.
class NearestOf {
 public:
  /// faces: must outlive this object.
  explicit NearestOf(const std::vector<Candidates::Face>& faces)
      : faces_(faces),
        centres_(static_cast<Eigen::Index>(faces.size()), 3),
        normals_(centres_.rows(), 3),
        radii_(centres_.rows()) {
    for (Eigen::Index k = 0; k < centres_.rows(); ++k) {
      const Candidates::Face& face = faces[static_cast<std::size_t>(k)];
      centres_.row(k) = face.centre.transpose();
      normals_.row(k) = face.normal.transpose();
      radii_[k] = face.radius;
    }
  }

  /// Returns false only if x is not straight behind its nearest face. This test costs less than a search.
  bool may_be_straight_behind(const Vec3<double>& x) {
    if (faces_.empty()) return false;
    measure_distances(x);
    Eigen::Index near = 0;
    squared_distances_.minCoeff(&near);
    const Candidates::Face& face = faces_[static_cast<std::size_t>(near)];
    const double square = square_to(face, nearest_weights(x, face.p0, face.p1, face.p2), x);
    // If x is straight behind its nearest face, three conditions hold. x is below the plane of this face. The
    // depth of x below this plane is at most its distance from `face`. The foot of its perpendicular is in
    // the ball of the nearest face, or very near this ball.
    heights_ = normals_.col(0) * (x[0] - centres_.col(0)) + normals_.col(1) * (x[1] - centres_.col(1)) +
               normals_.col(2) * (x[2] - centres_.col(2));
    return ((heights_ <= kBehindSlack * radii_) &&
            (heights_.square() <= (1 + kBehindSlack) * square + kBehindSlack * radii_.square()) &&
            (squared_distances_ - heights_.square() <=
             ((1 + kBehindSlack) * radii_ + kFootOutside * heights_.abs()).square()))
        .any();
  }

  /// Returns the face nearest to x among the faces for which is_candidate(face) is true. NearestFace::face is
  /// nullptr if there is none.
  template <class F>
  NearestFace operator()(const Vec3<double>& x, F&& is_candidate) {
    NearestFace best;
    double reach = std::numeric_limits<double>::infinity();
    auto consider = [&](const Candidates::Face& face) {
      const double height = face.normal.dot(x - face.p0);
      const Vec3<double> w = nearest_weights(x, face.p0, face.p1, face.p2);
      const double square = square_to(face, w, x);
      // Of several equally near faces, the one with the largest |height| of x decides between inside and
      // outside.
      const bool nearer = square < best.square * (1 - kTie);
      if (!nearer && !(square < best.square * (1 + kTie) && std::abs(height) > std::abs(best.gap))) return;
      best = {&face, w, square, height};
      reach = std::sqrt(square) * (1 + kTie);
    };
    // The face with the nearest centre is tested first, so that most other faces are excluded by their balls.
    measure_distances(x);
    std::size_t first = faces_.size();
    double min_square = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      const double square = squared_distances_[static_cast<Eigen::Index>(k)];
      if (!(square < min_square) || !is_candidate(faces_[k])) continue;
      min_square = square;
      first = k;
    }
    if (first == faces_.size()) return best;
    consider(faces_[first]);
    for (std::size_t k = 0; k < faces_.size(); ++k) {
      const double most = reach + faces_[k].radius;
      if (squared_distances_[static_cast<Eigen::Index>(k)] <= most * most && is_candidate(faces_[k]))
        consider(faces_[k]);
    }
    return best;
  }

 private:
  /// Returns the squared distance (m^2) of x to the point of a face with these weights.
  static double square_to(const Candidates::Face& face, const Vec3<double>& weight, const Vec3<double>& x) {
    return (weight[0] * face.p0 + weight[1] * face.p1 + weight[2] * face.p2 - x).squaredNorm();
  }

  void measure_distances(const Vec3<double>& x) {
    squared_distances_ = (centres_.col(0) - x[0]).square() + (centres_.col(1) - x[1]).square() +
                         (centres_.col(2) - x[2]).square();
  }

  const std::vector<Candidates::Face>& faces_;
  Eigen::Array<double, Eigen::Dynamic, 3> centres_, normals_;
  Eigen::ArrayXd radii_;              // of the faces, m
  Eigen::ArrayXd squared_distances_;  // from the centres of the faces to x, m^2
  Eigen::ArrayXd heights_;            // of x above the planes of the faces, m
};

/// Appends the overlaps of vertices of one mesh that are behind faces of the other mesh. one: positions of
/// all vertices of the first mesh. vertices: numbers of the vertices to test. all: whether `faces` has all
/// faces of the other mesh nearby; then a vertex that is behind its nearest face but not straight behind it,
/// as in a dent, is inside too. one_is_a: whether `one` is side a of the result.
void add_vertices_inside(const Eigen::Matrix3Xd& one, const std::vector<int>& vertices,
                         const std::vector<Candidates::Face>& faces, bool all, bool one_is_a,
                         std::vector<MeshTouch>& found) {
  NearestOf nearest_of(faces);
  for (const int k : vertices) {
    const Vec3<double> x = one.col(k);
    if (!all && !nearest_of.may_be_straight_behind(x)) continue;
    const NearestFace nearest = nearest_of(x, [](const Candidates::Face&) { return true; });
    if (!(nearest.gap < 0) || !(all || nearest.is_straight_behind())) continue;
    const Candidates::Face& which = *nearest.face;
    Vec3<double> normal = which.normal;
    double gap = nearest.gap;
    if (!nearest.is_straight_behind()) {
      gap = -std::sqrt(nearest.square);
      normal = (x - nearest.foot()) / gap;
    }
    MeshTouch touch;
    MeshPoint point, face;
    point.vertex[0] = k;
    face.vertex = {which.corner[0], which.corner[1], which.corner[2]};
    face.weight = nearest.weight;
    touch.a = one_is_a ? point : face;
    touch.b = one_is_a ? face : point;
    touch.x = x;
    touch.normal = one_is_a ? normal : Vec3<double>(-normal);
    touch.gap = gap;
    found.push_back(touch);
  }
}

/// Appends the overlaps of convex edges of a and b that have passed through each other. Each edge has an arc
/// of normals on the unit sphere. Two edges form a face of the Minkowski difference if the arc of a crosses
/// the reversed arc of b; only such pairs are tested.
void add_crossing_edges(const std::vector<SharpEdge>& of_a, const std::vector<SharpEdge>& of_b,
                        std::vector<MeshTouch>& found) {
  for (const SharpEdge& e : of_a)
    for (const SharpEdge& f : of_b) {
      const double above_1 = -f.n1.dot(e.n21), above_2 = -f.n2.dot(e.n21);
      if (!(above_1 * above_2 < 0)) continue;
      const double beside_1 = e.n1.dot(f.n21), beside_2 = e.n2.dot(f.n21);
      if (!(beside_1 * beside_2 < 0 && above_1 * beside_2 > 0)) continue;
      Vec3<double> normal = e.along.cross(f.along);
      const double across = normal.norm(), length_a = e.along.norm(), length_b = f.along.norm();
      if (!(across > kParallel * length_a * length_b)) continue;
      normal /= normal.dot(f.n1 + f.n2) > 0 ? across : -across;
      const Vec3<double> d = e.p - f.p;
      const double gap = normal.dot(d);
      if (!(gap < 0 && gap > -kEdgeDepth * std::min(length_a, length_b))) continue;
      // The feet of the common perpendicular are e.p + s e.along and f.p + u f.along.
      const double aa = length_a * length_a, ab = e.along.dot(f.along), bb = length_b * length_b,
                   det = aa * bb - ab * ab, ad = e.along.dot(d), bd = f.along.dot(d);
      const double s = (ab * bd - bb * ad) / det, u = (aa * bd - ab * ad) / det;
      if (!(s >= 0 && s <= 1 && u >= 0 && u <= 1)) continue;
      MeshTouch touch;
      touch.a.vertex = {e.from, e.to, -1};
      touch.a.weight = {1 - s, s, 0};
      touch.b.vertex = {f.from, f.to, -1};
      touch.b.weight = {1 - u, u, 0};
      touch.x = e.p + s * e.along;
      touch.normal = normal;
      touch.gap = gap;
      found.push_back(touch);
    }
}

/// Whether a point of a triangle, given by its weights, is on an edge that is not sharp or at a corner
/// without sharp edges. A point behind such an edge or corner may be straight behind no triangle.
bool is_in_valley(const ObstacleMesh& m, int triangle, const Vec3<double>& weight) {
  std::array<int, 3> on{};
  std::size_t n = 0;
  for (int k = 0; k < 3; ++k)
    if (weight[k] > 0) on[n++] = k;
  if (n == 1) return m.corner(m.triangles()(on[0], triangle)).empty();
  if (n == 3) return false;
  const std::size_t edge = on[0] == 0 && on[1] == 2 ? 2 : static_cast<std::size_t>(on[0]);
  return !m.edges()[static_cast<std::size_t>(m.edges_of(triangle)[edge])].sharp;
}

/// Appends the overlaps of vertices of a with b. A vertex overlaps if it is behind a triangle whose normal
/// opposes the outward direction of the vertex. The outward direction is the sum of the area normals of the
/// triangles of a at the vertex. If b is a plate, the vertex and the centre of a must also be on opposite
/// sides of the plate, and the line between them must cross the plate.
void add_vertices_behind(const PlacedMesh& a, const ObstacleMesh& b, const std::vector<int>& triangles,
                         std::vector<MeshTouch>& found) {
  std::vector<Candidates::Face> faces;
  std::vector<int> numbers;
  const Vec3<double> middle = a.x.rowwise().mean();
  for (const int t : triangles) {
    const Vec3<double> p0 = b.vertices().col(b.triangles()(0, t)), normal = b.normal(t);
    if (b.is_plate() && normal.dot(middle - p0) < 0) continue;
    faces.push_back(face_of(b.triangles().col(t), b.vertices(), normal));
    numbers.push_back(t);
  }
  Eigen::Matrix3Xd out = Eigen::Matrix3Xd::Zero(3, a.x.cols());
  for (Eigen::Index t = 0; t < a.mesh->triangles().cols(); ++t) {
    const auto corner = a.mesh->triangles().col(t);
    const Vec3<double> p0 = a.x.col(corner[0]);
    const Vec3<double> normal =
        (Vec3<double>(a.x.col(corner[1])) - p0).cross(Vec3<double>(a.x.col(corner[2])) - p0);
    for (Eigen::Index k = 0; k < 3; ++k) out.col(corner[k]) += normal;
  }
  NearestOf nearest_of(faces);
  for (int k = 0; k < a.x.cols(); ++k) {
    const Vec3<double> x = a.x.col(k), outward = out.col(k);
    const NearestFace nearest =
        nearest_of(x, [&](const Candidates::Face& face) { return face.normal.dot(outward) < 0; });
    if (!(nearest.gap < 0)) continue;
    MeshTouch touch;
    touch.a.vertex[0] = k;
    touch.x = x;
    touch.gap = nearest.gap;
    touch.normal = nearest.face->normal;
    if (b.is_plate()) {
      const double share = nearest.gap / (nearest.gap - touch.normal.dot(middle - nearest.face->p0));
      const Vec3<double> across = x + share * (middle - x);
      const double near = kTie * b.box().diagonal().norm();
      if (std::none_of(numbers.begin(), numbers.end(),
                       [&](int t) { return (b.nearest(t, across) - across).norm() <= near; }))
        continue;
    }
    if (!nearest.is_straight_behind()) {
      const auto which = static_cast<std::size_t>(nearest.face - faces.data());
      if (!is_in_valley(b, numbers[which], nearest.weight)) continue;
      touch.gap = -std::sqrt(nearest.square);
      touch.normal = (x - nearest.foot()) / touch.gap;
    }
    found.push_back(touch);
  }
}

struct SharpElements {
  std::vector<int> vertices;
  std::vector<SharpEdge> edges;
};

/// Returns the sharp edges of some triangles of an obstacle, and the vertices of these edges. The second
/// normal of a border edge is in the plane of the triangle and points away from it. An edge of a plate is
/// entered twice: with the normals of the front and the side, and with those of the side and the back.
SharpElements sharp_elements(const ObstacleMesh& m, const std::vector<int>& triangles) {
  SharpElements sharp;
  std::vector<int> edges;
  for (const int t : triangles)
    for (const int e : m.edges_of(t))
      if (m.edges()[static_cast<std::size_t>(e)].sharp) edges.push_back(e);
  auto sort_unique = [](std::vector<int>& some) {
    std::sort(some.begin(), some.end());
    some.erase(std::unique(some.begin(), some.end()), some.end());
  };
  sort_unique(edges);
  for (const int number : edges) {
    const ObstacleMesh::Edge& e = m.edges()[static_cast<std::size_t>(number)];
    const Vec3<double> p = m.vertices().col(e.vertex[0]),
                       along = Vec3<double>(m.vertices().col(e.vertex[1])) - p,
                       front = m.normal(e.triangle[0]), side = m.along(e).cross(front);
    auto add = [&](const Vec3<double>& n1, const Vec3<double>& n2) {
      sharp.edges.push_back({e.vertex[0], e.vertex[1], p, along, n1, n2, n2.cross(n1)});
    };
    sharp.vertices.insert(sharp.vertices.end(), e.vertex.begin(), e.vertex.end());
    if (e.triangle[1] < 0) {
      add(front, side);
    } else if (const Vec3<double> back = m.normal(e.triangle[1]); front.dot(back) > kBackToBack) {
      add(front, back);
    } else {
      add(front, side);
      add(side, back);
    }
  }
  sort_unique(sharp.vertices);
  return sharp;
}

}  // namespace

PlacedMesh::PlacedMesh(const ContactMesh& of, Eigen::Matrix3Xd at)
    : mesh(&of), x(std::move(at)), box(x.rowwise().minCoeff(), x.rowwise().maxCoeff()) {}

void find_touches(const PlacedMesh& a, const PlacedMesh& b, std::vector<MeshTouch>& found) {
  if (!a.box.intersects(b.box)) return;
  // Along any direction, a vertex of a that is before all vertices of b does not overlap b. A vertex of b
  // that is beyond all vertices of a does not overlap a.
  Vec3<double> towards = (b.box.center() - a.box.center()).normalized();
  VecX<double> along_a = a.x.transpose() * towards, along_b = -(b.x.transpose() * towards);
  double end_of_a = along_a.maxCoeff(), start_of_b = -along_b.maxCoeff();
  if (end_of_a < start_of_b) return;
  Candidates of_a = candidates(a, b.box, along_a, start_of_b),
             of_b = candidates(b, a.box, along_b, -end_of_a);
  // The mean normal of the remaining faces is a better separating direction.
  towards.setZero();
  for (const Candidates::Face& face : of_a.faces) towards += face.normal;
  for (const Candidates::Face& face : of_b.faces) towards -= face.normal;
  towards.normalize();
  along_a = a.x.transpose() * towards;
  along_b = -(b.x.transpose() * towards);
  end_of_a = along_a.maxCoeff();
  start_of_b = -along_b.maxCoeff();
  if (end_of_a < start_of_b) return;
  keep_above(of_a, a, along_a, start_of_b);
  keep_above(of_b, b, along_b, -end_of_a);
  add_vertices_inside(a.x, of_a.vertices, of_b.faces, false, true, found);
  add_vertices_inside(b.x, of_b.vertices, of_a.faces, false, false, found);
  add_crossing_edges(sharp_edges(a, of_a.edges), sharp_edges(b, of_b.edges), found);
}

void find_touches(const PlacedMesh& a, const ObstacleMesh& b, double deepest, std::vector<MeshTouch>& found) {
  const double margin = kMargin * deepest;
  const Eigen::AlignedBox3d around(a.box.min().array() - margin, a.box.max().array() + margin);
  if (!around.intersects(b.box())) return;
  std::vector<int> near;
  b.query(around, near);
  if (near.empty()) return;
  const auto first = static_cast<std::ptrdiff_t>(found.size());
  add_vertices_behind(a, b, near, found);
  const SharpElements sharp = sharp_elements(b, near);
  const auto of_corners = static_cast<std::ptrdiff_t>(found.size());
  if (!sharp.edges.empty()) {
    const Candidates of_a = candidates(a, around, VecX<double>::Zero(a.x.cols()), 0);
    add_vertices_inside(b.vertices(), sharp.vertices, of_a.faces, true, false, found);
    found.erase(std::remove_if(found.begin() + of_corners, found.end(),
                               [&](const MeshTouch& touch) {
                                 return !b.points_outward(touch.b.vertex[0], touch.normal, kOutwardSine);
                               }),
                found.end());
    add_crossing_edges(sharp_edges(a, of_a.edges), sharp.edges, found);
  }
  found.erase(std::remove_if(found.begin() + first, found.end(),
                             [&](const MeshTouch& touch) { return touch.gap < -deepest; }),
              found.end());
}

}  // namespace pliant
