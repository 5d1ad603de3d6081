// Search on the faces, ridges and corners of an obstacle mesh.
#include "find_on_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include <pliant/collision/ellipsoid_points.h>
#include <pliant/math/index.h>

#include "sign_change.h"

namespace pliant {

namespace {

/// Largest distance of the surface from the chords between its sample points, in sizes of the part
/// (Part::size(), its largest half extent).
constexpr double kSag = 0.02;
/// Largest distance of a low point from the sample point that its search started from, in sizes.
constexpr double kSpacing = 0.4;
/// Largest depth of a contact on a face, ridge or corner, as a share of the thickness of the part.
constexpr double kMaxFaceDepth = 0.5;
/// A part has material below a point of its surface if the point that is lower by this distance, in
/// thicknesses, is inside the part.
constexpr double kBelow = 1e-3;
/// Tolerance for a point inside a triangle, in sizes.
constexpr double kInsideTolerance = 1e-6;
/// Largest distance of a point from a concave edge, in depths of the point behind the face: a point that has
/// entered a groove is at most about this far from its bottom.
constexpr double kMaxEdgeDistance = 2;
/// A face does not support a point behind it that is nearer to a second face. The second face is nearer if
/// its distance is less than kNearerShare times the depth of the point behind the first face. This rule
/// applies only if the cosine between the normals of both faces is above kMinCosine.
constexpr double kNearerShare = 0.95, kMinCosine = -0.5;
/// Largest angle, as a sine, by which the normal at a ridge or a corner may be outside the cone of the
/// normals of the faces that meet there.
constexpr double kMaxOutsideSine = 1e-3;
/// Points along a ridge whose heights differ by at most this, in sizes, are equally low. A face supports a
/// point that is at most this deep behind it, even if another face is nearer.
constexpr double kLevelAlongRidge = 3e-6;
/// Step for the one-sided slopes at a point of a ridge, in sizes.
constexpr double kSideStep = 1e-7;
/// A part that is level along a ridge has two contacts near the ends of the level range. They are this far
/// inside the range, in sizes, so that the part is still level there.
constexpr double kInset = 1e-5;
/// kSamples: number of intervals between the samples along an edge. kHalvings: number of bisections for the
/// ends of a level range.
constexpr int kSamples = 12, kHalvings = 48;
/// Accuracy of the lowest point on an edge, in sizes.
constexpr double kAccuracy = 1e-15;
/// Contacts nearer than kSameContact, in sizes, whose normals differ by less than kSameNormal, are merged.
constexpr double kSameContact = 0.02, kSameNormal = 0.01;

/// The search for the contacts of one part with one mesh.
class Search {
 public:
  Search(const PlacedSurface& a, const ObstacleMesh& mesh, double max_gap, MeshSearch& near,
         std::vector<Contact>& found)
      : a_(a),
        mesh_(mesh),
        max_gap_(max_gap),
        size_(a.part.size()),
        min_gap_(-kMaxFaceDepth * a.surface.thickness()),
        near_(near),
        found_(found),
        first_(found.size()) {}

  void search() {
    const double reach = std::max(max_gap_, 0.0) + kSag * size_;
    box_ = {(a_.box.min().array() - reach).matrix(), (a_.box.max().array() + reach).matrix()};
    if (!box_.intersects(mesh_.box())) return;
    mesh_.query(box_, near_.triangles);
    if (near_.triangles.empty()) return;
    std::vector<int>&faces = near_.faces, &edges = near_.edges, &vertices = near_.vertices;
    for (std::vector<int>* all : {&faces, &edges, &vertices}) all->clear();
    for (const int t : near_.triangles) {
      faces.push_back(mesh_.face_of(t));
      for (const int e : mesh_.edges_of(t))
        if (mesh_.edges()[at(e)].sharp) edges.push_back(e);
      for (int k = 0; k < 3; ++k)
        if (!mesh_.corner(mesh_.triangles()(k, t)).empty()) vertices.push_back(mesh_.triangles()(k, t));
    }
    for (std::vector<int>* all : {&faces, &edges, &vertices}) {
      std::sort(all->begin(), all->end());
      all->erase(std::unique(all->begin(), all->end()), all->end());
    }
    near_.above.assign(faces.size(), false);
    for (std::size_t k = 0; k < faces.size(); ++k) near_.above[k] = search_face(faces[k]);
    for (const int e : edges) search_edge(mesh_.edges()[at(e)]);
    for (const int v : vertices) search_vertex(v);
  }

