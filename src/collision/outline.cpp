// Reduction of the contacts of one pair to the corners of their convex hull.
#include "outline.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include <Eigen/Geometry>
#include <Eigen/QR>

namespace pliant {

namespace {

/// Contacts belong to one face on two conditions. Their normals differ by at most kOneNormal. Their gaps
/// differ from a linear function of the position on the face by at most kOnePlane, in sizes of the smaller
/// part.
constexpr double kOneNormal = 1e-6, kOnePlane = 1e-7;
/// A point of the hull is a corner of the outline if its distance from the chord of its neighbours exceeds
/// this, in sizes.
constexpr double kMinCorner = 1e-5;
/// A contact that is deeper than all corners by more than this, in sizes, is kept.
constexpr double kDeeper = 1e-11;
/// Up to this many contacts are all kept.
constexpr std::size_t kAlwaysKept = 4;

struct Place {
  Eigen::Vector2d p;
  std::size_t number;
};

/// Twice the area of a triangle, positive if a, b, c are counter-clockwise.
double turn(const Place& a, const Place& b, const Place& c) {
  const Eigen::Vector2d ab = b.p - a.p, ac = c.p - a.p;
  return ab.x() * ac.y() - ab.y() * ac.x();
}

/// Distance of b from the segment from a to c.
double distance_to_chord(const Place& a, const Place& b, const Place& c) {
  const Eigen::Vector2d ac = c.p - a.p, ab = b.p - a.p;
  const double square = ac.squaredNorm(), along = square > 0 ? std::clamp(ab.dot(ac) / square, 0.0, 1.0) : 0;
  return (ab - along * ac).norm();
}

/// Returns the convex hull of points, counter-clockwise, by Andrew's monotone chains (1979). The hull may
/// keep points on its straight sides because of rounding; keep_outline() removes them.
std::vector<Place> hull(std::vector<Place> places) {
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    if (a.p.x() != b.p.x()) return a.p.x() < b.p.x();
    return a.p.y() < b.p.y() || (a.p.y() == b.p.y() && a.number < b.number);
  });
  std::vector<Place> around;
  auto add_side = [&](auto begin, auto end) {
    const std::size_t start = around.size();
    for (auto place = begin; place != end; ++place) {
      while (around.size() >= start + 2 && !(turn(around.end()[-2], around.back(), *place) > 0))
        around.pop_back();
      around.push_back(*place);
    }
    around.pop_back();  // first point of the other side
  };
  add_side(places.begin(), places.end());
  add_side(places.rbegin(), places.rend());
  return around;
}

}  // namespace

void keep_outline(std::vector<Contact>& contacts, std::size_t first, double size) {
  if (contacts.size() <= first + kAlwaysKept) return;
  const Vec3<double> normal = contacts[first].normal, e1 = normal.unitOrthogonal(), e2 = normal.cross(e1);
  const auto n = static_cast<Eigen::Index>(contacts.size() - first);
  std::vector<Place> places;
  Eigen::MatrixX3d A(n, 3);
  VecX<double> gaps(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t k = first + static_cast<std::size_t>(i);
    if ((contacts[k].normal - normal).norm() > kOneNormal) return;
    const Vec3<double> d = contacts[k].x - contacts[first].x;
    places.push_back({{d.dot(e1), d.dot(e2)}, k});
    A.row(i) << size, places.back().p.x(), places.back().p.y();
    gaps[i] = contacts[k].gap;
  }
  if (!A.allFinite()) return;
  if ((A * A.colPivHouseholderQr().solve(gaps) - gaps).lpNorm<Eigen::Infinity>() > kOnePlane * size) return;
  std::vector<Place> around = hull(std::move(places));
  for (std::size_t k = 0; k < around.size() && around.size() > 2;) {
    const Place &before = around[(k + around.size() - 1) % around.size()],
                &after = around[(k + 1) % around.size()];
    if (distance_to_chord(before, around[k], after) > kMinCorner * size)
      ++k;
    else
      around.erase(around.begin() + static_cast<std::ptrdiff_t>(k));
  }
  std::vector<bool> corner(contacts.size(), false);
  double deepest = std::numeric_limits<double>::infinity();  // least gap of the corners, m
  for (const Place& place : around) {
    corner[place.number] = true;
    deepest = std::min(deepest, contacts[place.number].gap);
  }
  Eigen::Index least = 0;
  if (gaps.minCoeff(&least) < deepest - kDeeper * size)
    corner[first + static_cast<std::size_t>(least)] = true;
  std::size_t kept = first;
  for (std::size_t k = first; k < contacts.size(); ++k)
    if (corner[k]) contacts[kept++] = contacts[k];
  contacts.resize(kept);
}

}  // namespace pliant
