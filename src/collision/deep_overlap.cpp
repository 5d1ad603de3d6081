// Deep overlap: each of two parts contains the centre of the other, which can happen at the start of a run.
// The points of one surface that are deepest inside the other part are then beyond the centre of that part,
// where its outward normal points in the wrong direction. The contact normal is the direction n of least
// depth among a few candidates,
//   depth(n) = h_a(-n) + h_b(n) - n . (c_a - c_b),
// where h_a and h_b are the support functions of the surfaces about their centres.
#include <limits>

#include <pliant/collision/ellipsoid_points.h>
#include <pliant/math/index.h>

#include "collision/hull/hull.h"
#include "finder_scratch.h"

namespace pliant {

namespace {
/// The line of centres is a candidate only if the distance of the centres exceeds this, times the sum of the
/// sizes.
constexpr double kOneCentre = 1e-9;
/// The centre of part a is treated as inside part b if f = w - 1 of b is less than this at the centre. A
/// centre slightly outside b (f > 0) is included, too: the points of b that are deepest inside a are then
/// close to the centre of a, where the gradient of f of a gives no reliable normal.
constexpr double kNearCentre = 0.1;
}  // namespace

/// Returns the point (body frame, m) of a part that is farthest in a direction (world).
Vec3<double> ContactFinder::support_point(int i, const Vec3<double>& direction) const {
  const Placed& placed = scratch_->parts[at(i)];
  const Vec3<double> n = placed.R.transpose() * direction;
  if (placed.axes) return placed.axes->cwiseProduct(lowest_direction(*placed.axes, -n));
  if (uses_hull(i))
    return Hull(*model_->parts()[at(i)].part, scratch_->values[at(i)], Hull::Convexity::convex).support(n);
  const Eigen::Matrix3Xd& p = points_of(i);
  Eigen::Index best = 0;
  (n.transpose() * p).maxCoeff(&best);
  return p.col(best);
}

/// Returns whether two parts overlap deeply; if so, appends their contact. A torus never overlaps deeply,
/// because its centre is not inside the torus.
bool ContactFinder::find_deep_overlap(int a, int b, const ContactRule& rule,
                                      std::vector<Contact>& found) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  const Part &part_a = *model_->parts()[at(a)].part, &part_b = *model_->parts()[at(b)].part;
  const Vec3<double> d = one.c - other.c;
  if (d.norm() > one.reach || d.norm() > other.reach) return false;
  const auto contains = [&](const Part& part, int i, const Vec3<double>& x) {
    return part.shape().mesh() == MeshPattern::ball &&
           part.inside_outside(scratch_->parts[at(i)].R.transpose() * x, scratch_->values[at(i)]) <
               kNearCentre;
  };
  if (!contains(part_b, b, d) || !contains(part_a, a, -d)) return false;
  std::vector<Vec3<double>> directions;
  if (d.norm() > kOneCentre * (part_a.size() + part_b.size())) directions.push_back(d.normalized());
  for (const Placed* placed : {&one, &other})
    for (int k = 0; k < 3; ++k) {
      const Vec3<double> axis = placed->R.col(k);
      directions.push_back(axis.dot(d) < 0 ? Vec3<double>(-axis) : axis);
    }
  double best_gap = -std::numeric_limits<double>::infinity();
  Vec3<double> normal(0, 0, 1), of_a(0, 0, 0);
  for (const Vec3<double>& n : directions) {
    const Vec3<double> from = support_point(a, -n), to = support_point(b, n);
    const double gap = n.dot(d + one.R * from - other.R * to);
    if (!(gap > best_gap)) continue;
    best_gap = gap;
    normal = n;
    of_a = from;
  }
  found.push_back(contact_at(one.c + one.R * of_a, normal, best_gap, a, b, rule));
  return true;
}

}  // namespace pliant
