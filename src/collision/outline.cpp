// Reduction of the contacts of one pair to the corners of their convex hull.
#include "outline.h"

#include <algorithm>
#include <limits>

#include <Eigen/Geometry>
#include <Eigen/QR>

#include "collision/hull/polygon.h"

namespace pliant {

namespace {

/// Contacts belong to one face on two conditions. Their normals differ by at most kOneNormal. Their gaps
/// differ from a linear function of the position on the face by at most kOnePlane, in sizes of the smaller
/// part.
constexpr double kOneNormal = 1e-6, kOnePlane = 1e-7;
/// A point of the hull is a corner of the outline if its distance from the chord of its neighbours exceeds
/// this, in sizes.
constexpr double kMinCorner = 1e-5;
/// The deepest contact is also kept if it is deeper than all corners by more than this, in sizes.
constexpr double kDeeper = 1e-11;
/// If there are at most this many contacts, all are kept.
constexpr std::size_t kAlwaysKept = 4;

}  // namespace

void keep_outline(std::vector<Contact>& contacts, std::size_t first, double size) {
  if (contacts.size() <= first + kAlwaysKept) return;
  const Vec3<double> normal = contacts[first].normal, e1 = normal.unitOrthogonal(), e2 = normal.cross(e1);
  const auto n = static_cast<Eigen::Index>(contacts.size() - first);
  std::vector<Point2> places;
  Eigen::MatrixX3d A(n, 3);
  VecX<double> gaps(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t k = first + static_cast<std::size_t>(i);
    if ((contacts[k].normal - normal).norm() > kOneNormal) return;
    const Vec3<double> d = contacts[k].x - contacts[first].x;
    places.emplace_back(d.dot(e1), d.dot(e2));
    A.row(i) << size, places.back().x(), places.back().y();
    gaps[i] = contacts[k].gap;
  }
  if (!A.allFinite()) return;
  if ((A * A.colPivHouseholderQr().solve(gaps) - gaps).lpNorm<Eigen::Infinity>() > kOnePlane * size) return;
  std::vector<std::size_t> around = convex_hull(places);  // numbers from 0 for the contact `first`
  for (std::size_t k = 0; k < around.size() && around.size() > 2;) {
    const Point2 &before = places[around[(k + around.size() - 1) % around.size()]],
                 &after = places[around[(k + 1) % around.size()]];
    if (const Point2& corner_place = places[around[k]];
        (corner_place - nearest_on_segment(before, after, corner_place)).norm() > kMinCorner * size)
      ++k;
    else
      around.erase(around.begin() + static_cast<std::ptrdiff_t>(k));
  }
  std::vector<bool> corner(contacts.size(), false);
  double deepest = std::numeric_limits<double>::infinity();  // least gap of the corners, m
  for (const std::size_t number : around) {
    corner[first + number] = true;
    deepest = std::min(deepest, contacts[first + number].gap);
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
