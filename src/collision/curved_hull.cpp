// Hulls of parts whose chain of deformations is not affine (taper, twist, bend): the test of convexity, and
// the points that are farthest in a direction among the points near them.
#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "hull.h"
#include "sphere_samples.h"

namespace pliant {

namespace {

/// A side is straight if its middle is at most this far from its chord, in sizes.
constexpr double kStraight = 1e-12;
/// A generator or edge is level if its height changes by at most this share of its length.
constexpr double kLevelSlope = 1e-9;
/// Generators and edges are divided so that the map turns by about this angle (rad) within an interval.
constexpr double kTurnOfInterval = 1;
/// Most intervals of a generator or edge.
constexpr int kMaxIntervals = 16;
/// Number of generators in the test of convexity.
constexpr int kGenerators = 8;

/// Returns the edges of a box: the pieces at their ends differ in one bit of their numbers (shape/box.h).
const std::array<PieceFamily, 12>& edges_of_box() {
  static const std::array<PieceFamily, 12> edges = [] {
    std::array<PieceFamily, 12> all{};
    std::size_t n = 0;
    for (int i = 0; i < 8; ++i)
      for (const int bit : {1, 2, 4})
        if ((i & bit) == 0) all[n++] = {i, i | bit};
    return all;
  }();
  return edges;
}

/// Returns about the largest angle (rad) between equal columns of two matrices.
double turn_between(const Mat3<double>& F, const Mat3<double>& G) {
  return (F.colwise().normalized() - G.colwise().normalized()).colwise().norm().maxCoeff();
}

}  // namespace

bool Hull::test_convexity() const {
  if (!shape_->is_convex(a_)) return false;
  if (map_ != Map::curved) return true;
  const SphereSamples& samples = SphereSamples::shared();
  if (pieces() == 1)
    return std::all_of(samples.directions.begin(), samples.directions.end(),
                       [&](const Vec3<double>& nu) { return image_.is_convex_at(nu, 0); });
  auto is_straight = [&](const Vec3<double>& from, const Vec3<double>& to) {
    Eigen::Matrix<double, 3, 4> e;
    e << from, to, 0.5 * (from + to), from;
    PartEvaluation::ChainImages images;
    part_->apply_chain(e, *values_, images);
    return (images.x.col(2) - 0.5 * (images.x.col(0) + images.x.col(1))).norm() <= kStraight * size_;
  };
  if (pieces() == 2) {
    for (int k = 0; k < kGenerators; ++k) {
      const double angle = 2 * kPi * k / kGenerators;
      const Vec3<double> nu(std::cos(angle), std::sin(angle), 0);
      if (!is_straight(shape_->support(nu, a_, 0), shape_->support(nu, a_, 1))) return false;
    }
    const bool are_points = has_end_faces();  // rims, which an affine map of each section keeps convex
    return are_points ||
           std::all_of(samples.directions.begin(), samples.directions.end(),
                       [&](const Vec3<double>& nu) { return image_.is_convex_at(nu, nu[2] >= 0 ? 0 : 1); });
  }
  const std::array<PieceFamily, 12>& edges = edges_of_box();
  const Vec3<double> any = Vec3<double>::UnitX();
  auto corner = [&](int piece) -> Vec3<double> { return shape_->support(any, a_, piece); };
  return std::all_of(
             edges.begin(), edges.end(),
             [&](const PieceFamily& edge) { return is_straight(corner(edge.one), corner(edge.other)); }) &&
         has_plane_faces();
}

/// Whether the corners and the middle of every face of a box are in one plane.
bool Hull::has_plane_faces() const {
  const Vec3<double> m = Vec3<double>::UnitX();
  for (const int bit : {1, 2, 4})
    for (const int side : {0, bit}) {
      const int one = bit == 1 ? 2 : 1, other = bit == 4 ? 2 : 4;
      Eigen::Matrix<double, 3, 4> e;
      e << shape_->support(m, a_, side), shape_->support(m, a_, side | one),
          shape_->support(m, a_, side | other), shape_->support(m, a_, side | one | other);
      PartEvaluation::ChainImages corners, middle;
      part_->apply_chain(e, *values_, corners);
      e.colwise() = e.rowwise().mean().eval();
      part_->apply_chain(e, *values_, middle);
      const Vec3<double> origin = corners.x.col(0);
      const Vec3<double> n = (corners.x.col(1) - origin).cross(corners.x.col(2) - origin).normalized();
      for (const Vec3<double>& x : {Vec3<double>(corners.x.col(3)), Vec3<double>(middle.x.col(0))})
        if (std::abs(n.dot(x - origin)) > kStraight * size_) return false;
    }
  return true;
}

/// Appends the points of a part with one piece: Newton's method starts from the sample points that are
/// farther than their neighbours.
void Hull::add_hills(const Vec3<double>& m, const Needed& needed, std::vector<Vec3<double>>& points) const {
  const SphereSamples& samples = SphereSamples::shared();
  std::array<double, SphereSamples::kCount> heights;
  Eigen::Matrix<double, 3, 4> e;
  PartEvaluation::ChainImages images;
  for (std::size_t start = 0; start < heights.size(); start += 4) {
    const std::size_t count = std::min<std::size_t>(4, heights.size() - start);
    for (std::size_t k = 0; k < 4; ++k)
      e.col(static_cast<Eigen::Index>(k)) =
          shape_->support(samples.directions[start + std::min(k, count - 1)], a_, 0);
    part_->apply_chain(e, *values_, images);
    for (std::size_t k = 0; k < count; ++k)
      heights[start + k] = m.dot(images.x.col(static_cast<Eigen::Index>(k)));
  }
  for (std::size_t k = 0; k < heights.size(); ++k) {
    const std::vector<int>& near = samples.neighbours[k];
    if (std::none_of(near.begin(), near.end(),
                     [&](int other) { return heights[static_cast<std::size_t>(other)] > heights[k]; }))
      add_farthest(m, image_.farthest(m, {0, 0}, 0, samples.directions[k], false).x, needed, points);
  }
}

/// The chain along the z axis.
struct Hull::Axis {
  static constexpr int kPlaces = 8;
  std::array<Mat3<double>, kPlaces> F;  ///< dT/de at equal distances, from the upper end to the lower one
  int intervals;                        ///< number of intervals into which generators and edges are divided
};

Hull::Axis Hull::axis() const {
  const double half = shape_->half_height(a_);
  Axis axis;
  Eigen::Matrix<double, 3, 4> e = Eigen::Matrix<double, 3, 4>::Zero();
  PartEvaluation::ChainImages images;
  double turn = 0;
  for (int first = 0; first < Axis::kPlaces; first += 4) {
    for (int k = 0; k < 4; ++k) e(2, k) = half * (1 - 2.0 * (first + k) / (Axis::kPlaces - 1));
    part_->apply_chain(e, *values_, images);
    std::copy(images.F.begin(), images.F.end(), axis.F.begin() + first);
  }
  for (std::size_t k = 1; k < Axis::kPlaces; ++k) turn += turn_between(axis.F[k - 1], axis.F[k]);
  axis.intervals = std::min(kMaxIntervals, 1 + static_cast<int>(turn / kTurnOfInterval));
  return axis;
}

/// Appends the points of a part that is not convex.
void Hull::add_local_points(const Vec3<double>& m, int end_face, const Needed& needed,
                            std::vector<Vec3<double>>& points) const {
  if (pieces() == 1) return add_hills(m, needed, points);
  if (pieces() == 2) return add_side(m, end_face, needed, points);
  const int n = std::max(3, axis().intervals);
  for (const PieceFamily& edge : edges_of_box()) add_edge(m, edge, n, needed, points);
}

/// Appends the ends of the generators of a part with two pieces, and the points between them that are farther
/// than those near them. A level generator that is curved gets its middle, so that a bent rod lies on three
/// points.
void Hull::add_side(const Vec3<double>& m, int end_face, const Needed& needed,
                    std::vector<Vec3<double>>& points) const {
  const PieceFamily side{0, 1};
  const Axis axis = this->axis();
  const int n = axis.intervals;
  auto at = [&](double share) {
    const auto place = static_cast<std::size_t>(std::lround(share * (Axis::kPlaces - 1)));
    return image_.farthest(m, side, share, (axis.F[place].transpose() * m).normalized(), false);
  };
  ImagePoint before = at(0);
  if (end_face != 0) add_farthest(m, before.x, needed, points);
  for (int k = 1; k <= n; ++k) {
    const ImagePoint after = at(static_cast<double>(k) / n);
    add_between(m, side, before, after, needed, points);
    const bool is_end = k == n;
    if (is_end ? end_face != 1 : std::abs(after.slope_share) <= kLevelSlope * size_)
      add_farthest(m, after.x, needed, points);
    before = after;
  }
}

/// Appends the ends of an edge, and the points between them that are farther than those near them. The edge
/// is divided into n intervals.
void Hull::add_edge(const Vec3<double>& m, const PieceFamily& edge, int n, const Needed& needed,
                    std::vector<Vec3<double>>& points) const {
  const Vec3<double> from = shape_->support(m, a_, edge.one), to = shape_->support(m, a_, edge.other);
  Eigen::Matrix<double, 3, 4> e;
  PartEvaluation::ChainImages images;
  ImagePoint before;
  for (int k = 0; k <= n; ++k) {
    const int lane = k % 4;
    if (lane == 0) {
      for (int i = 0; i < 4; ++i)
        e.col(i) = from + std::min(1.0, static_cast<double>(k + i) / n) * (to - from);
      part_->apply_chain(e, *values_, images);
    }
    ImagePoint here;
    here.normal = m;
    here.share = static_cast<double>(k) / n;
    here.x = images.x.col(lane);
    here.slope_share = m.dot(images.F[static_cast<std::size_t>(lane)] * (to - from));
    if (k > 0) add_between(m, edge, before, here, needed, points);
    if (k == 0 || k == n) add_farthest(m, here.x, needed, points);
    before = here;
  }
}

/// Appends the farthest point of a family between two of its members, if it is farther than both.
void Hull::add_between(const Vec3<double>& m, const PieceFamily& family, const ImagePoint& before,
                       const ImagePoint& after, const Needed& needed,
                       std::vector<Vec3<double>>& points) const {
  const double level = kLevelSlope * size_, interval = after.share - before.share;
  const bool is_level = std::abs(before.slope_share) <= level && std::abs(after.slope_share) <= level;
  if (!is_level && !(before.slope_share > level && after.slope_share < -level)) return;
  // The tangents at both ends are above the curve.
  if (std::min(m.dot(before.x) + before.slope_share * interval,
               m.dot(after.x) - after.slope_share * interval) < needed.height)
    return;
  ImagePoint middle = before;
  middle.share = 0.5 * (before.share + after.share);
  middle.normal = (before.normal + after.normal).normalized();
  if (is_level) {
    const Vec3<double> x = image_.farthest(m, family, middle.share, middle.normal, false).x;
    if ((x - 0.5 * (before.x + after.x)).norm() > needed.one_point) add_farthest(m, x, needed, points);
  } else if (const std::optional<ImagePoint> point = image_.between(m, family, middle)) {
    add_farthest(m, point->x, needed, points);
  }
}

}  // namespace pliant
