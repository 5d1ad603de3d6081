// Two meshes so deep in each other, as parts may start, that their vertices and edges do not tell the way
// out: those of one are nearer to the far side of the other, or dent it. The parts leave as wholes, along the
// shortest way of a few,
//   depth(n) = max_b n . x - min_a n . x,
// over their vertices.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/math/index.h>
#include <pliant/math/scalar/functions.h>

namespace pliant {

namespace {

/// A vertex is deep from this share of the thickness of the thinner part on, where it is deeper than this
/// many ways that the step has moved the parts against each other.
constexpr double kDeep = 0.06, kWays = 2;
/// Centres nearer than this, in sizes, tell no way out.
constexpr double kSameCentre = 1e-9;

/// Whether a point is in a closed mesh: it sees the whole of it all around.
bool holds(const PlacedMesh& m, const Vec3<double>& x) {
  if (!m.box.contains(x)) return false;
  const Vec3<double> outward = x - m.box.center();
  if (outward.dot(x) > (outward.transpose() * m.x).maxCoeff()) return false;
  double angle = 0;  // solid
  const Eigen::Matrix3Xi& triangles = m.mesh->triangles();
  for (Eigen::Index t = 0; t < triangles.cols(); ++t) {
    const Vec3<double> p = m.x.col(triangles(0, t)) - x, q = m.x.col(triangles(1, t)) - x,
                       r = m.x.col(triangles(2, t)) - x;
    const double a = p.norm(), b = q.norm(), c = r.norm();
    angle += 2 * std::atan2(p.dot(q.cross(r)), a * b * c + p.dot(q) * c + q.dot(r) * a + r.dot(p) * b);
  }
  return angle > 2 * kPi;
}

}  // namespace

/// No point of a part goes further in the last step than this beside what its frame moves by, m.
double MeshFinder::own_way(const State& state, double t, const Around& ball) const {
  const PartModel& m = model_->parts()[at(ball.part)];
  if (m.q0 >= 0)
    return state.h * (ball.reach * state.v.segment<3>(m.v0 + 3).norm() + meshes_.at(ball.part).speed(state));
  return m.motion == nullptr ? 0 : state.h * ball.reach * m.motion->at(t).omega.norm();
}

bool MeshFinder::are_deep(const State& state, double t, const Around& one, const Around& other,
                          const PlacedMesh& a, const PlacedMesh& b,
                          const std::vector<MeshTouch>& touches) const {
  if (holds(a, other.c) || holds(b, one.c)) return true;
  double depth = 0;
  for (const MeshTouch& touch : touches) depth = std::max(depth, -touch.gap);
  if (!(depth > kDeep * std::min(a.mesh->thickness(), b.mesh->thickness()))) return false;
  auto c_dot = [&](const Around& ball) -> Vec3<double> {
    const PartModel& m = model_->parts()[at(ball.part)];
    if (m.q0 < 0) return carries(ball.part, t, ball.c);
    return state.v.segment<3>(m.v0);
  };
  return depth > kWays * (state.h * (c_dot(one) - c_dot(other)).norm() + own_way(state, t, one) +
                          own_way(state, t, other));
}

Contact MeshFinder::way_out(const State& state, double t, const Around& one, const Around& other,
                            const PlacedMesh& a, const PlacedMesh& b) const {
  const Vec3<double> d = one.c - other.c;
  std::vector<Vec3<double>> ways;
  if (d.norm() > kSameCentre * (one.reach + other.reach)) ways.push_back(d.normalized());
  for (const int part : {one.part, other.part}) {
    const Mat3<double> R = model_->orientation(state, part, t).toRotationMatrix();
    for (int k = 0; k < 3; ++k)
      ways.push_back(R.col(k).dot(d) < 0 ? Vec3<double>(-R.col(k)) : Vec3<double>(R.col(k)));
  }
  Contact contact;
  contact.gap = -std::numeric_limits<double>::infinity();
  for (const Vec3<double>& n : ways) {
    const double gap = (n.transpose() * a.x).minCoeff() - (n.transpose() * b.x).maxCoeff();
    if (!(gap > contact.gap)) continue;
    contact.gap = gap;
    contact.normal = n;
  }
  contact.x = a.box.intersection(b.box).center();
  auto whole = [&](int part) {
    ContactSide side;
    side.part = part;
    if (const PartModel& m = model_->parts()[at(part)]; m.n_s > 0)
      side.material = m.part->label(
          model_->orientation(state, part).conjugate() * (contact.x - model_->position(state, part)),
          model_->values(state, part));
    return side;
  };
  contact.a = whole(one.part);
  contact.b = whole(other.part);
  return contact;
}

}  // namespace pliant
