#include <pliant/collision/mesh/find_on_mesh.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include <pliant/collision/ellipsoid_points.h>
#include <pliant/math/index.h>

namespace pliant {

namespace {

/// How far the surface may lie outside of its points, in sizes of the part.
constexpr double kSag = 0.02;
/// How far a low point may lie from the point of the surface that it is found from, in sizes.
constexpr double kSpacing = 0.4;
/// A face holds up a part that is no deeper behind it than this share of its thickness.
constexpr double kDeepestOnFace = 0.5;
/// A point belongs to a triangle that it is in but for this, in sizes.
constexpr double kWithin = 1e-6;
/// A face is not what holds a point that is nearer to others, which are turned by less than this (cosine).
constexpr double kNearer = 0.95, kOtherSide = -0.5;
/// Sine of an angle by which the normal at a ridge may lie outside of those of its faces.
constexpr double kBetween = 1e-3;
/// Points along a ridge that are this near in height, in sizes, lie as low as each other.
constexpr double kLevel = 3e-6;
/// Step for the slopes to either side of a point of a ridge, in sizes.
constexpr double kBeside = 1e-7;
/// What is flat along a ridge is met this far inside of where it ceases to be, in sizes: there it is as low
/// as all of it.
constexpr double kInside = 1e-5;
constexpr int kSamples = 12, kHalvings = 48;
/// Contacts nearer than this, in sizes, with normals as near as this, are one.
constexpr double kSame = 0.02, kSameNormal = 0.01;

/// The search for one part on one mesh.
class Search {
 public:
  Search(const PlacedSurface& a, const ObstacleMesh& mesh, double most, MeshSearch& near,
         std::vector<Contact>& found)
      : a_(a),
        mesh_(mesh),
        most_(most),
        size_(a.part.size()),
        deepest_(-kDeepestOnFace * a.surface.thickness()),
        near_(near),
        found_(found),
        first_(found.size()) {}

  void run() {
    const double reach = std::max(most_, 0.0) + kSag * size_;
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
    for (const int f : faces) on_face(f);
    for (const int e : edges) on_edge(mesh_.edges()[at(e)]);
    for (const int v : vertices) at_vertex(v);
  }

 private:
  void on_face(int number) {
    const ObstacleMesh::Face& face = mesh_.faces()[at(number)];
    const Vec3<double> n = a_.R.transpose() * face.normal;
    const double offset = face.normal.dot(a_.c - face.point);
    const CollisionSurface::OverPlane field(n, offset);
    if (a_.axes) {
      const Vec3<double> y = lowest_direction(*a_.axes, n);
      CollisionSurface::LowPoint low = a_.surface.ellipsoid_point(a_.values, *a_.axes, y);
      low.height = field.height(low.p);
      return add_if_held(number, low);
    }
    const Eigen::Matrix3Xd& p = a_.points();
    const VecX<double> heights = (p.transpose() * n).array() + offset;
    const double lowest = heights.minCoeff();
    if (lowest > most_ + kSag * size_ || lowest < deepest_ - kSag * size_) return;
    Eigen::AlignedBox3d low_box, face_box;  // whether the low points may be on this face at all
    for (Eigen::Index i = 0; i < heights.size(); ++i)
      if (heights[i] <= lowest + kSag * size_) low_box.extend(a_.c + a_.R * p.col(i));
    for (const int t : near_.triangles)
      if (mesh_.face_of(t) == number)
        for (int k = 0; k < 3; ++k) face_box.extend(mesh_.vertices().col(mesh_.triangles()(k, t)));
    if (low_box.exteriorDistance(face_box) > kSpacing * size_ + std::max(0.0, -lowest)) return;
    for (const CollisionSurface::LowPoint& low : a_.surface.low_points(a_.values, p, heights, most_, field))
      add_if_held(number, low);
  }

  void add_if_held(int face, const CollisionSurface::LowPoint& low) {
    if (!(low.height <= most_ && low.height >= deepest_)) return;
    const Vec3<double> x = a_.c + a_.R * low.p;
    if (!is_on(face, x) || is_nearer_to_others(face, x, low.height)) return;
    add(low.material, x, mesh_.faces()[at(face)].normal, low.height);
  }

  /// Whether a point lies straight above or below a face.
  bool is_on(int face, const Vec3<double>& x) const {
    for (const int t : near_.triangles) {
      if (mesh_.face_of(t) != face) continue;
      bool inside = true;
      for (int k = 0; k < 3 && inside; ++k) {
        const Vec3<double> corner = mesh_.vertices().col(mesh_.triangles()(k, t)),
                           e = mesh_.vertices().col(mesh_.triangles()((k + 1) % 3, t)) - corner;
        inside = mesh_.normal(t).dot(e.cross(x - corner)) >= -kWithin * size_ * e.norm();
      }
      if (inside) return true;
    }
    return false;
  }

