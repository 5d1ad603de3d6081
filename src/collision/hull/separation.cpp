// The largest separation of two convex parts. A sequence of small quadratic programs on the unit sphere finds
// it. At a normal n, each piece i of a has the value a_i = n . x_i of its support point x_i and each piece j
// of b the value b_j = n . y_j, so that s = min_i a_i - max_j b_j. In the tangent plane of n, the step t is
// the solution of
//   maximise    alpha - beta - t.H t / 2
//   subject to  alpha <= a_i + x_i.t for all i,  beta >= b_j + y_j.t for all j.
// H contains the radii of curvature of the pieces, weighted by the multipliers of the last step. s is added
// to the diagonal of H, because the length of n + t is not 1. Edges and faces of polyhedral parts are sets of
// active pieces; smooth parts have one active piece each.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include "hull_pair.h"

namespace pliant {

namespace {

constexpr int kMaxSteps = 60;
/// Largest number of pieces of a part in a quadratic program. The pieces nearest to the other part are used.
constexpr int kMaxPieces = 4;
/// Longest step of the normal, rad.
constexpr double kLongestStep = 0.5;
/// The search ends if the step is shorter than this (rad), or if it improves s by less than kMinGain, in
/// sizes.
constexpr double kShortestStep = 1e-10, kMinGain = 1e-15;
/// Values that differ by at most this, in sizes, are equal.
constexpr double kEqual = 1e-12;
/// Least radius of curvature in H, in sizes. It is multiplied by kStiffening if a step fails.
constexpr double kMinRadius = 1e-9, kStiffening = 16;
/// An overlap deeper than this share of the thickness of the thinner part has several local maxima; the
/// search then starts from all axes of both parts.
constexpr double kDeep = 0.01;
/// A step is halved at most this often before H changes.
constexpr int kMaxHalvings = 6;
/// A step that gains at least this share of the predicted increase of s is not halved.
constexpr double kEnough = 0.25;
/// Angle (rad) between an axis of a part and the normal from which a search near this axis starts. At the
/// axes nearly flat faces have infinite radii of curvature.
constexpr double kOffAxis = 0.05;
/// A direction is the normal of an end face if the cosine of the angle between them exceeds this.
constexpr double kFaceCosine = 1 - 1e-14;
/// kMaxFaceSteps: largest number of steps of the test whether two faces overlap. kLeaveFace: angle (rad) by
/// which the search turns the normal away from that of a face if the faces do not overlap.
constexpr int kMaxFaceSteps = 20;
constexpr double kLeaveFace = 0.1;

/// A piece of one part at a normal.
struct Piece {
  int number;
  double value;           // n . point, m
  Vec3<double> point;     // relative to the middle of the pair, m
  Mat3<double> slopes;    // derivative of the support point by the direction, body frame, m
  Eigen::Vector2d slope;  // components of the point in the tangent plane
  Eigen::Matrix2d H;      // radii of curvature, positive semidefinite
};

/// A point of a part that is nearest to the other part at a normal, or an end face whose points are all
/// nearest.
struct Nearest {
  int end_face;    // number of the end face; -1: only the point x is nearest
  Vec3<double> x;  // relative to the middle of the pair, m
};

/// The pieces of one part that are nearest to the other part, at a normal n. side: -1 for part a, whose
/// support points are those in the direction -n; 1 for part b.
struct Side {
  const PlacedHull& part;
  Vec3<double> origin;  // of the body frame, relative to the middle of the pair
  double side;
  std::array<Piece, kMaxPieces> pieces{};
  int count = 0;
  std::array<double, static_cast<std::size_t>(kMaxHullPieces)>
      weights{};  // multipliers of the last step, by number of the piece

