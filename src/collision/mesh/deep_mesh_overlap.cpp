// Deep overlap of two meshes, which can happen at the start of a run. The vertices of one mesh are then
// nearer to the far side of the other mesh. Contacts of single vertices and edges would have wrong normals or
// cause dents. The parts are separated as wholes along the direction n of least depth among a few candidates,
//   depth(n) = max_b n . x - min_a n . x,
// over their vertices x.
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

/// If neither mesh contains the centre of the other, an overlap is deep on two conditions. It exceeds kDeep
/// times the thickness of the thinner part. It exceeds kTravels times the distance by which the last step can
/// have moved the parts relative to each other.
constexpr double kDeep = 0.06, kTravels = 2;
/// The line of centres is a candidate only if the distance of the centres exceeds this, times the sum of the
/// radii of the bounding balls.
constexpr double kSameCentre = 1e-9;

/// Whether a point is inside a closed mesh. Seen from an inside point, the solid angle of the mesh is 4 pi;
/// from an outside point it is 0 (van Oosterom and Strackee 1983). Two cheap tests exclude most outside
/// points first.
bool mesh_contains(const PlacedMesh& m, const Vec3<double>& x) {
  if (!m.box.contains(x)) return false;
  const Vec3<double> outward = x - m.box.center();
  if (outward.dot(x) > (outward.transpose() * m.x).maxCoeff()) return false;
  double angle = 0;  // solid angle, sr
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

/// Returns a bound of the motion of any point of a part in the last step relative to the origin of its frame,
/// m. The bound uses the velocities at the end of the step.
double MeshFinder::local_travel(const State& state, double t, const BoundingBall& ball) const {
  const PartModel& m = model_->parts()[at(ball.part)];
  if (m.q0 >= 0)
    return state.h * (ball.reach * state.v.segment<3>(m.v0 + 3).norm() + meshes_.at(ball.part).speed(state));
  return m.motion == nullptr ? 0 : state.h * ball.reach * m.motion->at(t).omega.norm();
}

bool MeshFinder::is_deep_overlap(const State& state, double t, const BoundingBall& one,
                                 const BoundingBall& other, const PlacedMesh& a, const PlacedMesh& b,
                                 const std::vector<MeshTouch>& touches) const {
  if (mesh_contains(a, other.c) || mesh_contains(b, one.c)) return true;
  double depth = 0;
  for (const MeshTouch& touch : touches) depth = std::max(depth, -touch.gap);
  if (!(depth > kDeep * std::min(a.mesh->thickness(), b.mesh->thickness()))) return false;
  auto c_dot = [&](const BoundingBall& ball) -> Vec3<double> {
    const PartModel& m = model_->parts()[at(ball.part)];
    if (m.q0 < 0) return frame_velocity(ball.part, t, ball.c);
    return state.v.segment<3>(m.v0);
  };
  return depth > kTravels * (state.h * (c_dot(one) - c_dot(other)).norm() + local_travel(state, t, one) +
                             local_travel(state, t, other));
}

Contact MeshFinder::separation_contact(const State& state, double t, const BoundingBall& one,
                                       const BoundingBall& other, const PlacedMesh& a,
                                       const PlacedMesh& b) const {
  const Vec3<double> d = one.c - other.c;
  std::vector<Vec3<double>> directions;
  if (d.norm() > kSameCentre * (one.reach + other.reach)) directions.push_back(d.normalized());
  for (const int part : {one.part, other.part}) {
    const Mat3<double> R = model_->orientation(state, part, t).toRotationMatrix();
    for (int k = 0; k < 3; ++k)
      directions.push_back(R.col(k).dot(d) < 0 ? Vec3<double>(-R.col(k)) : Vec3<double>(R.col(k)));
  }
  Contact contact;
  contact.gap = -std::numeric_limits<double>::infinity();
  for (const Vec3<double>& n : directions) {
    const double gap = (n.transpose() * a.x).minCoeff() - (n.transpose() * b.x).maxCoeff();
    if (!(gap > contact.gap)) continue;
    contact.gap = gap;
    contact.normal = n;
  }
  contact.x = a.box.intersection(b.box).center();
  auto whole_part = [&](int part) {
    ContactSide side;
    side.part = part;
    if (const PartModel& m = model_->parts()[at(part)]; m.n_s > 0)
      side.material = m.part->label(
          model_->orientation(state, part).conjugate() * (contact.x - model_->position(state, part)),
          model_->values(state, part));
    return side;
  };
  contact.a = whole_part(one.part);
  contact.b = whole_part(other.part);
  return contact;
}

}  // namespace pliant
