#include "outline.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <Eigen/QR>

namespace pliant {

namespace {

/// Normals of one face turn by less than this, and its gaps are those of a plane to this, in sizes.
constexpr double kOneNormal = 1e-6, kOnePlane = 1e-7;
/// A corner stands out by more than this, in sizes.
constexpr double kStraight = 1e-5;
/// So few contacts are all kept.
constexpr std::size_t kFew = 4;

}  // namespace

void keep_outline(std::vector<Contact>& contacts, std::size_t first, double size) {
  if (contacts.size() <= first + kFew) return;
  struct Place {
    double x, y;
    std::size_t number;
  };
  const Vec3<double> normal = contacts[first].normal, e1 = normal.unitOrthogonal(), e2 = normal.cross(e1);
  const auto n = static_cast<Eigen::Index>(contacts.size() - first);
  std::vector<Place> places;
  Eigen::MatrixX3d A(n, 3);
  VecX<double> gaps(n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const std::size_t k = first + static_cast<std::size_t>(i);
    if ((contacts[k].normal - normal).norm() > kOneNormal) return;
    const Vec3<double> d = contacts[k].x - contacts[first].x;
    places.push_back({d.dot(e1), d.dot(e2), k});
    A.row(i) << size, places.back().x, places.back().y;
    gaps[i] = contacts[k].gap;
  }
  if ((A * A.colPivHouseholderQr().solve(gaps) - gaps).lpNorm<Eigen::Infinity>() > kOnePlane * size) return;
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    if (a.x != b.x) return a.x < b.x;
    return a.y < b.y || (a.y == b.y && a.number < b.number);
  });
  std::vector<bool> corner(contacts.size(), false);
  // One side of the outline, from one end to the other, by Andrew's monotone chain (1979).
  auto mark = [&](auto begin, auto end) {
    std::vector<Place> side;
    for (auto place = begin; place != end; ++place) {
      while (side.size() >= 2) {
        const Place &a = side[side.size() - 2], &b = side.back();
        const double dx = place->x - a.x, dy = place->y - a.y;
        const double out = dx * (a.y - b.y) + dy * (b.x - a.x);  // times the distance to the next
        if (out > kStraight * size * std::hypot(dx, dy)) break;
        side.pop_back();
      }
      side.push_back(*place);
    }
    for (const Place& place : side) corner[place.number] = true;
  };
  mark(places.begin(), places.end());
  mark(places.rbegin(), places.rend());
  std::size_t kept = first;
  for (std::size_t k = first; k < contacts.size(); ++k)
    if (corner[k]) contacts[kept++] = contacts[k];
  contacts.resize(kept);
}

}  // namespace pliant