  /// Returns the weighted mean of the matrices H of the nearest pieces. The weights are the multipliers.
  Eigen::Matrix2d curvature() const {
    Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
    double all = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      const double weight = weights[static_cast<std::size_t>(pieces[k].number)];
      sum += weight * pieces[k].H;
      all += weight;
    }
    return all > 0 ? Eigen::Matrix2d(sum / all) : pieces[0].H;
  }
  void set_weights(const std::array<double, kMaxPieces>& of_pieces) {
    weights.fill(0);
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k)
      weights[static_cast<std::size_t>(pieces[k].number)] = of_pieces[k];
  }
  Vec3<double> point(const Vec3<double>& n, int piece) const {
    return origin + part.R * part.hull.support(part.into_body(side * n), piece);
  }
  /// Returns n . x of the nearest piece.
  double value(const Vec3<double>& n) const {
    return n.dot(origin + part.R * part.hull.support(part.into_body(side * n)));
  }
  /// Returns n . x of Hull::rough_support().
  double rough_value(const Vec3<double>& n) const {
    return n.dot(origin + part.R * part.hull.rough_support(part.into_body(side * n)));
  }
  /// Appends the points nearest to the other part at n. All points of an end face with the normal n are one
  /// entry. equal: values of n . x that differ by at most this (m) are equal.
  void find_nearest(const Vec3<double>& n, double equal, std::vector<Nearest>& found) const {
    const double nearest = value(n);
    for (int i = 0; i < part.hull.pieces(); ++i) {
      const Vec3<double> x = point(n, i);
      if (side * (nearest - n.dot(x)) > equal) continue;
      const bool is_face =
          part.hull.has_end_faces() && side * n.dot(part.R * part.hull.end_face_normal(i)) > kFaceCosine;
      found.push_back({is_face ? i : -1, x});
    }
  }
  /// Returns the point that is farthest in a direction e among the points of find_nearest(). e: perpendicular
  /// to n.
  Vec3<double> farthest(const std::vector<Nearest>& nearest, const Vec3<double>& e) const {
    Vec3<double> best = nearest.front().x;
    double most = -std::numeric_limits<double>::infinity();
    for (const Nearest& one : nearest) {
      const Vec3<double> x =
          one.end_face < 0
              ? one.x
              : Vec3<double>(origin + part.R * part.hull.support(part.into_body(e), one.end_face));
      if (!(e.dot(x) > most)) continue;
      most = e.dot(x);
      best = x;
    }
    return best;
  }
  /// Evaluates the nearest pieces. E: 3 x 2, basis of the tangent plane of n.
  void evaluate(const Vec3<double>& n, const Eigen::Matrix<double, 3, 2>& E) {
    count = 0;
    const Vec3<double> m = part.into_body(side * n);
    const bool all = part.hull.pieces() <= kMaxPieces;  // then no piece is left out
    for (int i = 0; i < part.hull.pieces(); ++i) {
      Piece next;
      next.number = i;
      next.point = origin + part.R * (all ? part.hull.support(m, i, next.slopes) : part.hull.support(m, i));
      next.value = n.dot(next.point);
      int place = std::min(count, kMaxPieces);
      while (place > 0 && side * next.value > side * pieces[static_cast<std::size_t>(place - 1)].value) {
        if (place < kMaxPieces)
          pieces[static_cast<std::size_t>(place)] = pieces[static_cast<std::size_t>(place - 1)];
        --place;
      }
      if (place == kMaxPieces) continue;
      pieces[static_cast<std::size_t>(place)] = next;
      count = std::min(count + 1, kMaxPieces);
    }
    const Eigen::Matrix<double, 3, 2> in_body = part.R.transpose() * E;
    for (int k = 0; k < count; ++k) {
      Piece& piece = pieces[static_cast<std::size_t>(k)];
      if (!all) part.hull.support(m, piece.number, piece.slopes);
      piece.slope = E.transpose() * piece.point;
      piece.H = in_body.transpose() * piece.slopes * in_body;
    }
  }
};

/// The step of one quadratic program, with the multipliers of the pieces.
struct Step {
  Eigen::Vector2d t = Eigen::Vector2d::Zero();
  std::array<double, kMaxPieces> of_a{}, of_b{};
  double gain = -std::numeric_limits<double>::infinity();  // predicted increase of s, m
};

/// The quadratic program at one normal.
class Program {
 public:
  Program(const Side& a, const Side& b, const Eigen::Matrix2d& H, double equal)
      : a_(a), b_(b), H_(H), H_inverse_(H.inverse()), equal_(equal) {}

