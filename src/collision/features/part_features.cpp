#include "part_features.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace pliant {

namespace {

/// Derivatives of the normal and of F = dT/de are finite differences over this distance, in sizes of the
/// part.
constexpr double kJetDifference = 1e-6;
/// Points are within the boundary of a feature if their coordinates exceed it by at most this.
constexpr double kOnBoundary = 1e-9;
/// Least semi-axis of a rim, in sizes of the part. Features of a solid with a smaller rim, such as the tip of
/// a cone, do not exist (exist()).
constexpr double kLeastRim = 1e-3;
/// Largest exponent of a superquadric or torus whose features exist (exist()). With a larger exponent the
/// curvature changes so much between patches that Newton's method often does not converge.
constexpr double kMostPointed = 1.4;
/// Number of patches along an edge of a box, along both directions of a face or end face, and along the
/// generators of a side.
constexpr int kPatchesAlong = 4;

}  // namespace

bool PartFeatures::exist(const Part& part, const ParameterValues<double>& values) {
  const ShapeInterface& shape = part.shape();
  const double* a = values.b.data();
  if (shape.half_sizes(a)) return true;
  if (shape.has_end_faces()) {
    const Vec3<double> x = Vec3<double>::UnitX(), y = Vec3<double>::UnitY();
    auto width = [&](int piece) {
      return std::min(shape.support(x, a, piece)[0], shape.support(y, a, piece)[1]);
    };
    return std::min(width(0), width(1)) > kLeastRim * part.size();
  }
  for (int k = 0; k < shape.n_parameters(); ++k)
    if (shape.parameters()[k].quantity == Quantity::exponent && a[k] > kMostPointed) return false;
  return shape.hull_pieces() > 0 && shape.has_support(a) && !shape.has_flat_regions(a);
}

PartFeatures::PartFeatures(const Part& part, const ParameterValues<double>& values)
    : part_(part), values_(values) {
  const double* a = values_.b.data();
  if (const std::optional<Vec3<double>> half = part.shape().half_sizes(a))
    add_box(*half);
  else if (part.shape().has_end_faces())
    add_round();
  else
    features_.emplace_back();
}

/// Adds the faces, edges and vertices of a box. half: half sizes, m.
void PartFeatures::add_box(const Vec3<double>& half) {
  // Along each axis a feature is at -1 or at 1 (half sizes), or extends from -1 to 1. Of these 27 choices,
  // the one that extends along all three axes is the box itself and no feature.
  for (int choice = 0; choice < 27; ++choice) {
    const std::array<int, 3> side{choice % 3 - 1, choice / 3 % 3 - 1, choice / 9 - 1};
    Feature feature;
    feature.kind = Kind::affine;
    feature.dimension = 0;
    for (int k = 0; k < 3; ++k) {
      if (const int s = side[static_cast<std::size_t>(k)]; s != 0) {
        feature.origin[k] = s * half[k];
        feature.outwards[static_cast<std::size_t>(feature.n_outwards++)] = s * Vec3<double>::Unit(k);
      } else if (feature.dimension < 2) {
        feature.axes.col(feature.dimension++) = half[k] * Vec3<double>::Unit(k);
      }
    }
    if (feature.n_outwards > 0) features_.push_back(feature);
  }
}

/// Adds the features of a solid between two elliptic end faces.
void PartFeatures::add_round() {
  const double* a = values_.b.data();
  for (int end = 0; end < 2; ++end) {
    const Vec3<double> x = part_.shape().support(Vec3<double>(Vec3<double>::UnitX()), a, end),
                       y = part_.shape().support(Vec3<double>(Vec3<double>::UnitY()), a, end);
    rims_[static_cast<std::size_t>(end)] = {x[0], y[1], x[2]};
    Feature face;
    face.kind = Kind::disc;
    face.end = end;
    face.origin[2] = x[2];
    face.n_outwards = 1;
    face.axes(0, 0) = x[0];
    face.axes(1, 1) = y[1];
    face.outwards[0] = (end == 0 ? 1 : -1) * Vec3<double>::UnitZ();
    features_.push_back(face);
    Feature rim;
    rim.kind = Kind::rim;
    rim.dimension = 1;
    rim.end = end;
    features_.push_back(rim);
  }
  Feature side;
  side.kind = Kind::side;
  features_.push_back(side);
}