 private:
  /// Adds the contacts on a face. Returns whether the part is above the plane of the face by more than
  /// max_gap.
  bool search_face(int number) {
    const ObstacleMesh::Face& face = mesh_.faces()[at(number)];
    const Vec3<double> n = a_.R.transpose() * face.normal;
    const double offset = face.normal.dot(a_.c - face.point);
    const CollisionSurface::OverPlane field(n, offset);
    if (a_.axes) {
      const Vec3<double> p = a_.axes->cwiseProduct(lowest_direction(*a_.axes, n));
      add_if_supported(number, p, field.height(p));
      return field.height(p) > max_gap_;
    }
    // The least height of a corner of the box bounds that of the part.
    if (face.normal.dot(a_.box.center() - face.point) - face.normal.cwiseAbs().dot(0.5 * a_.box.sizes()) >
        max_gap_)
      return true;
    if (a_.hull != nullptr) {
      const Vec3<double> along = a_.R.transpose() * face.normal.unitOrthogonal();
      touch_plane(*a_.hull, a_.surface.thickness(), {n, offset, along}, max_gap_, near_.hull_points,
                  near_.of_face);
      return search_face_by_hull(number, n);
    }
    const Eigen::Matrix3Xd& p = a_.points();
    const VecX<double> heights = (p.transpose() * n).array() + offset;
    const double lowest = heights.minCoeff();
    if (lowest > max_gap_ + kSag * size_) return true;
    if (lowest >= min_gap_ - kSag * size_) search_face_by_samples(number, p, heights, field);
    return false;
  }

  /// Adds the contacts at the points near_.of_face of a part with a hull. Returns whether there are none. If
  /// a point is deeper than all contacts, a convex part has passed through the face, and its other points are
  /// no contacts. A part that may be non-convex can have one point beside the mesh and another on the face,
  /// like a hook. Then its other points are contacts if it has no material below them. n: the normal of the
  /// face, body frame.
  bool search_face_by_hull(int number, const Vec3<double>& n) {
    const std::vector<PlaneTouch>& touches = near_.of_face;
    const bool passed = std::any_of(touches.begin(), touches.end(),
                                    [&](const PlaneTouch& touch) { return touch.height < min_gap_; });
    if (passed && a_.hull->is_convex()) return false;
    const Vec3<double> down = -kBelow * a_.surface.thickness() * n;
    for (const PlaneTouch& touch : touches)
      if (!passed || a_.part.inside_outside(touch.p + down, a_.values) > 0)
        add_if_supported(number, touch.p, touch.height);
    return touches.empty();
  }

  /// Adds the contacts on a face for a part without a hull. p: the sample points, as columns in the body
  /// frame, m; heights: their heights over the plane of the face, m.
  void search_face_by_samples(int number, const Eigen::Matrix3Xd& p, const VecX<double>& heights,
                              const CollisionSurface::OverPlane& field) {
    const double lowest = heights.minCoeff();
    Eigen::AlignedBox3d low_box,
        face_box;  // a lowest point can be on the face only if these boxes are near each other
    for (Eigen::Index i = 0; i < heights.size(); ++i)
      if (heights[i] <= lowest + kSag * size_) low_box.extend(a_.c + a_.R * p.col(i));
    for (const int t : near_.triangles)
      if (mesh_.face_of(t) == number)
        for (int k = 0; k < 3; ++k) face_box.extend(mesh_.vertices().col(mesh_.triangles()(k, t)));
    if (low_box.exteriorDistance(face_box) > kSpacing * size_ + std::max(0.0, -lowest)) return;
    for (const CollisionSurface::LowPoint& low :
         a_.surface.low_points(a_.values, p, heights, max_gap_, field))
      add_if_supported(number, low.p, low.height, &low.material);
  }

