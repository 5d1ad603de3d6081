#include "common_normal.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace pliant {

namespace {

/// After kFullSteps steps most steps are halved, because full steps can alternate between both sides of a
/// line at which the curvature of a surface jumps.
constexpr int kMaxNormalSteps = 40, kFullSteps = 8;
/// A step is not halved if its length is less than this multiple of the length of the last step.
constexpr double kShrinks = 0.6;
/// Damping of the search for the least residual: value at the first step, and factor by which it changes.
constexpr double kFirstDamping = 1e-2, kDampingFactor = 4;
constexpr int kMaxDampedSteps = 100;
/// If the least residual is above this, there is no common normal nearby.
constexpr double kNoCommonNormal = 1e-6;
/// Longest step of the normal, rad, and of a point, in radii of its patch.
constexpr double kLongestNormalTurn = 0.5, kLongestMove = 2;
/// The search ends without result if a point is farther from the middle of its patch than this, in radii.
constexpr double kFarthest = 4;
/// The search ends after a step that is shorter than this (rad, and sizes).
constexpr double kLastNormalStep = 1e-8;
/// The direction of a vector shorter than this (without unit, or in sizes) is not used as the first normal.
constexpr double kShortest = 1e-6;
/// This value, in units of 1 / size, is added to the diagonal of the Hessian, so that the Hessian can be
/// inverted where points with common normals form a curve.
constexpr double kStiffness = 1e-9;
/// The distance is constant along a curve of points if the second derivative of the distance is at most this,
/// in units of 1 / size.
constexpr double kConstantDistance = 1e-6;
/// The normal at an edge or vertex may be outside the cone of the normals of the adjacent faces by this
/// angle, rad.
constexpr double kOnCone = 1e-7;

using Matrix32 = Eigen::Matrix<double, 3, 2>;

/// Returns the second derivatives of n . x by the coordinates.
Eigen::Matrix2d height_curvature(const FeatureJet& jet, const Vec3<double>& n) {
  const Vec3<double> w = jet.second.transpose() * n;
  return (Eigen::Matrix2d() << w[0], w[1], w[1], w[2]).finished();
}

/// Returns the lengths of the tangents; 1 for a tangent that does not exist.
Eigen::Vector2d tangent_lengths(const FeatureJet& jet) {
  Eigen::Vector2d length(1, 1);
  for (int k = 0; k < jet.dimension; ++k) length[k] = jet.tangents.col(k).norm();
  return length;
}

/// Whether the distance of a vertex from a face is least at a common normal, to second order. The condition
/// is 1 + g kappa > 0 for both curvatures kappa of the face; they are positive where the face is convex.
bool is_nearest(const FeatureJet& face, const CommonNormal& at) {
  const Vec3<double> to_vertex = at.gap * face.normal;
  const Eigen::Matrix2d H = face.tangents.transpose() * face.tangents - height_curvature(face, to_vertex);
  return H.trace() > 0 && H.determinant() > 0;
}

Matrix32 plane_basis(const Vec3<double>& n) {
  Matrix32 P;
  P.col(0) = n.unitOrthogonal();
  P.col(1) = n.cross(P.col(0));
  return P;
}

}  // namespace

/// Returns a jet of a, with the vectors that the search needs in the frame of b.
FeatureJet NormalSearch::turned(FeatureJet jet) const {
  jet.x = pose_(jet.x);
  jet.tangents = pose_.R * jet.tangents;
  jet.second = pose_.R * jet.second;
  jet.normal = pose_.R * jet.normal;
  for (std::size_t k = 0; k < static_cast<std::size_t>(jet.n_inward); ++k)
    jet.inward[k] = pose_.R * jet.inward[k];
  return jet;
}

Vec3<double> NormalSearch::start(const Patch& a, const Patch& b) const {
  const Vec3<double> outward = b.bound.axis - pose_.R * a.bound.axis, d = (pose_(a.jet.x) - b.jet.x) / size_;
  auto is_short = [](const Vec3<double>& n) { return !(n.squaredNorm() > kShortest * kShortest); };
  Vec3<double> n = Vec3<double>::Zero();
  if (b.jet.dimension == 2) n += b.jet.normal;
  if (a.jet.dimension == 2) n -= pose_.R * a.jet.normal;
  if (!is_short(n)) return n.normalized();
  const Vec3<double> along_a = pose_.R * a.jet.tangents.col(0).normalized(),
                     along_b = b.jet.tangents.col(0).normalized();
  n = d;
  if (a.jet.dimension == 1 && b.jet.dimension == 1) {
    n = along_a.cross(along_b);
  } else if (a.jet.dimension + b.jet.dimension == 1) {
    const Vec3<double>& along = a.jet.dimension == 1 ? along_a : along_b;
    n -= n.dot(along) * along;
  }
  if (is_short(n)) n = outward;
  if (is_short(n)) n = b.bound.axis;
  return (n.dot(outward) < 0 ? Vec3<double>(-n) : n).normalized();
}

