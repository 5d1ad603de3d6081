#include "curved_hull.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "sphere_samples.h"

namespace pliant {

namespace {

/// A generator or edge is straight if its middle is at most this far from its chord, in sizes. A face of a
/// box is plane with this tolerance, too.
constexpr double kStraight = 1e-12;
/// The side of a part with two pieces is developable if the normals at both ends of each generator differ by
/// at most this, rad.
constexpr double kSameNormal = 1e-6;
/// Number of generators in this test, and half the angle (rad) between the two directions whose support
/// points give a tangent of the rim.
constexpr int kGenerators = 8;
constexpr double kRimAngle = 1e-4;
/// A generator or edge is level at a point if its slope m . dx/dshare (ImagePoint) is at most this, in sizes.
constexpr double kLevelSlope = 1e-9;
/// Generators and edges are divided so that the chain turns by about this angle (rad) within an interval.
constexpr double kTurnOfInterval = 1;
/// Largest turn of the chain (rad) over a part with one piece for which CurvedHull::exists() is true.
constexpr double kMaxTurnOfPiece = 3;

/// Returns approximately the largest angle (rad) between corresponding columns of two matrices.
double turn_between(const Mat3<double>& F, const Mat3<double>& G) {
  return (F.colwise().normalized() - G.colwise().normalized()).colwise().norm().maxCoeff();
}

}  // namespace

void add_farthest(const Vec3<double>& m, const Vec3<double>& p, const PointLimits& limits,
                  std::vector<Vec3<double>>& points) {
  if (m.dot(p) < limits.least_height) return;
  const auto twin = std::find_if(points.begin(), points.end(), [&](const Vec3<double>& other) {
    return (p - other).norm() < limits.one_point;
  });
  if (twin == points.end())
    points.push_back(p);
  else if (m.dot(p) > m.dot(*twin))
    *twin = p;
}

bool CurvedHull::exists(const Part& part, const ParameterValues<double>& values) {
  const ShapeInterface& shape = part.shape();
  const double* a = values.b.data();
  const int pieces = shape.hull_pieces();
  if (pieces != 1 && pieces != 2 && !shape.half_sizes(a)) return false;
  if (!shape.has_support(a) || !shape.is_convex(a) || shape.has_flat_regions(a)) return false;
  // With an exponent below 1 a superquadric is flat at some points, where its radii of curvature are
  // infinite.
  for (int k = 0; k < shape.n_parameters(); ++k)
    if (shape.parameters()[k].quantity == Quantity::exponent && a[k] < 1) return false;
  bool tilts = false;
  for (const LinkInfo& link : part.parameters().links()) {
    if (tilts && link.sections != Sections::stay_affine) return false;
    tilts = tilts || link.sections == Sections::tilt;
  }
  const Axis axis = CurvedHull(part, values).axis();
  return axis.largest_turn <= kTurnOfInterval && (pieces > 1 || axis.turn <= kMaxTurnOfPiece);
}

CurvedHull::CurvedHull(const Part& part, const ParameterValues<double>& values)
    : part_(part), values_(values), shape_(part.shape()), image_(part, values) {}

/// Returns the support point of a piece of the undeformed shape in the direction m.
Vec3<double> CurvedHull::undeformed(const Vec3<double>& m, int piece) const {
  return shape_.support(m, values_.b.data(), piece);
}

Vec3<double> CurvedHull::support(const Vec3<double>& m, int piece, Mat3<double>* slope) const {
  LastPoint& last = last_points_[static_cast<std::size_t>(piece)];
  if (m != last.m) {
    const Vec3<double> start = last.m.isZero(0) ? image_.start(m) : last.point.normal;
    last = {m, image_.farthest(m, {piece, piece}, 0, start, true)};
  }
  if (slope != nullptr) *slope = last.point.slope;
  return last.point.x;
}

Vec3<double> CurvedHull::rough_support(const Vec3<double>& m, int piece) const {
  PartEvaluation::ChainImages images;
  part_.apply_chain(undeformed(image_.start(m), piece).replicate<1, 4>(), values_, images);
  return images.x.col(0);
}

Vec3<double> CurvedHull::end_face_normal(int piece) const {
  const Vec3<double> x = Vec3<double>::UnitX();
  Eigen::Matrix<double, 3, 4> e;
  e.colwise() = Vec3<double>(0.5 * (undeformed(x, piece) + undeformed(-x, piece)));
  PartEvaluation::ChainImages images;
  part_.apply_chain(e, values_, images);
  return (piece == 0 ? 1 : -1) * images.F[0].col(0).cross(images.F[0].col(1)).normalized();
}

Vec3<double> CurvedHull::half_sizes() const {
  Vec3<double> half;
  for (int k = 0; k < 3; ++k) {
    half[k] = 0;
    for (int piece = 0; piece < shape_.hull_pieces(); ++piece)
      half[k] = std::max(half[k], undeformed(Vec3<double>::Unit(k), piece)[k]);
  }
  return half;
}

/// Returns sample normal k. The samples are spread evenly over the surface of an ellipsoid with these half
/// sizes (m), so that slender solids have samples everywhere along their length.
Vec3<double> CurvedHull::sample_normal(std::size_t k, const Vec3<double>& half_sizes) const {
  return SphereSamples::shared().directions[k].cwiseQuotient(half_sizes).normalized();
}

bool CurvedHull::is_convex() const {
  const int pieces = shape_.hull_pieces();
  const std::vector<int>& dynamic = part_.parameters().dynamic();
  if (pieces > 1 && std::any_of(dynamic.begin(), dynamic.end(),
                                [&](int parameter) { return parameter >= shape_.n_parameters(); }))
    return false;
  if (pieces > 2) return has_plane_faces();
  if (pieces == 2 && !has_developable_sides()) return false;
  if (shape_.has_end_faces()) return true;  // each link maps the plane of a rim affinely
  const Vec3<double> half = half_sizes();
  for (std::size_t k = 0; k < SphereSamples::kCount; ++k) {
    const Vec3<double> nu = sample_normal(k, half);
    if (!image_.is_convex_at(nu, pieces == 1 || nu[2] >= 0 ? 0 : 1)) return false;
  }
  return true;
}

bool CurvedHull::is_straight(const Vec3<double>& from, const Vec3<double>& to) const {
  Eigen::Matrix<double, 3, 4> e;
  e << from, to, 0.5 * (from + to), from;
  PartEvaluation::ChainImages images;
  part_.apply_chain(e, values_, images);
  return (images.x.col(2) - 0.5 * (images.x.col(0) + images.x.col(1))).norm() <= kStraight * part_.size();
}

/// Whether the generators of a part with two pieces are straight and the normal is constant along each.
bool CurvedHull::has_developable_sides() const {
  for (int k = 0; k < kGenerators; ++k) {
    auto at = [&](double turn, int piece) {
      const double angle = 2 * kPi * k / kGenerators + turn;
      return undeformed({std::cos(angle), std::sin(angle), 0}, piece);
    };
    Eigen::Matrix<double, 3, 4> e;
    e << at(-kRimAngle, 0), at(kRimAngle, 0), at(-kRimAngle, 1), at(kRimAngle, 1);
    if (!is_straight(at(0, 0), at(0, 1))) return false;
    PartEvaluation::ChainImages images;
    part_.apply_chain(e, values_, images);
    const Vec3<double> along = images.x.col(2) + images.x.col(3) - images.x.col(0) - images.x.col(1);
    const Vec3<double> of_first = Vec3<double>(images.x.col(1) - images.x.col(0)).cross(along),
                       of_last = Vec3<double>(images.x.col(3) - images.x.col(2)).cross(along);
    const double norms = of_first.norm() * of_last.norm();  // zero at a tip
    if (of_first.cross(of_last).norm() > kSameNormal * norms || of_first.dot(of_last) < 0) return false;
  }
  return true;
}

/// Whether the edges of a box are straight, and the corners and the middle of every face are in one plane.
bool CurvedHull::has_plane_faces() const {
  const Vec3<double> any = Vec3<double>::UnitX();
  for (const int bit : {1, 2, 4})
    for (const int side : {0, bit}) {
      const int one = bit == 1 ? 2 : 1, other = bit == 4 ? 2 : 4;
      Eigen::Matrix<double, 3, 4> e;
      e << undeformed(any, side), undeformed(any, side | one), undeformed(any, side | other),
          undeformed(any, side | one | other);
      for (const auto& [from, to] : {std::pair{0, 1}, {0, 2}, {1, 3}, {2, 3}})
        if (!is_straight(e.col(from), e.col(to))) return false;
      PartEvaluation::ChainImages corners, middle;
      part_.apply_chain(e, values_, corners);
      e.colwise() = e.rowwise().mean().eval();
      part_.apply_chain(e, values_, middle);
      const Vec3<double> origin = corners.x.col(0);
      const Vec3<double> n =
          Vec3<double>(corners.x.col(1) - origin).cross(Vec3<double>(corners.x.col(2) - origin)).normalized();
      for (const Vec3<double>& x : {Vec3<double>(corners.x.col(3)), Vec3<double>(middle.x.col(0))})
        if (std::abs(n.dot(x - origin)) > kStraight * part_.size()) return false;
    }
  return true;
}

CurvedHull::Axis CurvedHull::axis() const {
  const double half = shape_.half_height(values_.b.data());
  Axis axis;
  axis.turn = axis.largest_turn = 0;
  Eigen::Matrix<double, 3, 4> e = Eigen::Matrix<double, 3, 4>::Zero();
  PartEvaluation::ChainImages images;
  for (int first = 0; first < Axis::kPlaces; first += 4) {
    for (int k = 0; k < 4; ++k) e(2, k) = half * (1 - 2.0 * (first + k) / (Axis::kPlaces - 1));
    part_.apply_chain(e, values_, images);
    std::copy(images.F.begin(), images.F.end(), axis.F.begin() + first);
  }
  for (std::size_t k = 1; k < axis.F.size(); ++k) {
    const double turn = turn_between(axis.F[k - 1], axis.F[k]);
    axis.turn += turn;
    axis.largest_turn = std::max(axis.largest_turn, turn);
  }
  return axis;
}

int CurvedHull::Axis::intervals() const {
  return std::min(kMaxIntervals, 1 + static_cast<int>(turn / kTurnOfInterval));
}

void CurvedHull::add_local_points(const Vec3<double>& m, int end_face, const PointLimits& limits,
                                  std::vector<Vec3<double>>& points) const {
  if (shape_.hull_pieces() == 1) return add_hills(m, limits, points);
  if (shape_.hull_pieces() == 2) return add_side(m, end_face, limits, points);
  // The sections of a box stay plane, so that only its edges along z become curved. These edges join pieces
  // (corners) whose numbers differ in the third bit (shape/box.h).
  const int n = std::max(3, axis().intervals());
  for (int piece = 0; piece < 4; ++piece) add_edge(m, {piece, piece | 4}, n, limits, points);
}

/// Appends the points of a part with one piece: Newton's method starts from the sample points that are
/// farther than their neighbours.
void CurvedHull::add_hills(const Vec3<double>& m, const PointLimits& limits,
                           std::vector<Vec3<double>>& points) const {
  const SphereSamples& samples = SphereSamples::shared();
  const Vec3<double> half = half_sizes();
  std::array<double, SphereSamples::kCount> heights;
  Eigen::Matrix<double, 3, 4> e;
  PartEvaluation::ChainImages images;
  for (std::size_t start = 0; start < heights.size(); start += 4) {
    const std::size_t count = std::min<std::size_t>(4, heights.size() - start);
    for (std::size_t k = 0; k < 4; ++k)
      e.col(static_cast<Eigen::Index>(k)) =
          undeformed(sample_normal(start + std::min(k, count - 1), half), 0);
    part_.apply_chain(e, values_, images);
    for (std::size_t k = 0; k < count; ++k)
      heights[start + k] = m.dot(images.x.col(static_cast<Eigen::Index>(k)));
  }
  for (std::size_t k = 0; k < heights.size(); ++k) {
    bool is_hill = true;
    double least = heights[k];
    for (const int neighbour : samples.neighbours[k]) {
      const auto other = static_cast<std::size_t>(neighbour);
      // Of equally high neighbours the first one is a start.
      is_hill = is_hill && (heights[other] < heights[k] || (heights[other] == heights[k] && k < other));
      least = std::min(least, heights[other]);
    }
    // The surface is assumed to rise above this sample by no more than the sample is above its lowest
    // neighbour.
    if (is_hill && 2 * heights[k] - least >= limits.least_height)
      add_farthest(m, image_.farthest(m, {0, 0}, 0, sample_normal(k, half), false).x, limits, points);
  }
}

/// Appends the ends of the farthest generator of a part with two pieces, and the points between them.
void CurvedHull::add_side(const Vec3<double>& m, int end_face, const PointLimits& limits,
                          std::vector<Vec3<double>>& points) const {
  const PieceFamily side{0, 1};
  const Axis axis = this->axis();
  const int n = axis.intervals();
  Stations stations;
  for (int k = 0; k <= n; ++k) {
    const double share = static_cast<double>(k) / n;
    const auto place = static_cast<std::size_t>(std::lround(share * (Axis::kPlaces - 1)));
    const Vec3<double> start = (axis.F[place].transpose() * m).normalized();
    stations[static_cast<std::size_t>(k)] = image_.farthest(m, side, share, start, false);
  }
  if (end_face != 0) add_farthest(m, stations[0].x, limits, points);
  if (end_face != 1) add_farthest(m, stations[static_cast<std::size_t>(n)].x, limits, points);
  add_inner(m, side, stations, n, limits, points);
}

/// Appends the ends of an edge of a box and the points between them. n: number of intervals, at least 3.
void CurvedHull::add_edge(const Vec3<double>& m, const PieceFamily& edge, int n, const PointLimits& limits,
                          std::vector<Vec3<double>>& points) const {
  const Vec3<double> from = undeformed(m, edge.one), to = undeformed(m, edge.other);
  Eigen::Matrix<double, 3, 4> e;
  PartEvaluation::ChainImages images;
  Stations stations;
  for (int k = 0; k <= n; ++k) {
    const int lane = k % 4;
    if (lane == 0) {
      for (int i = 0; i < 4; ++i)
        e.col(i) = from + std::min(1.0, static_cast<double>(k + i) / n) * (to - from);
      part_.apply_chain(e, values_, images);
    }
    ImagePoint& here = stations[static_cast<std::size_t>(k)];
    here.normal = m;
    here.share = static_cast<double>(k) / n;
    here.x = images.x.col(lane);
    here.slope_share = m.dot(images.F[static_cast<std::size_t>(lane)] * (to - from));
  }
  add_farthest(m, stations[0].x, limits, points);
  add_farthest(m, stations[static_cast<std::size_t>(n)].x, limits, points);
  add_inner(m, edge, stations, n, limits, points);
}

/// Appends the points of a family, between its first and its last member, that are farther than the points
/// near them. stations: the farthest points of n + 1 members. If a curved interval is level, its middle is
/// appended, so that a bent rod has three contact points or more.
void CurvedHull::add_inner(const Vec3<double>& m, const PieceFamily& family, const Stations& stations, int n,
                           const PointLimits& limits, std::vector<Vec3<double>>& points) const {
  const double level = kLevelSlope * part_.size();
  for (int k = 0; k < n; ++k) {
    const ImagePoint &before = stations[static_cast<std::size_t>(k)],
                     &after = stations[static_cast<std::size_t>(k) + 1];
    const bool from_level = std::abs(before.slope_share) <= level,
               to_level = std::abs(after.slope_share) <= level;
    ImagePoint middle = before;
    middle.share = (k + 0.5) / n;
    middle.normal = (before.normal + after.normal).normalized();
    if (from_level && to_level) {
      const Vec3<double> x = image_.farthest(m, family, middle.share, middle.normal, false).x;
      if ((x - 0.5 * (before.x + after.x)).norm() > limits.one_point) add_farthest(m, x, limits, points);
    } else if (before.slope_share > level && after.slope_share < -level) {
      // The rise above the ends is estimated as half of the change of the slope times the length of the
      // interval.
      const double rise = 0.5 / n * (before.slope_share - after.slope_share);
      if (std::max(m.dot(before.x), m.dot(after.x)) + rise < limits.least_height) continue;
      if (const std::optional<ImagePoint> point = image_.between(m, family, middle))
        add_farthest(m, point->x, limits, points);
    }
    if (to_level && k + 1 < n) add_farthest(m, after.x, limits, points);
  }
}

}  // namespace pliant
