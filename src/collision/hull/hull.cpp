#include "hull.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace pliant {

namespace {

/// Points of a part that are nearer to each other than this, in thicknesses, are merged.
constexpr double kOnePoint = 0.05;
/// The points of a nearly flat face are support points for directions that are turned by kTurn * one_point /
/// (size of the part), rad. With so small a turn these points are nearly as far as the farthest point.
constexpr double kTurn = 1e-5;
/// An end face is represented by its rim if the cosine of the angle between its normal and the direction is
/// at least this.
constexpr double kEndFaceCosine = 0.9998;
/// A face is level if its points differ in height by at most this, in units of `one_point`.
constexpr double kLevel = 1e-10;

/// Returns the first of the points from number `first` on that is nearer to p than `distance` (m), or end().
std::vector<Vec3<double>>::iterator find_near(std::vector<Vec3<double>>& points, std::size_t first,
                                              const Vec3<double>& p, double distance) {
  return std::find_if(points.begin() + static_cast<std::ptrdiff_t>(first), points.end(),
                      [&](const Vec3<double>& other) { return (p - other).norm() < distance; });
}

}  // namespace

double one_point_distance(double thickness) {
  return kOnePoint * thickness;
}

bool Hull::is_affine(const Part& part) {
  const std::vector<LinkInfo>& links = part.parameters().links();
  return std::all_of(links.begin(), links.end(),
                     [](const LinkInfo& link) { return link.sections == Sections::stay_affine; });
}

bool Hull::exists(const Part& part, const ParameterValues<double>& values) {
  if (!is_affine(part)) return CurvedHull::exists(part, values);
  return part.shape().hull_pieces() > 0 && part.shape().has_support(values.b.data());
}

bool Hull::is_convex(const Part& part, const ParameterValues<double>& values) {
  return is_affine(part) ? part.shape().is_convex(values.b.data()) : CurvedHull(part, values).is_convex();
}

Hull::Hull(const Part& part, const ParameterValues<double>& values, Convexity convexity)
    : part_(&part),
      values_(&values),
      shape_(&part.shape()),
      a_(values.b.data()),
      size_(part.size()),
      convexity_(convexity),
      map_(part.parameters().links().empty() ? Map::identity
           : is_affine(part)                 ? Map::affine
                                             : Map::curved),
      F_(Mat3<double>::Identity()) {
  if (map_ == Map::curved) curved_.emplace(part, values);
  if (map_ == Map::affine) F_ = part.chain_gradient(Eigen::Matrix3Xd::Zero(3, 1), values).front();
}

Vec3<double> Hull::support(const Vec3<double>& m, int piece) const {
  switch (map_) {
    case Map::identity:
      return shape_->support(m, a_, piece);
    case Map::affine:
      return F_ * shape_->support(Vec3<double>((F_.transpose() * m).normalized()), a_, piece);
    case Map::curved:
      break;
  }
  return curved_->support(m.normalized(), piece, nullptr);
}

Vec3<double> Hull::support(const Vec3<double>& m) const {
  Vec3<double> best = support(m, 0);
  for (int piece = 1; piece < pieces(); ++piece)
    if (const Vec3<double> x = support(m, piece); m.dot(x) > m.dot(best)) best = x;
  return best;
}

Vec3<double> Hull::rough_support(const Vec3<double>& m) const {
  if (rough_is_exact()) return support(m);
  const Vec3<double> direction = m.normalized();
  Vec3<double> best = curved_->rough_support(direction, 0);
  for (int piece = 1; piece < pieces(); ++piece)
    if (const Vec3<double> x = curved_->rough_support(direction, piece); m.dot(x) > m.dot(best)) best = x;
  return best;
}

Vec3<double> Hull::support(const Vec3<double>& m, int piece, Mat3<double>& slope) const {
  if (map_ == Map::curved) return curved_->support(m.normalized(), piece, &slope);
  using D = Dual<3>;
  const Vec3<double> pulled = F_.transpose() * m;
  const Vec3<D> x = shape_->support(
      Vec3<D>(D::variable(pulled[0], 0), D::variable(pulled[1], 1), D::variable(pulled[2], 2)), a_, piece);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) slope(r, c) = x[r].d[static_cast<std::size_t>(c)];
  const Vec3<double> value(x[0].v, x[1].v, x[2].v);
  if (map_ == Map::identity) return value;
  slope = F_ * slope * F_.transpose();
  return F_ * value;
}

