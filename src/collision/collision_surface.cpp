// Sample points of a part, and the search for the lowest points of a field on its surface.
#include <pliant/collision/collision_surface.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>

#include "collision/features/feature_pair.h"
#include "collision/hull/hull.h"

#include <Eigen/Geometry>

namespace pliant {

namespace {

/// Edges of the sample mesh along an eighth of a great circle.
constexpr int kSurfaceResolution = 6;
/// The reach of a part with dynamic parameters is estimated from a coarse mesh with kCoarseEdges edges along
/// an eighth of a great circle. The estimate is the largest distance of a mesh point from the origin, times
/// kCoarseMargin.
constexpr int kCoarseEdges = 2;
constexpr double kCoarseMargin = 1.1;
/// Largest distance of the surface from the chords between its sample points, in sizes of the part
/// (Part::size(), its largest half extent).
constexpr double kSurfaceSag = 0.02;
/// Largest height of the lowest sample point over the lowest surface point, in sizes. The largest value
/// occurs where two thin parts cross.
constexpr double kThinSag = 0.1;
/// Sample points whose heights differ by at most this, in sizes of the part, are equally low.
constexpr double kSameHeight = 1e-6;
/// Points nearer to each other than kSamePlace, in sizes, are merged. Two points that are not merged are on
/// one flat face if the middle of their chord is at most kFlatChord below the surface, in sizes.
constexpr double kSamePlace = 0.02, kFlatChord = 1e-6;
/// The test whether a sample point is already the lowest point uses a stencil with a radius of kCorner, in
/// units of CollisionSurface::spacing_ (for MeshPattern::ball, twice the angle between neighbouring sample
/// points). Differences of heights up to kHeightRounding, in sizes, are ignored as rounding errors. They
/// would otherwise start a search on a flat face.
constexpr double kCorner = 1e-3, kHeightRounding = 1e-14;
/// A stencil whose second difference of heights is smaller than this, in sizes, is flat.
constexpr double kFlatStencil = 1e-13;
/// The search ends at this radius of its stencil, in units of CollisionSurface::spacing_.
constexpr double kMinStencil = 1e-8;
/// A direction is near a pole if the sine of its angle to the z axis is at most this. Latitude and longitude
/// are not used near a pole.
constexpr double kNearPole = 0.2;
constexpr int kMaxStencilHalvings = 60;

/// Nine places around a centre. The first coordinate of Chart changes fastest. A place is the argument of
/// ShapeInterface::mesh_label(): a direction, or the pair of angles of a torus.
using Stencil = std::array<Vec3<double>, 9>;

/// Two coordinates for the places around a sample point. For MeshPattern::ball (all shapes except the torus)
/// they are latitude and longitude, because rims and edges follow these; near the poles they are offsets
/// along any two tangents. On a torus they are u and v. Towards the poles the second coordinate is longitude
/// divided by a factor above 1, because the sample points of a circle of latitude are farther apart in
/// longitude there.
class Chart {
 public:
  Chart(const Vec3<double>& start, bool ball) : start_(start) {
    const double across = start.head<2>().norm();
    by_angles_ = ball && across > kNearPole * start.norm();
    if (by_angles_) {
      latitude_ = std::atan2(start[2], across);
      longitude_ = std::atan2(start[1], start[0]);
      widening_ = std::max(1.0, 0.25 * kPi / (0.5 * kPi - std::abs(latitude_)));
    } else if (ball) {
      e1_ = start.unitOrthogonal();
      e2_ = start.normalized().cross(e1_);
    }
  }
  /// Returns the largest distance of the search from the sample point in each coordinate, in units of
  /// CollisionSurface::spacing_. In the second coordinate of a chart of latitude and longitude it is 2,
  /// because circles of latitude are shorter than great circles.
  Eigen::Vector2d farthest() const { return {1, by_angles_ ? 2 : 1}; }
  Vec3<double> place(const Eigen::Vector2d& x) const {
    if (!by_angles_ || x.isZero(0)) return start_ + x[0] * e1_ + x[1] * e2_;
    return at_angles(up(x[0]), round(x[1]));
  }
  Stencil stencil(const Eigen::Vector2d& at, double size) const {
    Stencil places;
    std::array<Direction, 3> ups, rounds;
    for (std::size_t k = 0; k < 3 && by_angles_; ++k) {
      const double offset = size * (static_cast<double>(k) - 1);
      ups[k] = up(at[0] + offset);
      rounds[k] = round(at[1] + offset);
    }
    for (std::size_t j = 0; j < 9; ++j)
      places[j] = by_angles_ ? at_angles(ups[j % 3], rounds[j / 3])
                             : place(at + size * Eigen::Vector2d(static_cast<double>(j % 3) - 1,
                                                                 static_cast<double>(j / 3) - 1));
    if (at.isZero(0)) places[4] = start_;
    return places;
  }