  /// Tries the sets of active pieces: one piece of each part, and at most two more. Sets `step` to the
  /// solution for the first set that satisfies the optimality conditions. Returns false if no set does.
  bool solve(Step& step) {
    for (int extra = 0; extra <= 2; ++extra)
      for (int i = 0; i < a_.count; ++i)
        for (int j = 0; j < b_.count; ++j)
          if (solve_from(i, j, extra, step)) return true;
    return false;
  }

 private:
  /// A further active piece, with its condition d.t = r.
  struct Active {
    bool of_a = false;
    int piece = 0;
    Eigen::Vector2d d = Eigen::Vector2d::Zero();
    double r = 0;
  };
  struct ActiveSet {
    std::array<Active, 2> pieces{};
    int count = 0;
  };
  Active active_a(int base, int i) const {
    const Piece &first = a_.pieces[at(base)], &other = a_.pieces[at(i)];
    return {true, i, other.slope - first.slope, first.value - other.value};
  }
  Active active_b(int base, int j) const {
    const Piece &first = b_.pieces[at(base)], &other = b_.pieces[at(j)];
    return {false, j, first.slope - other.slope, other.value - first.value};
  }
  static std::size_t at(int k) { return static_cast<std::size_t>(k); }

  bool solve_from(int i, int j, int extra, Step& step) {
    const Eigen::Vector2d g = a_.pieces[at(i)].slope - b_.pieces[at(j)].slope;
    const Eigen::Vector2d no_multipliers = Eigen::Vector2d::Zero();
    if (extra == 0) return accept(i, j, ActiveSet{}, H_inverse_ * g, no_multipliers, step);
    std::array<Active, 2 * kMaxPieces> others;
    int n = 0;
    for (int k = i + 1; k < a_.count; ++k) others[at(n++)] = active_a(i, k);
    for (int k = j + 1; k < b_.count; ++k) others[at(n++)] = active_b(j, k);
    for (int k = 0; k < n; ++k) {
      const Active& one = others[at(k)];
      if (extra == 1) {
        const Eigen::Vector2d along = H_inverse_ * one.d;
        const double stiffness = one.d.dot(along);
        if (!(stiffness > 0)) continue;
        const double lambda = (one.r - along.dot(g)) / stiffness;
        if (accept(i, j, {{one, one}, 1}, H_inverse_ * (g + lambda * one.d), {lambda, 0}, step)) return true;
        continue;
      }
      for (int l = k + 1; l < n; ++l) {
        const Active& two = others[at(l)];
        Eigen::Matrix2d D;
        D.row(0) = one.d;
        D.row(1) = two.d;
        const double scale = one.d.norm() * two.d.norm();
        if (!(std::abs(D.determinant()) > kEqual * scale)) continue;
        const Eigen::Vector2d t = D.inverse() * Eigen::Vector2d(one.r, two.r),
                              lambda = D.transpose().inverse() * (H_ * t - g);
        if (accept(i, j, {{one, two}, 2}, t, lambda, step)) return true;
      }
    }
    return false;
  }

  /// Accepts a step if no multiplier is negative and no other piece violates its constraint.
  bool accept(int i, int j, const ActiveSet& active, const Eigen::Vector2d& t, const Eigen::Vector2d& lambda,
              Step& step) const {
    if (!t.allFinite()) return false;
    Step next;
    next.t = t;
    next.of_a[at(i)] = next.of_b[at(j)] = 1;
    for (int k = 0; k < active.count; ++k) {
      if (!(lambda[k] >= -kEqual)) return false;
      auto& own = active.pieces[at(k)].of_a ? next.of_a : next.of_b;
      own[at(active.pieces[at(k)].piece)] += lambda[k];
      own[at(active.pieces[at(k)].of_a ? i : j)] -= lambda[k];
    }
    if (!(next.of_a[at(i)] >= -kEqual && next.of_b[at(j)] >= -kEqual)) return false;
    const double alpha = a_.pieces[at(i)].value + a_.pieces[at(i)].slope.dot(t),
                 beta = b_.pieces[at(j)].value + b_.pieces[at(j)].slope.dot(t);
    for (int k = 0; k < a_.count; ++k)
      if (a_.pieces[at(k)].value + a_.pieces[at(k)].slope.dot(t) < alpha - equal_) return false;
    for (int k = 0; k < b_.count; ++k)
      if (b_.pieces[at(k)].value + b_.pieces[at(k)].slope.dot(t) > beta + equal_) return false;
    next.gain = alpha - beta - 0.5 * t.dot(H_ * t) - (a_.pieces[0].value - b_.pieces[0].value);
    step = next;
    return true;
  }

