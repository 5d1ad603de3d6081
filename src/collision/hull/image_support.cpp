#include "image_support.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace pliant {

namespace {

constexpr int kMaxNewtonSteps = 40, kMaxStepHalvings = 12;
/// Derivatives of F along a direction are finite differences over this distance, in sizes of the part.
constexpr double kDifference = 1e-6;
/// Longest step of the normal (rad) and of the share.
constexpr double kLongestTurn = 0.5;
/// The search ends after a step of the normal (rad) and of the share that is shorter than this. Because
/// derivatives are finite differences, the error is then about kDifference times the step.
constexpr double kLastTurn = 3e-7;
/// A step is accepted if it reduces the height by at most this (rounding), in sizes of the part.
constexpr double kHeightLoss = 1e-14;
/// The surface is curved outwards at a point with g = nu if the eigenvalues of the negative derivative of E^T
/// g by the turn of the normal (Local::slope) exceed this. For an affine map they are 1.
constexpr double kConvexMargin = 0.05;
/// Newton's method starts only if the cosine of the angle between g and the normal exceeds this. Otherwise
/// the normal is first set to the direction of g. At cosine -1 the height would be least instead of largest.
constexpr double kLeastCosine = 0.3;

}  // namespace

/// The terms of Newton's method at one normal and share.
struct ImageSupport::Local {
  Vec3<double> normal;
  double share;
  Vec3<double> x;
  double height;                      // m . x, m
  Mat3<double> F;                     // dT/de
  Vec3<double> g;                     // F^T m
  Eigen::Matrix<double, 3, 2> E;      // basis of the plane perpendicular to the normal
  Eigen::Matrix<double, 3, 2> moved;  // de/dnu E, m
  Eigen::Vector3d residual;           // E^T g, and g . de/dshare
  Mat3<double> slope;                 // derivative of the residual by the turn of the normal and by the share
};

ImageSupport::Local ImageSupport::evaluate(const Vec3<double>& m, const PieceFamily& family, double share,
                                           const Vec3<double>& normal) const {
  using D = Dual<3>;
  const double* a = values_.b.data();
  Local at;
  at.normal = normal;
  at.share = share;
  at.E.col(0) = normal.unitOrthogonal();
  at.E.col(1) = normal.cross(at.E.col(0));
  const Vec3<D> nu(D::variable(normal[0], 0), D::variable(normal[1], 1), D::variable(normal[2], 2));
  auto support = [&](int piece, Vec3<double>& e, Eigen::Matrix<double, 3, 2>& moved) {
    const Vec3<D> dual = part_.shape().support(nu, a, piece);
    Mat3<double> slope;
    for (int r = 0; r < 3; ++r) {
      e[r] = dual[r].v;
      for (int c = 0; c < 3; ++c) slope(r, c) = dual[r].d[static_cast<std::size_t>(c)];
    }
    moved = slope * at.E;
  };
  Vec3<double> e, across = Vec3<double>::Zero();
  Eigen::Matrix<double, 3, 2> across_moved = Eigen::Matrix<double, 3, 2>::Zero();
  support(family.one, e, at.moved);
  if (family.other != family.one) {
    support(family.other, across, across_moved);
    across -= e;
    across_moved -= at.moved;
    e += share * across;
    at.moved += share * across_moved;
  }
  // One evaluation of the chain gives F at e and at three points near it.
  Eigen::Matrix<double, 3, 4> places;
  Eigen::Vector3d steps;
  auto place = [&](int k, const Vec3<double>& direction) {
    const double length = direction.norm();
    steps[k] = length > 0 ? kDifference * part_.size() / length : 1;
    places.col(k + 1) = e + steps[k] * direction;
  };
  places.col(0) = e;
  place(0, at.moved.col(0));
  place(1, at.moved.col(1));
  place(2, across);
  PartEvaluation::ChainImages images;
  part_.apply_chain(places, values_, images);
  at.x = images.x.col(0);
  at.F = images.F[0];
  at.g = at.F.transpose() * m;
  at.height = m.dot(at.x);
  at.residual << at.E.transpose() * at.g, at.g.dot(across);
  Mat3<double> change;  // derivatives of g
  for (int k = 0; k < 3; ++k)
    change.col(k) = (images.F[static_cast<std::size_t>(k) + 1].transpose() * m - at.g) / steps[k];
  at.slope.topRows<2>() = at.E.transpose() * change;
  at.slope.topLeftCorner<2, 2>() -= at.g.dot(normal) * Eigen::Matrix2d::Identity();
  at.slope.row(2) = across.transpose() * change;
  at.slope.block<1, 2>(2, 0) += at.g.transpose() * across_moved;
  return at;
}