  /// Adds the contact at a point p (body frame, m) of the part, unless the face does not support this point.
  /// height: that of p over the plane of the face, m. material: the material point at p, if it is known.
  void add_if_supported(int face, const Vec3<double>& p, double height,
                        const Material<double>* material = nullptr) {
    if (!(height <= max_gap_ && height >= min_gap_)) return;
    const Vec3<double> x = a_.c + a_.R * p;
    if (!projects_onto(face, x) || is_nearer_to_others(face, x, height)) return;
    Contact contact;
    contact.x = x;
    contact.normal = mesh_.faces()[at(face)].normal;
    contact.gap = height;
    add(contact, material);
  }

  /// Whether the part is above the plane of a face of the mesh by more than max_gap, so that it cannot touch
  /// an edge or a corner of this face.
  bool is_above(int triangle) const {
    if (triangle < 0) return false;
    const auto face = std::lower_bound(near_.faces.begin(), near_.faces.end(), mesh_.face_of(triangle));
    return face != near_.faces.end() && *face == mesh_.face_of(triangle) &&
           near_.above[at(static_cast<int>(face - near_.faces.begin()))];
  }
  bool is_above(const ObstacleMesh::Edge& edge) const {
    return is_above(edge.triangle[0]) || is_above(edge.triangle[1]);
  }

  /// Whether the projection of a point onto the plane of a face is inside the face. At a concave edge the
  /// face continues behind the adjacent face, so that a corner in a groove touches both faces.
  bool projects_onto(int face, const Vec3<double>& x) const {
    return std::any_of(near_.triangles.begin(), near_.triangles.end(), [&](int t) {
      return mesh_.face_of(t) == face && (projects_into(t, x) || is_behind_concave_edge(t, x));
    });
  }

  bool projects_into(int t, const Vec3<double>& x) const {
    bool inside = true;
    for (int k = 0; k < 3 && inside; ++k) {
      const Vec3<double> corner = mesh_.vertices().col(mesh_.triangles()(k, t)),
                         e = mesh_.vertices().col(mesh_.triangles()((k + 1) % 3, t)) - corner;
      inside = mesh_.normal(t).dot(e.cross(x - corner)) >= -kInsideTolerance * size_ * e.norm();
    }
    return inside;
  }

  /// Whether a point is behind triangle t and its neighbour at a concave edge, and this edge is the part of
  /// both triangles that is nearest to the point. The point must be near the edge, and the ends of the edge
  /// are excluded if a sharp edge ends there: elsewhere the point may be outside the solid.
  bool is_behind_concave_edge(int t, const Vec3<double>& x) const {
    const double tolerance = kInsideTolerance * size_;
    auto depth = [&](int triangle) -> double {
      return mesh_.normal(triangle).dot(mesh_.vertices().col(mesh_.triangles()(0, triangle)) - x);
    };
    const Vec3<double> nearest = mesh_.nearest(t, x);
    if ((nearest - x).norm() > kMaxEdgeDistance * depth(t) + tolerance) return false;
    const std::array<int, 3>& edges = mesh_.edges_of(t);
    return std::any_of(edges.begin(), edges.end(), [&](int number) {
      const ObstacleMesh::Edge& edge = mesh_.edges()[at(number)];
      const int other = edge.triangle[0] == t ? edge.triangle[1] : edge.triangle[0];
      if (edge.sharp || other < 0 || mesh_.face_of(other) == mesh_.face_of(t)) return false;
      const Vec3<double> start = mesh_.vertices().col(edge.vertex[0]);
      if (!(mesh_.along(edge).cross(nearest - start).norm() < tolerance)) return false;
      for (const int v : edge.vertex)
        if (!mesh_.corner(v).empty() && (mesh_.vertices().col(v) - nearest).norm() < tolerance) return false;
      return depth(other) > -tolerance && (mesh_.nearest(other, x) - nearest).norm() < tolerance;
    });
  }