bool PartFeatures::is_closed(int feature) const {
  const Kind kind = features_[static_cast<std::size_t>(feature)].kind;
  return kind == Kind::smooth || kind == Kind::rim;
}

/// Returns a point of a rim, or its derivative by the angle (rad). derivative: order, 0 (the point), 1 or 2.
Vec3<double> PartFeatures::on_rim(int end, double angle, int derivative) const {
  const Rim& rim = rims_[static_cast<std::size_t>(end)];
  const double turned = angle + 0.5 * kPi * derivative;
  return {rim.a * std::cos(turned), rim.b * std::sin(turned), derivative == 0 ? rim.z : 0};
}

Vec3<double> PartFeatures::position(const Feature& feature, const Eigen::Vector2d& s) const {
  if (feature.kind == Kind::rim) return on_rim(feature.end, s[0], 0);
  if (feature.kind == Kind::side) return (1 - s[1]) * on_rim(0, s[0], 0) + s[1] * on_rim(1, s[0], 0);
  return feature.origin + feature.axes * s;
}

std::vector<FeaturePoint> PartFeatures::grid(int number, double angle, Eigen::Vector2d& step) const {
  const Feature& feature = features_[static_cast<std::size_t>(number)];
  const int around = static_cast<int>(std::ceil(2 * kPi / angle));
  std::array<int, 2> n{1, 1};
  Eigen::Vector2d from(-1, -1), to(1, 1);
  if (feature.kind == Kind::rim || feature.kind == Kind::side) {
    n = {around, feature.kind == Kind::side ? kPatchesAlong : 1};
    from.setZero();
    to << 2 * kPi, 1;
  } else {
    for (std::size_t k = 0; k < static_cast<std::size_t>(feature.dimension); ++k) n[k] = kPatchesAlong;
  }
  step = (to - from).cwiseQuotient(Eigen::Vector2d(n[0], n[1]));
  std::vector<FeaturePoint> points;
  for (int i = 0; i < n[0]; ++i)
    for (int j = 0; j < n[1]; ++j) {
      FeaturePoint point;
      point.feature = number;
      for (int k = 0; k < feature.dimension; ++k) point.s[k] = from[k] + ((k == 0 ? i : j) + 0.5) * step[k];
      point.e = position(feature, point.s);
      points.push_back(point);
    }
  return points;
}

/// Evaluates a point of a smooth solid. Its coordinates are distances along the tangents E of the undeformed
/// surface: e(s) = e + E s - nu s.C s / 2 with the unit normal nu and the curvature C.
void PartFeatures::evaluate_smooth(const Vec3<double>& e, FeatureJet& jet) const {
  const double* a = values_.b.data();
  const ShapeInterface& shape = part_.shape();
  const Vec3<double> gradient = shape.gauge_gradient(e, a);
  const double inverse = 1 / gradient.norm(), step = kJetDifference * part_.size();
  jet.normal = inverse * gradient;
  Eigen::Matrix<double, 3, 2>& E = jet.undeformed_tangents;
  E.col(0) = jet.normal.unitOrthogonal();
  E.col(1) = jet.normal.cross(E.col(0));
  Eigen::Matrix2d C;
  for (int k = 0; k < 2; ++k)
    C.col(k) = inverse / step * (E.transpose() * (shape.gauge_gradient(e + step * E.col(k), a) - gradient));
  jet.undeformed_second.col(0) = -C(0, 0) * jet.normal;
  jet.undeformed_second.col(1) = -0.5 * (C(0, 1) + C(1, 0)) * jet.normal;
  jet.undeformed_second.col(2) = -C(1, 1) * jet.normal;
}