/// Maximises the height m . x by Newton's method. A step that reduces the height is halved. Where the height
/// is not concave, the normal turns towards g instead. free_share: whether the share is an unknown, too.
ImageSupport::Local ImageSupport::ascend(const Vec3<double>& m, const PieceFamily& family, bool free_share,
                                         Local at) const {
  const double rounding = kHeightLoss * part_.size();
  if (!(at.g.dot(at.normal) > kLeastCosine * at.g.norm()) && !at.g.isZero(0))
    at = evaluate(m, family, at.share, at.g.normalized());
  for (int k = 0; k < kMaxNewtonSteps; ++k) {
    Eigen::Vector3d step = Eigen::Vector3d::Zero();
    const Eigen::Matrix2d A = at.slope.topLeftCorner<2, 2>();
    const bool concave = A.trace() < 0 && A.determinant() > 0;
    if (free_share && concave && at.slope.determinant() < 0)
      step = -at.slope.inverse() * at.residual;
    else if (concave)
      step.head<2>() = -A.inverse() * at.residual.head<2>();
    else
      step.head<2>() = at.residual.head<2>() / std::max(at.g.dot(at.normal), kLeastCosine * at.g.norm());
    if ((at.share <= 0 && step[2] < 0) || (at.share >= 1 && step[2] > 0)) return at;
    if (const double length = step.norm(); length > kLongestTurn) step *= kLongestTurn / length;
    const bool last = step.norm() < kLastTurn;
    for (int halving = 0;; ++halving) {
      const double share = std::clamp(at.share + step[2], 0.0, 1.0);
      Local next = evaluate(m, family, share, (at.normal + at.E * step.head<2>()).normalized());
      if (next.height >= at.height - rounding) {
        at = next;
        break;
      }
      if (last || halving == kMaxStepHalvings) return at;
      step *= 0.5;
    }
    if (last) return at;
  }
  return at;
}

ImagePoint ImageSupport::farthest(const Vec3<double>& m, const PieceFamily& family, double share,
                                  const Vec3<double>& start, bool with_slope) const {
  const Local at = ascend(m, family, false, evaluate(m, family, share, start));
  ImagePoint point;
  point.normal = at.normal;
  point.share = share;
  point.x = at.x;
  point.slope_share = at.residual[2];
  if (with_slope && !at.moved.isZero(0)) {
    const Eigen::Matrix2d A = at.slope.topLeftCorner<2, 2>();
    const Eigen::Matrix<double, 3, 2> along = at.F * at.moved, across = at.F * at.E;
    point.slope = -along * A.inverse() * across.transpose();
  }
  return point;
}

std::optional<ImagePoint> ImageSupport::between(const Vec3<double>& m, const PieceFamily& family,
                                                const ImagePoint& start) const {
  const Local at = ascend(m, family, true, evaluate(m, family, start.share, start.normal));
  if (!(at.share > 0 && at.share < 1)) return std::nullopt;
  ImagePoint point;
  point.normal = at.normal;
  point.share = at.share;
  point.x = at.x;
  return point;
}

Vec3<double> ImageSupport::start(const Vec3<double>& m) const {
  PartEvaluation::ChainImages images;
  part_.apply_chain(Eigen::Matrix<double, 3, 4>::Zero(), values_, images);
  return (images.F[0].transpose() * m).normalized();
}

bool ImageSupport::is_convex_at(const Vec3<double>& nu, int piece) const {
  const Local here = evaluate(nu, {piece, piece}, 0, nu);
  const Vec3<double> m = here.F.transpose().inverse() * nu;  // so that g = nu
  const Eigen::Matrix2d A = -evaluate(m, {piece, piece}, 0, nu).slope.topLeftCorner<2, 2>();
  const double middle = 0.5 * A.trace();
  return middle - std::sqrt(std::max(0.0, middle * middle - A.determinant())) > kConvexMargin;
}

}  // namespace pliant