  /// Whether a point behind a face has entered the mesh through another face.
  bool is_nearer_to_others(int face, const Vec3<double>& x, double height) const {
    if (height >= -kLevelAlongRidge * size_) return false;
    return std::any_of(near_.triangles.begin(), near_.triangles.end(), [&](int t) {
      return mesh_.face_of(t) != face && mesh_.normal(t).dot(mesh_.faces()[at(face)].normal) > kMinCosine &&
             (mesh_.nearest(t, x) - x).norm() < -kNearerShare * height;
    });
  }

  Vec3<double> into_a(const Vec3<double>& x) const { return a_.R.transpose() * (x - a_.c); }
  /// level() and slope() return f = w - 1 of the part and the gradient of f (1/m, world) at a point x (m,
  /// world). w is the radial material coordinate.
  double level(const Vec3<double>& x) const {
    if (a_.axes) return into_a(x).cwiseQuotient(*a_.axes).norm() - 1;
    return a_.part.inside_outside(into_a(x), a_.values);
  }
  Vec3<double> slope(const Vec3<double>& x) const {
    if (a_.axes) {
      const Vec3<double> y = into_a(x).cwiseQuotient(*a_.axes);
      return a_.R * y.normalized().cwiseQuotient(*a_.axes);
    }
    return a_.R * a_.part.inside_outside_gradient(into_a(x), a_.values);
  }

  /// Returns the contact at a point of a ridge or a corner, if the gap is in range. To first order the gap is
  /// (w - 1) / |grad w|. The gradient points into the obstacle.
  std::optional<Contact> contact_at(const Vec3<double>& x, const Vec3<double>& gradient) const {
    const double length = gradient.norm();
    if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
    const double gap = level(x) / length;
    if (!(gap <= max_gap_ && gap >= min_gap_)) return std::nullopt;
    Contact contact;
    contact.x = x;
    contact.normal = -gradient / length;
    contact.gap = gap;
    return contact;
  }