  const Side &a_, &b_;
  Eigen::Matrix2d H_, H_inverse_;
  double equal_;
};

/// The search for the largest separation.
class SeparationSearch {
 public:
  SeparationSearch(const PlacedHull& a, const PlacedHull& b)
      : d_(a.c - b.c),
        a_{a, 0.5 * d_, -1},
        b_{b, -0.5 * d_, 1},
        size_(std::max(a.hull.size(), b.hull.size())) {}

  double s(const Vec3<double>& n) const { return a_.value(n) - b_.value(n); }
  /// Returns an upper bound of s(n) that is near s(n), without a search on deformed parts.
  double rough_s(const Vec3<double>& n) const { return a_.rough_value(n) - b_.rough_value(n); }

  /// Returns whether n, a normal of an end face, is certainly a local maximum of s: the sets of nearest
  /// points of both parts overlap in their projection along n. Otherwise turns n away from the face.
  /// Gilbert's method (1966) finds the shortest vector between the projected sets.
  bool is_maximum_at_face(Vec3<double>& n) const {
    const double equal = kEqual * size_;
    std::vector<Nearest> of_a, of_b;
    a_.find_nearest(n, equal, of_a);
    b_.find_nearest(n, equal, of_b);
    auto difference = [&](const Vec3<double>& e) -> Vec3<double> {  // least point of a - b along e
      const Vec3<double> w = a_.farthest(of_a, -e) - b_.farthest(of_b, e);
      return w - n.dot(w) * n;
    };
    Vec3<double> v = difference(n.unitOrthogonal());
    bool apart = false;
    for (int k = 0; k < kMaxFaceSteps && !apart && v.norm() > equal; ++k) {
      const Vec3<double> w = difference(v.normalized()), to_w = w - v;
      apart = v.dot(w) > 0;
      if (!(to_w.squaredNorm() > 0)) break;
      v += std::clamp(-v.dot(to_w) / to_w.squaredNorm(), 0.0, 1.0) * to_w;
    }
    if (v.norm() <= equal) return true;
    n = (n + kLeaveFace * v.normalized()).normalized();
    return false;
  }

  /// Returns a normal near n, outside the coordinate planes of both parts.
  Vec3<double> off_axis(const Vec3<double>& n) const {
    const Vec3<double> aside = d_ - d_.dot(n) * n;
    const bool aligned = !(aside.norm() > kOffAxis * d_.norm());
    const Vec3<double> e1 = aligned ? n.unitOrthogonal() : Vec3<double>(aside.normalized());
    return (n + kOffAxis * (e1 + 0.3 * n.cross(e1))).normalized();
  }

  /// Returns the separation along a direction if it exceeds that of `best`, else `best`.
  Separation better(const Separation& best, const Vec3<double>& direction) const {
    const Vec3<double> n = direction.normalized();
    const double s_n = s(n);
    return s_n > best.gap ? Separation{n, s_n} : best;
  }