Vec3<double> Hull::end_face_normal(int piece) const {
  const Vec3<double> z = (piece == 0 ? 1.0 : -1.0) * Vec3<double>::UnitZ();
  if (map_ == Map::identity) return z;
  if (map_ == Map::affine) return (F_.inverse().transpose() * z).normalized();
  return curved_->end_face_normal(piece);
}

Vec3<double> Hull::extents() const {
  Vec3<double> extents;
  for (int k = 0; k < 3; ++k) {
    const Vec3<double> axis = Vec3<double>::Unit(k);
    extents[k] = support(axis)[k] - support(-axis)[k];
  }
  return extents;
}

/// Appends the points of a piece that are farthest if m turns by a small angle. The turns are along diagonals
/// of two coordinate axes, because faces of superquadrics have their corners there. Adds the farthest point,
/// too, unless the face is level and this point is an arbitrary point of the face, not one of its corners.
void Hull::add_face(const Vec3<double>& m, int piece, double one_point,
                    std::vector<Vec3<double>>& points) const {
  const std::size_t first = points.size();
  const Vec3<double> farthest = support(m, piece);
  Eigen::Index most = 0;
  m.cwiseAbs().maxCoeff(&most);
  Vec3<double> e1 = Vec3<double>::Unit((most + 1) % 3);
  e1 = (e1 - m.dot(e1) * m).normalized();
  const Vec3<double> e2 = m.cross(e1);
  bool level = false, represents_corner = false;
  const double angle = kTurn * one_point / size_;
  for (const Vec3<double>& direction : std::array<Vec3<double>, 4>{e1 + e2, e1 - e2, -e1 - e2, e2 - e1}) {
    const Vec3<double> p = support(Vec3<double>((m + angle * direction).normalized()), piece);
    if ((p - farthest).norm() < one_point) {
      represents_corner = true;
      continue;
    }
    if (find_near(points, first, p, one_point) != points.end()) continue;
    points.push_back(p);
    level = level || m.dot(farthest - p) < kLevel * one_point;
  }
  if (!level || represents_corner) points.push_back(farthest);
}

void Hull::add_rim(const Vec3<double>& m, const Vec3<double>& along, int piece, double one_point, int n_rim,
                   std::vector<Vec3<double>>& points) const {
  const Vec3<double> across = m.cross(along), farthest = support(m, piece);
  std::array<Vec3<double>, kMaxRimPoints> rim;
  const auto n = static_cast<std::size_t>(n_rim);
  bool level = false;
  for (std::size_t k = 0; k < n; ++k) {
    const double angle = static_cast<double>(2 * k + 1) * kPi / n_rim;
    rim[k] = support(Vec3<double>(std::cos(angle) * along + std::sin(angle) * across), piece);
    level = level || m.dot(farthest - rim[k]) < kLevel * one_point;
  }
  const std::size_t first = points.size();
  if (!level) points.push_back(farthest);
  for (std::size_t k = 0; k < n; ++k)
    if (find_near(points, first, rim[k], one_point) == points.end()) points.push_back(rim[k]);
}

int Hull::parallel_end_face(const Vec3<double>& m, double one_point) const {
  for (int piece = 0; has_end_faces() && piece < 2; ++piece) {
    if (m.dot(end_face_normal(piece)) < kEndFaceCosine) continue;
    const Vec3<double> e1 = m.unitOrthogonal(), e2 = m.cross(e1);
    auto is_wide = [&](const Vec3<double>& e) {
      return (support(e, piece) - support(Vec3<double>(-e), piece)).norm() > 2 * one_point;
    };
    if (is_wide(e1) || is_wide(e2)) return piece;  // not a tip
  }
  return -1;
}

void Hull::touching_points(const Vec3<double>& m, const Vec3<double>& along, int end_face,
                           const PointLimits& limits, int n_rim, std::vector<Vec3<double>>& points) const {
  const bool flat = has_flat_regions(), has_local_points = map_ == Map::curved && !is_convex();
  for (int piece = 0; piece < pieces(); ++piece) {
    if (piece == end_face)
      add_rim(m, along, piece, limits.one_point, n_rim, points);
    else if (has_local_points)
      continue;
    else if (flat)
      add_face(m, piece, limits.one_point, points);
    else
      add_farthest(m, support(m, piece), limits, points);
  }
  if (has_local_points) curved_->add_local_points(m, end_face, limits, points);
}

}  // namespace pliant