  // This function is longer than 60 lines, because the stages of the search along the edge share the
  // parametrisation of the edge and its range inside the box.
  void search_edge(const ObstacleMesh::Edge& edge) {
    if (is_above(edge)) return;
    const Vec3<double> start = mesh_.vertices().col(edge.vertex[0]),
                       edge_vector = mesh_.vertices().col(edge.vertex[1]) - start;
    const double length = edge_vector.norm();
    const Vec3<double> e = edge_vector / length;
    double from = 0, to = length;  // range of the edge inside the box, m
    for (int k = 0; k < 3; ++k) {
      const double low = (box_.min()[k] - start[k]) / e[k], high = (box_.max()[k] - start[k]) / e[k];
      if (e[k] == 0) {
        if (start[k] < box_.min()[k] || start[k] > box_.max()[k]) return;
        continue;
      }
      from = std::max(from, std::min(low, high));
      to = std::min(to, std::max(low, high));
    }
    if (!(from < to)) return;
    auto x = [&](double s) -> Vec3<double> { return start + s * e; };
    if (a_.axes) {
      const Vec3<double> y = into_a(start).cwiseQuotient(*a_.axes),
                         rate = (a_.R.transpose() * e).cwiseQuotient(*a_.axes);
      const double s = -y.dot(rate) / rate.squaredNorm();
      if (!(s >= from && s <= to)) return;
      const Vec3<double> gradient = slope(x(s));
      if (!mesh_.points_outward(edge, -gradient.normalized(), kMaxOutsideSine)) return;
      if (const std::optional<Contact> contact = contact_at(x(s), gradient)) add(*contact);
      return;
    }
    const double step = (to - from) / kSamples;
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (int i = 0; i <= kSamples; ++i) {
      const double here = level(x(from + i * step));
      if (here < least) {
        least = here;
        best = i;
      }
    }
    double low = from + std::max(best - 1, 0) * step, high = from + std::min(best + 1, kSamples) * step;
    if (!(least * a_.surface.thickness() <= 2 * std::max(max_gap_, 0.0) + (high - low))) return;
    const double lowest =
        sign_change(low, high, kAccuracy * size_, [&](double s) { return slope(x(s)).dot(e); });
    // The slope along the edge changes its sign at the minimum. At a kink, the gradient of the contact is the
    // weighted mean of both one-sided gradients. The weights are chosen so that the component of this mean
    // along the edge is zero.
    const double side_step = kSideStep * size_;
    const Vec3<double> before = slope(x(lowest - side_step)), after = slope(x(lowest + side_step));
    const double down = before.dot(e), up = after.dot(e);
    Vec3<double> gradient = slope(x(lowest));
    if (down < 0 && up > 0) gradient = (up * before - down * after) / (up - down);
    if (std::abs(gradient.dot(e)) > kMaxOutsideSine * gradient.norm())
      return;  // the minimum is beyond an end of the edge
    if (!mesh_.points_outward(edge, -gradient.normalized(), kMaxOutsideSine)) return;
    const std::optional<Contact> deepest = contact_at(x(lowest), gradient);
    if (!deepest) return;
    // Where the part is level along the edge, both ends of the level range support it.
    const double level_height = level(x(lowest)) + kLevelAlongRidge * size_ * gradient.norm();
    auto end_of_level = [&](double out) {
      if (level(x(out)) <= level_height) return out;
      double in = lowest;
      for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (in + out);
        (level(x(middle)) <= level_height ? in : out) = middle;
      }
      return in;
    };
    const double first = end_of_level(from) + kInset * size_, last = end_of_level(to) - kInset * size_;
    if (last - first < kSameContact * size_) return add(*deepest);
    for (const double s : {first, last})
      if (const std::optional<Contact> contact = contact_at(x(s), gradient)) add(*contact);
  }

  void search_vertex(int v) {
    const std::vector<int>& meet = mesh_.corner(v);
    if (std::any_of(meet.begin(), meet.end(), [&](int e) { return is_above(mesh_.edges()[at(e)]); })) return;
    const Vec3<double> x = mesh_.vertices().col(v);
    if (!box_.contains(x) || !(level(x) * a_.surface.thickness() <= 2 * std::max(max_gap_, 0.0))) return;
    const std::optional<Contact> contact = contact_at(x, slope(x));
    if (!contact) return;
    if (mesh_.points_outward(v, contact->normal, kMaxOutsideSine)) add(*contact);
  }

  /// Adds a contact, or replaces one at the same place that is less deep. material: the material point of the
  /// part at the contact, if it is known.
  void add(Contact contact, const Material<double>* material = nullptr) {
    const auto same = std::find_if(found_.begin() + static_cast<std::ptrdiff_t>(first_), found_.end(),
                                   [&](const Contact& other) {
                                     return (other.x - contact.x).norm() <= kSameContact * size_ &&
                                            (other.normal - contact.normal).norm() <= kSameNormal;
                                   });
    if (same != found_.end() && !(contact.gap < same->gap)) return;
    contact.a.material = material != nullptr ? *material : a_.part.label(into_a(contact.x), a_.values);
    if (same != found_.end())
      *same = contact;
    else
      found_.push_back(contact);
  }

  const PlacedSurface& a_;
  const ObstacleMesh& mesh_;
  const double max_gap_, size_, min_gap_;
  MeshSearch& near_;
  std::vector<Contact>& found_;
  const std::size_t first_;
  Eigen::AlignedBox3d box_;
};

}  // namespace

void find_on_mesh(const PlacedSurface& a, const ObstacleMesh& mesh, double max_gap, MeshSearch& search,
                  std::vector<Contact>& found) {
  Search(a, mesh, max_gap, search, found).search();
}

}  // namespace pliant