  /// Whether a point behind a face has come in through others.
  bool is_nearer_to_others(int face, const Vec3<double>& x, double height) const {
    if (height >= -kLevel * size_) return false;
    return std::any_of(near_.triangles.begin(), near_.triangles.end(), [&](int t) {
      return mesh_.face_of(t) != face && mesh_.normal(t).dot(mesh_.faces()[at(face)].normal) > kOtherSide &&
             (mesh_.nearest(t, x) - x).norm() < -kNearer * height;
    });
  }

  Vec3<double> into_a(const Vec3<double>& x) const { return a_.R.transpose() * (x - a_.c); }
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

  /// A point of a ridge or a corner: to first order the distance to the part is w - 1 over the length of its
  /// gradient, which points into the obstacle.
  std::optional<Contact> touch(const Vec3<double>& x, const Vec3<double>& gradient) const {
    const double length = gradient.norm();
    if (!(length > 0) || !std::isfinite(length)) return std::nullopt;
    const double gap = level(x) / length;
    if (!(gap <= most_ && gap >= deepest_)) return std::nullopt;
    Contact contact;
    contact.x = x;
    contact.normal = -gradient / length;
    contact.gap = gap;
    return contact;
  }

  void on_edge(const ObstacleMesh::Edge& edge) {
    const Vec3<double> start = mesh_.vertices().col(edge.vertex[0]),
                       way = mesh_.vertices().col(edge.vertex[1]) - start;
    const double length = way.norm();
    const Vec3<double> e = way / length;
    double from = 0, to = length;  // of the edge, in the box
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
      if (!mesh_.leads_out(edge, -gradient.normalized(), kBetween)) return;
      if (const std::optional<Contact> contact = touch(x(s), gradient)) add(*contact);
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
    if (!(least * a_.surface.thickness() <= 2 * std::max(most_, 0.0) + (high - low))) return;
    for (int i = 0; i < kHalvings; ++i) {
      const double middle = 0.5 * (low + high), rate = slope(x(middle)).dot(e);
      if (rate == 0) {
        low = high = middle;
        break;
      }
      (rate > 0 ? high : low) = middle;
    }
    const double lowest = 0.5 * (low + high);
    // The slope along the edge changes its sign there: of those to either side a mean has none.
    const double beside = kBeside * size_;
    const Vec3<double> before = slope(x(lowest - beside)), after = slope(x(lowest + beside));
    const double down = before.dot(e), up = after.dot(e);
    Vec3<double> gradient = slope(x(lowest));
    if (down < 0 && up > 0) gradient = (up * before - down * after) / (up - down);
    if (std::abs(gradient.dot(e)) > kBetween * gradient.norm()) return;  // it goes on down beyond the end
    if (!mesh_.leads_out(edge, -gradient.normalized(), kBetween)) return;
    const std::optional<Contact> deepest = touch(x(lowest), gradient);
    if (!deepest) return;
    // Where the part is flat along the edge both ends of that carry it.
    const double flat = level(x(lowest)) + kLevel * size_ * gradient.norm();
    auto end_of_flat = [&](double out) {
      if (level(x(out)) <= flat) return out;
      double in = lowest;
      for (int i = 0; i < kHalvings; ++i) {
        const double middle = 0.5 * (in + out);
        (level(x(middle)) <= flat ? in : out) = middle;
      }
      return in;
    };
    const double first = end_of_flat(from) + kInside * size_, last = end_of_flat(to) - kInside * size_;
    if (last - first < kSame * size_) return add(*deepest);
    for (const double s : {first, last})
      if (const std::optional<Contact> contact = touch(x(s), gradient)) add(*contact);
  }

  void at_vertex(int v) {
    const Vec3<double> x = mesh_.vertices().col(v);
    if (!box_.contains(x) || !(level(x) * a_.surface.thickness() <= 2 * std::max(most_, 0.0))) return;
    const std::optional<Contact> contact = touch(x, slope(x));
    if (!contact) return;
    if (mesh_.leads_out(v, contact->normal, kBetween)) add(*contact);
  }

  void add(Contact contact) {
    contact.a.material = a_.part.label(into_a(contact.x), a_.values);
    add_one(contact);
  }
  void add(const Material<double>& material, const Vec3<double>& x, const Vec3<double>& normal, double gap) {
    Contact contact;
    contact.a.material = material;
    contact.x = x;
    contact.normal = normal;
    contact.gap = gap;
    add_one(contact);
  }
  void add_one(const Contact& contact) {
    for (std::size_t k = first_; k < found_.size(); ++k) {
      Contact& other = found_[k];
      if ((other.x - contact.x).norm() > kSame * size_ ||
          (other.normal - contact.normal).norm() > kSameNormal)
        continue;
      if (contact.gap < other.gap) other = contact;
      return;
    }
    found_.push_back(contact);
  }

  const PlacedSurface& a_;
  const ObstacleMesh& mesh_;
  const double most_, size_, deepest_;
  MeshSearch& near_;
  std::vector<Contact>& found_;
  const std::size_t first_;
  Eigen::AlignedBox3d box_;
};

}  // namespace

void find_on_mesh(const PlacedSurface& a, const ObstacleMesh& mesh, double most, MeshSearch& search,
                  std::vector<Contact>& found) {
  Search(a, mesh, most, search, found).run();
}

}  // namespace pliant