  /// Returns a local maximum of s near a normal n, or an earlier normal of the search at which s exceeds
  /// max_gap (m).
  Separation ascend(Vec3<double> n, double max_gap) {
    double s_n = s(n), radius = kMinRadius * size_;
    a_.weights.fill(1);
    b_.weights.fill(1);
    for (int k = 0; k < kMaxSteps && !(s_n > max_gap); ++k) {
      Eigen::Matrix<double, 3, 2> E;
      E.col(0) = n.unitOrthogonal();
      E.col(1) = n.cross(E.col(0));
      a_.evaluate(n, E);
      b_.evaluate(n, E);
      const Eigen::Matrix2d curvature = a_.curvature() + b_.curvature();
      bool improved = false;
      for (; radius < size_ * 1e6; radius *= kStiffening) {
        Eigen::Matrix2d H = curvature;
        // s on the diagonal accounts for the length of n + t. A negative s is added only if H stays positive
        // definite.
        if (s_n > 0 || H.determinant() > 2 * std::abs(s_n) * H.trace()) H.diagonal().array() += s_n;
        H.diagonal().array() += radius;
        Step step;
        if (!Program(a_, b_, H, kEqual * size_).solve(step)) continue;
        a_.set_weights(step.of_a);
        b_.set_weights(step.of_b);
        const double length = step.t.norm();
        if (length < kShortestStep || step.gain < kMinGain * size_) return better({n, s_n}, n + E * step.t);
        if (length > kLongestStep) step.t *= kLongestStep / length;
        // Halve the step as long as this increases s, unless the gain is large enough.
        Separation longest{n, s_n};
        for (int halving = 0; halving < kMaxHalvings; ++halving, step.t *= 0.5) {
          const Separation next = better(longest, n + E * step.t);
          const bool helps = next.gap > longest.gap;
          if (!helps && longest.gap > s_n) break;
          longest = next;
          if (longest.gap - s_n > kEnough * step.gain) break;
        }
        improved = longest.gap > s_n;
        n = longest.normal;
        s_n = longest.gap;
        if (!improved) continue;
        radius = std::max(kMinRadius * size_, radius / (kStiffening * kStiffening));
        break;
      }
      if (!improved) break;
    }
    return {n, s_n};
  }

 private:
  Vec3<double> d_;
  Side a_, b_;
  double size_;
};

}  // namespace

Separation separation(const PlacedHull& a, const PlacedHull& b, double max_gap) {
  SeparationSearch search(a, b);
  const Vec3<double> d = a.c - b.c;
  // The start is the best one of the line of centres, the axes of the parts and the normals of end faces.
  Separation best{Vec3<double>::UnitZ(), -std::numeric_limits<double>::infinity()};
  bool at_end_face = false;
  const bool is_rough = !a.hull.rough_is_exact() || !b.hull.rough_is_exact();
  auto consider = [&](const Vec3<double>& n, bool is_end_face) {
    const double rough = search.rough_s(n);
    if (rough > max_gap) {
      const double s = is_rough ? search.s(n) : rough;
      if (s > max_gap) {
        best = {n, s};
        return true;
      }
    }
    // rough_s() is an upper bound, so it is compared only with other upper bounds, never with an exact s.
    if (rough > best.gap || (rough == best.gap && is_end_face)) {
      best = {n, rough};
      at_end_face = is_end_face;
    }
    return false;
  };
  if (d.squaredNorm() > 0 && consider(d.normalized(), false)) return best;
  for (const PlacedHull* part : {&a, &b}) {
    for (int k = 0; k < 3; ++k) {
      const Vec3<double> axis = part->R.col(k);
      if (consider(axis.dot(d) < 0 ? Vec3<double>(-axis) : axis, false)) return best;
    }
    for (int k = 0; part->hull.has_end_faces() && k < 2; ++k)
      if (consider((part == &a ? -1.0 : 1.0) * (part->R * part->hull.end_face_normal(k)), true)) return best;
  }
  if (is_rough) best.gap = search.s(best.normal);
  const double deep = -kDeep * std::min(a.thickness, b.thickness);
  auto ascend_from = [&](const Vec3<double>& n) {
    if (const Separation found = search.ascend(n, max_gap); found.gap > best.gap) best = found;
  };
  Vec3<double> n = best.normal;
  const bool is_flat = a.hull.has_flat_regions() || b.hull.has_flat_regions();
  if (!(at_end_face && search.is_maximum_at_face(n))) ascend_from(is_flat ? search.off_axis(n) : n);
  if (best.gap > deep) return best;
  for (const PlacedHull* part : {&a, &b})
    for (int k = 0; k < 3; ++k)
      for (const double sign : {1.0, -1.0}) ascend_from(search.off_axis(sign * part->R.col(k)));
  return best;
}

}  // namespace pliant
