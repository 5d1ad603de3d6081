// Two bodies so deep in each other that each holds the other's centre, as they may start: the low points of
// one over the other lie on its far side then. They leave along the shortest way of a few,
//   depth(n) = h_a(-n) + h_b(n) - n . (c_a - c_b),
// h the support functions of their surfaces about their centres.
#include <limits>

#include <pliant/collision/ellipsoid_points.h>
#include <pliant/math/index.h>

#include "finder_scratch.h"

namespace pliant {

namespace {
/// Centres nearer than this, in sizes, tell no way out.
constexpr double kOneCentre = 1e-9;
/// And a centre this much outside of the other surface, in its w, counts as in it: there, low points lie at
/// it.
constexpr double kNearCentre = 0.1;
}  // namespace

/// The point of a part that is the farthest in a direction of the world, body frame.
Vec3<double> ContactFinder::farthest(int i, const Vec3<double>& direction) const {
  const Placed& placed = scratch_->parts[at(i)];
  const Vec3<double> n = placed.R.transpose() * direction;
  if (placed.axes) return placed.axes->cwiseProduct(lowest_direction(*placed.axes, -n));
  const Eigen::Matrix3Xd& p = points_of(i);
  Eigen::Index best = 0;
  (n.transpose() * p).maxCoeff(&best);
  return p.col(best);
}

bool ContactFinder::find_deep(int a, int b, const ContactRule& rule, std::vector<Contact>& found) const {
  const Placed &one = scratch_->parts[at(a)], &other = scratch_->parts[at(b)];
  const Part &part_a = *model_->parts()[at(a)].part, &part_b = *model_->parts()[at(b)].part;
  const Vec3<double> d = one.c - other.c;
  if (d.norm() > one.reach || d.norm() > other.reach) return false;
  const auto holds = [&](const Part& part, int i, const Vec3<double>& x) {
    return part.shape().mesh() == MeshPattern::ball &&
           part.inside_outside(scratch_->parts[at(i)].R.transpose() * x, scratch_->values[at(i)]) <
               kNearCentre;
  };
  if (!holds(part_b, b, d) || !holds(part_a, a, -d)) return false;
  std::vector<Vec3<double>> ways;
  if (d.norm() > kOneCentre * (part_a.size() + part_b.size())) ways.push_back(d.normalized());
  for (const Placed* placed : {&one, &other})
    for (int k = 0; k < 3; ++k) {
      const Vec3<double> axis = placed->R.col(k);
      ways.push_back(axis.dot(d) < 0 ? Vec3<double>(-axis) : axis);
    }
  double widest = -std::numeric_limits<double>::infinity();
  Vec3<double> normal(0, 0, 1), of_a(0, 0, 0);
  for (const Vec3<double>& n : ways) {
    const Vec3<double> from = farthest(a, -n), to = farthest(b, n);
    const double gap = n.dot(d + one.R * from - other.R * to);
    if (!(gap > widest)) continue;
    widest = gap;
    normal = n;
    of_a = from;
  }
  found.push_back(contact_at(one.c + one.R * of_a, normal, widest, a, b, rule));
  return true;
}

}  // namespace pliant