NormalSearch::System NormalSearch::system(const Place& at) const {
  const Vec3<double>& n = at.normal;
  const Vec3<double> d = at.of_a.x - at.of_b.x;
  System system{Eigen::Matrix<double, 6, 6>::Zero(), Vec<double, 6>::Zero(), plane_basis(n),
                tangent_lengths(at.of_a), tangent_lengths(at.of_b)};
  auto& H = system.hessian;
  auto& residual = system.residual;
  auto add_side = [&](const FeatureJet& jet, const Eigen::Vector2d& length, int first, double sign) {
    const Matrix32 unit = jet.tangents * length.cwiseInverse().asDiagonal();
    const Eigen::Matrix2d W = height_curvature(jet, n);
    for (int i = 0; i < 2; ++i) {
      if (i >= jet.dimension) {
        H(first + i, first + i) = 1;
        continue;
      }
      for (int j = 0; j < jet.dimension; ++j)
        H(first + i, first + j) = sign * size_ * W(i, j) / (length[i] * length[j]);
      H(first + i, first + i) += kStiffness;
      residual[first + i] = sign * n.dot(unit.col(i));
    }
    H.block<2, 2>(first, 4) = sign * unit.transpose() * system.plane;
    H.block<2, 2>(4, first) = H.block<2, 2>(first, 4).transpose();
  };
  add_side(at.of_a, system.of_a, 0, 1);
  add_side(at.of_b, system.of_b, 2, -1);
  H(4, 4) = H(5, 5) = -n.dot(d) / size_;
  residual.tail<2>() = system.plane.transpose() * d / size_;
  return system;
}

/// Returns the step with the changes z of the unknowns of a system.
NormalStep NormalSearch::step(const Place& at, const System& system, const Vec<double, 6>& z) const {
  NormalStep step;
  step.a = size_ * z.head<2>().cwiseQuotient(system.of_a);
  step.b = size_ * z.segment<2>(2).cwiseQuotient(system.of_b);
  step.turn = system.plane * z.tail<2>();
  step.normal = (at.normal + step.turn).normalized();
  step.gap = at.normal.dot(at.of_a.x - at.of_b.x) + 0.5 * size_ * system.residual.dot(z);
  const Vec3<double> move_a = at.of_a.tangents * step.a, move_b = at.of_b.tangents * step.b;
  step.x = at.of_a.x + move_a;
  step.y = at.of_b.x + move_b;
  step.length_a = move_a.norm();
  step.length_b = move_b.norm();
  return step;
}

NormalStep NormalSearch::step(const Place& at) const {
  const System now = system(at);
  return step(at, now, now.hessian.partialPivLu().solve(-now.residual));
}

NormalSearch::Place NormalSearch::middles(const Patch& a, const Patch& b, const Vec3<double>& n) const {
  return {a.middle, b.middle, turned(a.jet), b.jet, n};
}

/// Returns the place to which a share of a step leads.
NormalSearch::Place NormalSearch::moved(const Place& at, const NormalStep& step, double share) const {
  Place next;
  next.a = a_.moved(at.a, at.of_a, share * step.a);
  next.b = b_.moved(at.b, at.of_b, share * step.b);
  next.of_a = turned(a_.evaluate(next.a));
  next.of_b = b_.evaluate(next.b);
  next.normal = (at.normal + share * step.turn).normalized();
  return next;
}

NormalStep NormalSearch::step(const Patch& a, const Patch& b, const Vec3<double>& n) const {
  return step(middles(a, b, n));
}