void PartFeatures::evaluate_undeformed(const FeaturePoint& point, FeatureJet& jet) const {
  const Feature& feature = features_[static_cast<std::size_t>(point.feature)];
  jet.dimension = feature.dimension;
  jet.undeformed_tangents.setZero();
  jet.undeformed_second.setZero();
  switch (feature.kind) {
    case Kind::smooth:
      return evaluate_smooth(point.e, jet);
    case Kind::affine:
    case Kind::disc:
      jet.undeformed_tangents = feature.axes;
      jet.normal = feature.outwards[0];
      if (feature.dimension == 2) return;
      jet.n_inward = feature.n_outwards;
      for (std::size_t k = 0; k < static_cast<std::size_t>(jet.n_inward); ++k)
        jet.inward[k] = -feature.outwards[k];
      return;
    case Kind::rim:
      jet.undeformed_tangents.col(0) = on_rim(feature.end, point.s[0], 1);
      jet.undeformed_second.col(0) = on_rim(feature.end, point.s[0], 2);
      jet.n_inward = 2;
      jet.inward[0] = on_rim(feature.end, point.s[0], 2).normalized();  // towards the centre
      jet.inward[1] = (on_rim(1 - feature.end, point.s[0], 0) - point.e).normalized();
      return;
    case Kind::side:
      const double share = point.s[1];
      const Vec3<double> upper = on_rim(0, point.s[0], 1), lower = on_rim(1, point.s[0], 1);
      jet.undeformed_tangents.col(0) = (1 - share) * upper + share * lower;
      jet.undeformed_second.col(0) =
          (1 - share) * on_rim(0, point.s[0], 2) + share * on_rim(1, point.s[0], 2);
      jet.undeformed_second.col(1) = lower - upper;
      jet.undeformed_tangents.col(1) = on_rim(1, point.s[0], 0) - on_rim(0, point.s[0], 0);
      jet.normal = jet.undeformed_tangents.col(1).cross(jet.undeformed_tangents.col(0)).normalized();
  }
}

FeatureJet PartFeatures::evaluate(const FeaturePoint& point) const {
  FeatureJet jet;
  evaluate_undeformed(point, jet);
  if (part_.parameters().links().empty()) {
    jet.x = point.e;
    jet.tangents = jet.undeformed_tangents;
    jet.second = jet.undeformed_second;
    return jet;
  }
  // One evaluation of the chain gives F at the point and at places near it along both tangents.
  Eigen::Matrix<double, 3, 4> places;
  places.colwise() = point.e;
  Eigen::Vector2d steps(1, 1);
  for (int k = 0; k < jet.dimension; ++k) {
    steps[k] = kJetDifference * part_.size() / jet.undeformed_tangents.col(k).norm();
    places.col(k + 1) += steps[k] * jet.undeformed_tangents.col(k);
  }
  PartEvaluation::ChainImages images;
  part_.apply_chain(places, values_, images);
  const Mat3<double>& F = images.F[0];
  jet.x = images.x.col(0);
  jet.tangents = F * jet.undeformed_tangents;
  jet.second = F * jet.undeformed_second;
  const Mat3<double> change[2] = {(images.F[1] - F) / steps[0], (images.F[2] - F) / steps[1]};
  jet.second.col(0) += change[0] * jet.undeformed_tangents.col(0);
  jet.second.col(1) += change[0] * jet.undeformed_tangents.col(1);
  jet.second.col(2) += change[1] * jet.undeformed_tangents.col(1);
  if (jet.dimension == 2) jet.normal = (F.inverse().transpose() * jet.normal).normalized();
  for (std::size_t k = 0; k < static_cast<std::size_t>(jet.n_inward); ++k) jet.inward[k] = F * jet.inward[k];
  return jet;
}

FeaturePoint PartFeatures::moved(const FeaturePoint& point, const FeatureJet& jet,
                                 const Eigen::Vector2d& ds) const {
  const Feature& feature = features_[static_cast<std::size_t>(point.feature)];
  FeaturePoint next = point;
  if (feature.kind == Kind::smooth) {
    const double* a = values_.b.data();
    next.e += jet.undeformed_tangents * ds +
              jet.undeformed_second * Vec3<double>(0.5 * ds[0] * ds[0], ds[0] * ds[1], 0.5 * ds[1] * ds[1]);
    const Vec3<double> gradient = part_.shape().gauge_gradient(next.e, a);
    next.e -= (part_.shape().gauge(next.e, a) - 1) / gradient.squaredNorm() * gradient;
    return next;
  }
  next.s += ds;
  next.e = position(feature, next.s);
  return next;
}

bool PartFeatures::is_inside(const FeaturePoint& point) const {
  const Feature& feature = features_[static_cast<std::size_t>(point.feature)];
  constexpr double kMost = 1 + kOnBoundary;
  switch (feature.kind) {
    case Kind::affine:
      return std::abs(point.s[0]) <= kMost && std::abs(point.s[1]) <= kMost;
    case Kind::disc:
      return point.s.norm() <= kMost;
    case Kind::side:
      return point.s[1] >= -kOnBoundary && point.s[1] <= kMost;
    case Kind::smooth:
    case Kind::rim:
      break;
  }
  return true;
}

}  // namespace pliant