 private:
  struct Direction {
    double cos, sin;
  };
  Direction up(double x) const { return {std::cos(latitude_ + x), std::sin(latitude_ + x)}; }
  Direction round(double y) const {
    return {std::cos(longitude_ + widening_ * y), std::sin(longitude_ + widening_ * y)};
  }
  static Vec3<double> at_angles(const Direction& up, const Direction& round) {
    return {up.cos * round.cos, up.cos * round.sin, up.sin};
  }

  Vec3<double> start_, e1_{1, 0, 0}, e2_{0, 1, 0};
  bool by_angles_;
  double latitude_ = 0, longitude_ = 0, widening_ = 1;
};

/// Returns the steps from the centre of a stencil to the minima of quadratics that fit its heights h (m), in
/// stencil radii. No component of a step exceeds 1. Two quadratics depend on one coordinate each; they suit
/// rims and level lines of a surface. A third one depends on both coordinates. A quadratic whose second
/// difference is at most `flat` (m) in some direction is skipped.
std::vector<Eigen::Vector2d> steps_to_lowest(const Vec<double, 9>& h, double flat) {
  std::vector<Eigen::Vector2d> steps;
  auto add = [&](const Eigen::Vector2d& step) {
    const double max_gap = step.lpNorm<Eigen::Infinity>();
    steps.push_back(max_gap > 1 ? Eigen::Vector2d(step / max_gap) : step);
  };
  for (const auto& [before, after, axis] : {std::tuple{3, 5, 0}, std::tuple{1, 7, 1}}) {
    const double curvature = h[before] + h[after] - 2 * h[4];
    if (curvature > flat) add((h[before] - h[after]) / (2 * curvature) * Eigen::Vector2d::Unit(axis));
  }
  // h = h_0 + g.d + 1/2 d.H d by least squares over the stencil.
  const Eigen::Vector2d g((h[2] + h[5] + h[8] - h[0] - h[3] - h[6]) / 6,
                          (h[6] + h[7] + h[8] - h[0] - h[1] - h[2]) / 6);
  Eigen::Matrix2d H;
  H(0, 0) = (h[0] + h[2] + h[3] + h[5] + h[6] + h[8] - 2 * (h[1] + h[4] + h[7])) / 3;
  H(1, 1) = (h[0] + h[1] + h[2] + h[6] + h[7] + h[8] - 2 * (h[3] + h[4] + h[5])) / 3;
  H(0, 1) = H(1, 0) = (h[0] + h[8] - h[2] - h[6]) / 4;
  if (H.trace() > 0 && H.determinant() > flat * H.trace()) add(-H.inverse() * g);
  return steps;
}

/// Returns the outermost of some points, at most four: the point A farthest from the first of them, the point
/// B farthest from A, and on either side of the line through A and B the point farthest from this line. some:
/// column numbers of p. Of points nearer than `same` (m) to each other one is returned.
std::vector<Eigen::Index> outermost(const Eigen::Matrix3Xd& p, const std::vector<Eigen::Index>& some,
                                    double same) {
  std::vector<Eigen::Index> chosen;
  auto farthest = [&](auto&& distance) {
    Eigen::Index best = some.front();
    for (const Eigen::Index i : some)
      if (distance(i) > distance(best) + 1e-9 * same) best = i;
    return best;
  };
  auto add = [&](Eigen::Index i) {
    for (const Eigen::Index j : chosen)
      if ((p.col(i) - p.col(j)).norm() < same) return;
    chosen.push_back(i);
  };
  const Eigen::Index corner =
      farthest([&](Eigen::Index i) { return (p.col(i) - p.col(some.front())).norm(); });
  const Eigen::Index other = farthest([&](Eigen::Index i) { return (p.col(i) - p.col(corner)).norm(); });
  add(corner);
  add(other);
  const Vec3<double> along = (p.col(other) - p.col(corner)).normalized();
  auto offset = [&](Eigen::Index i) -> Vec3<double> {
    const Vec3<double> d = p.col(i) - p.col(corner);
    return d - d.dot(along) * along;
  };
  const Eigen::Index side = farthest([&](Eigen::Index i) { return offset(i).norm(); });
  const Vec3<double> across = offset(side);
  if (across.norm() < same) return chosen;
  add(side);
  add(farthest([&](Eigen::Index i) { return -offset(i).dot(across) / across.norm(); }));
  return chosen;
}

}  // namespace

CollisionSurface::CollisionSurface(const Part& part)
    : part_(&part), spacing_(0.5 * kPi / kSurfaceResolution) {
  if (const std::optional<Vec3<double>> axes = semi_axes(part.parameters().rest())) {
    thickness_ = 2 * axes->minCoeff();
  } else if (const ParameterValues<double> values = part.parameters().rest();
             Hull::is_affine(part) && Hull::exists(part, values)) {
    thickness_ = Hull(part, values, Hull::Convexity::convex).extents().minCoeff();
  } else {
    thickness_ = (rest_points().rowwise().maxCoeff() - rest_points().rowwise().minCoeff()).minCoeff();
  }
}

CollisionSurface::~CollisionSurface() = default;

const PartPatches* CollisionSurface::rest_patches() const {
  if (!patches_known_) patches_ = PartPatches::make(*part_, part_->parameters().rest());
  patches_known_ = true;
  return patches_.get();
}

const CollisionSurface::Samples& CollisionSurface::samples() const {
  if (!samples_) {
    Surface surface(*part_, kSurfaceResolution);
    Eigen::Matrix3Xd p = part_->s(surface.material(), part_->parameters().rest());
    const double sag = kSurfaceSag * part_->size();
    const Eigen::AlignedBox3d box(p.rowwise().minCoeff().array() - sag, p.rowwise().maxCoeff().array() + sag);
    const double reach = (1 + kSurfaceSag) * p.colwise().norm().maxCoeff();
    std::vector<Material<double>> coarse;
    if (part_->parameters().n_dynamic() > 0) coarse = Surface(*part_, kCoarseEdges).material();
    samples_.emplace(Samples{std::move(surface), std::move(p), box, reach, std::move(coarse)});
  }
  return *samples_;
}

std::optional<Vec3<double>> CollisionSurface::semi_axes(const ParameterValues<double>& values) const {
  if (!part_->parameters().links().empty()) return std::nullopt;
  return part_->shape().semi_axes(values.b.data());
}

std::optional<Vec3<double>> CollisionSurface::half_sizes(const ParameterValues<double>& values) const {
  if (!part_->parameters().links().empty()) return std::nullopt;
  return part_->shape().half_sizes(values.b.data());
}

CollisionSurface::LowPoint CollisionSurface::ellipsoid_point(const ParameterValues<double>& values,
                                                             const Vec3<double>& axes,
                                                             const Vec3<double>& y) const {
  return {part_->shape().mesh_label(y, values.b.data()), axes.cwiseProduct(y), 0};
}

double CollisionSurface::reach(const ParameterValues<double>& values) const {
  if (const std::optional<Vec3<double>> axes = semi_axes(values)) return axes->maxCoeff();
  if (part_->parameters().n_dynamic() == 0) return samples().reach;
  return kCoarseMargin * part_->s(samples().coarse, values).colwise().norm().maxCoeff();
}

// This function is longer than 60 lines, because every stage of the pattern search uses the stencil, the best
// point and the radius. Small functions would have to pass these three to each other.
CollisionSurface::LowPoint CollisionSurface::descend(const ParameterValues<double>& values, Eigen::Index i,
                                                     const Field& field) const {
  // A stencil of three by three places surrounds the best point. Quadratics through its heights propose the
  // next point.
  const Chart chart(samples().surface.places()[static_cast<std::size_t>(i)],
                    part_->shape().mesh() == MeshPattern::ball);
  auto material = [&](const Vec3<double>& place) {
    return part_->shape().mesh_label(place, values.b.data());
  };
  Eigen::Vector2d at(0, 0);
  LowPoint best;
  std::vector<Material<double>> stencil(9);
  auto evaluate_stencil = [&](double size) {
    const Stencil places = chart.stencil(at, size);
    for (std::size_t j = 0; j < 9; ++j) stencil[j] = material(places[j]);
    return part_->s(stencil, values);
  };
  using Heights = Vec<double, 9>;
  auto heights = [&](const Eigen::Matrix3Xd& p) {
    Heights h;
    for (int k = 0; k < 9; ++k) h[k] = field.descent(p.col(k));
    return h;
  };
  const double rounding = kHeightRounding * part_->size();
  const Eigen::Vector2d farthest = spacing_ * chart.farthest();
  double radius = 0.5 * spacing_;
  // The lowest point of a corner, an edge or a face is often a sample point already.
  auto is_lowest = [&] {
    const Eigen::Matrix3Xd p = evaluate_stencil(kCorner * spacing_);
    const Heights h = heights(p);
    best = {stencil[4], p.col(4), h[4]};
    return h.minCoeff() >= h[4] - rounding;
  };
  if (is_lowest()) return best;
  std::vector<Material<double>> next_materials;
  for (int k = 0; k < kMaxStencilHalvings && radius > kMinStencil * spacing_; ++k) {
    const Eigen::Matrix3Xd p = evaluate_stencil(radius);
    const Heights h = heights(p);
    Eigen::Vector2d next = at;
    bool good = false;
    auto accept = [&](const Material<double>& m, const Vec3<double>& p_there, double height,
                      const Eigen::Vector2d& there) {
      best = {m, p_there, height};
      next = there;
    };
    Eigen::Index lowest = 4;
    h.minCoeff(&lowest);
    if (h[lowest] < best.height - rounding)
      accept(stencil[static_cast<std::size_t>(lowest)], p.col(lowest), h[lowest],
             at + radius * Eigen::Vector2d(static_cast<double>(lowest % 3) - 1,
                                           static_cast<double>(lowest / 3) - 1));
    const std::vector<Eigen::Vector2d> steps = steps_to_lowest(h, kFlatStencil * part_->size());
    if (steps.empty() && next == at) break;
    next_materials.clear();
    for (const Eigen::Vector2d& step : steps)
      next_materials.push_back(material(chart.place(at + radius * step)));
    const Eigen::Matrix3Xd p_next = part_->s(next_materials, values);
    for (std::size_t j = 0; j < steps.size(); ++j) {
      const auto column = static_cast<Eigen::Index>(j);
      const double height = field.descent(p_next.col(column));
      if (height > best.height + rounding) continue;
      accept(next_materials[j], p_next.col(column), height, at + radius * steps[j]);
      good = steps[j].lpNorm<Eigen::Infinity>() < 0.5;
    }
    next = next.cwiseMax(-farthest).cwiseMin(farthest);
    const Eigen::Array2d spacings = at / spacing_;
    if (next == at && (spacings == spacings.round()).all() && is_lowest()) return best;
    const bool moves_little = (next - at).norm() <= 0.5 * radius;
    at = next;
    if (good)
      radius *= 0.1;
    else if (moves_little)
      radius *= 0.4;
  }
  return best;
}

std::vector<CollisionSurface::LowPoint> CollisionSurface::low_points(const ParameterValues<double>& values,
                                                                     const Eigen::Matrix3Xd& p,
                                                                     const VecX<double>& heights,
                                                                     double max_gap,
                                                                     const Field& field) const {
  const double size = part_->size(), lowest = heights.minCoeff();
  std::vector<LowPoint> found;
  if (lowest > max_gap + kThinSag * size) return found;
  auto within = [&](double band) {
    std::vector<Eigen::Index> some;
    for (Eigen::Index i = 0; i < heights.size(); ++i)
      if (heights[i] <= lowest + band) some.push_back(i);
    return some;
  };
  auto add = [&](const LowPoint& point) {
    for (LowPoint& other : found)
      if ((other.p - point.p).norm() < kSamePlace * size) {
        if (point.height < other.height) other = point;
        return;
      }
    found.push_back(point);
  };
  std::vector<Eigen::Index> seeds;
  for (const double band : {kSameHeight * size, kSurfaceSag * size})
    for (const Eigen::Index i : outermost(p, within(band), kSamePlace * size))
      if (std::find(seeds.begin(), seeds.end(), i) == seeds.end()) seeds.push_back(i);
  // On a flat face the search would move from a corner along the face. The part is supported at the corners
  // of the face. Therefore a sample point that is low enough replaces the result of its search.
  auto on_one_face = [&](const Vec3<double>& a, const Vec3<double>& b) {
    return (a - b).norm() >= kSamePlace * size &&
           thickness_ * part_->inside_outside(0.5 * (a + b), values) > -kFlatChord * size;
  };
  LowPoint deepest;
  deepest.height = max_gap + size;
  for (const Eigen::Index i : seeds) {
    LowPoint point = descend(values, i, field);
    point.height = field.height(point.p);
    if (point.height < deepest.height) deepest = point;
    if (!(heights[i] > max_gap) && on_one_face(p.col(i), point.p))
      point = {
          part_->shape().mesh_label(samples().surface.places()[static_cast<std::size_t>(i)], values.b.data()),
          p.col(i), heights[i]};
    add(point);
  }
  if (!found.empty()) add(deepest);
  found.erase(
      std::remove_if(found.begin(), found.end(), [&](const LowPoint& q) { return q.height > max_gap; }),
      found.end());
  return found;
}

}  // namespace pliant