/// Whether a common normal is that of a contact: it points out of b and into a, and the distance is least
/// there to second order.
bool NormalSearch::is_least(const FeatureJet& a, const FeatureJet& b, const CommonNormal& at) const {
  if (!a_.is_inside(at.a) || !b_.is_inside(at.b)) return false;
  if (a.dimension == 2 && a.normal.dot(at.normal) > 0) return false;
  if (b.dimension == 2 && b.normal.dot(at.normal) < 0) return false;
  for (const FeatureJet* jet : {&a, &b})
    for (std::size_t k = 0; k < static_cast<std::size_t>(jet->n_inward); ++k)
      if ((jet == &a ? 1 : -1) * at.normal.dot(jet->inward[k]) < -kOnCone * jet->inward[k].norm())
        return false;
  const int dimension = a.dimension + b.dimension;
  if (dimension < 2) return at.gap > 0;
  if (dimension == 2) return a.dimension == 1 || is_nearest(a.dimension == 2 ? a : b, at);
  const Matrix32 P = plane_basis(at.normal);
  double least = 0;  // second derivative of the distance by a length, times size_
  if (dimension == 3) {
    // All changes with x' ds_a = y' ds_b are along the edge.
    const FeatureJet &edge = a.dimension == 1 ? a : b, &face = a.dimension == 1 ? b : a;
    const Eigen::Vector2d t = (P.transpose() * edge.tangents.col(0)).normalized();
    const Eigen::Vector2d of_face = (P.transpose() * face.tangents).inverse() * t;
    const double length = edge.tangents.col(0).norm();
    const double difference = height_curvature(edge, at.normal)(0, 0) / (length * length) -
                              of_face.dot(height_curvature(face, at.normal) * of_face);
    least = size_ * (a.dimension == 1 ? 1 : -1) * difference;
  } else {
    const Eigen::Matrix2d T_a = (P.transpose() * a.tangents).inverse(),
                          T_b = (P.transpose() * b.tangents).inverse();
    const Eigen::Matrix2d K = T_a.transpose() * height_curvature(a, at.normal) * T_a -
                              T_b.transpose() * height_curvature(b, at.normal) * T_b;
    const double middle = 0.5 * K.trace();
    least = size_ * (middle - std::sqrt(std::max(0.0, middle * middle - K.determinant())));
  }
  // If the distance is constant along a line up to the boundaries of the features, the contacts are at the
  // ends of this line.
  const bool closed = a_.is_closed(at.a.feature) || b_.is_closed(at.b.feature);
  return least > (closed ? -kConstantDistance : kConstantDistance);
}

/// Sets the result of a search that has converged, and returns how the search ends.
NormalSearch::End NormalSearch::end_at(const Place& at, CommonNormal& result) const {
  result = {at.a, at.b, at.of_a.x, at.of_b.x, at.normal, at.normal.dot(at.of_a.x - at.of_b.x)};
  return is_least(at.of_a, at.of_b, result) ? End::found : End::none;
}

NormalSearch::End NormalSearch::search(const Patch& a, const Patch& b, CommonNormal& result) const {
  const Place start = middles(a, b, result.normal);
  Place at = start;
  double last = 0;  // length of the last step before it is shortened
  result.gap = std::numeric_limits<double>::quiet_NaN();
  for (int k = 0; k < kMaxNormalSteps; ++k) {
    const NormalStep next = step(at);
    if (!next.is_finite()) return End::failed;
    result.gap = next.gap;
    const double length = next.length(size_);
    const double share = std::min(
        {k < kFullSteps || length < kShrinks * last ? 1.0 : 0.5, kLongestNormalTurn / next.turn.norm(),
         kLongestMove * a.bound.radius / next.length_a, kLongestMove * b.bound.radius / next.length_b});
    last = length;
    at = moved(at, next, share);
    if (is_far(at, a, b)) return End::none;
    if (length < kLastNormalStep) return end_at(at, result);
  }
  return search_least_residual(a, b, start, result);
}

/// Whether a point is too far from the middle of its patch.
bool NormalSearch::is_far(const Place& at, const Patch& a, const Patch& b) const {
  return (at.of_a.x - pose_(a.jet.x)).norm() > kFarthest * a.bound.radius ||
         (at.of_b.x - b.jet.x).norm() > kFarthest * b.bound.radius;
}

/// Minimises the norm of the residual (Levenberg 1944, Marquardt 1963) where Newton's method does not
/// converge. If the least residual is not zero there is no common normal nearby.
NormalSearch::End NormalSearch::search_least_residual(const Patch& a, const Patch& b, Place at,
                                                      CommonNormal& result) const {
  System now = system(at);
  double damping = kFirstDamping;
  for (int k = 0; k < kMaxDampedSteps; ++k) {
    Eigen::Matrix<double, 6, 6> H = now.hessian.transpose() * now.hessian;
    H.diagonal().array() += damping;
    const NormalStep next = step(at, now, H.ldlt().solve(-now.hessian.transpose() * now.residual));
    if (!next.is_finite()) return End::failed;
    const Place there = moved(at, next, 1);
    const System then = system(there);
    const bool is_better = then.residual.norm() < now.residual.norm();
    damping *= is_better ? 1 / kDampingFactor : kDampingFactor;
    if (is_better) {
      at = there;
      now = then;
      result.gap = next.gap;
      if (is_far(at, a, b)) return End::none;
    }
    if (next.length(size_) < kLastNormalStep) {
      if (now.residual.norm() > kNoCommonNormal) return End::none;
      return end_at(at, result);
    }
  }
  return End::failed;
}

}  // namespace pliant
