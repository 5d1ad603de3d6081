// Poses of the parts and planes of a ContactFinder at a time, and boxes that contain the parts.
#include <pliant/body/multibody.h>
#include <pliant/math/index.h>

#include "finder_scratch.h"

namespace pliant {

/// Whether the shape of a part never changes.
bool ContactFinder::has_fixed_shape(int i) const {
  return model_->parts()[at(i)].q0 < 0 || model_->parts()[at(i)].n_s == 0;
}

double ContactFinder::reach(const State& state, int i) const {
  return surfaces_[at(i)]->reach(has_fixed_shape(i) ? scratch_->values[at(i)] : model_->values(state, i));
}

void ContactFinder::place(const State& state, double t, int i) const {
  const PartModel& m = model_->parts()[at(i)];
  ParameterValues<double>& values = scratch_->values[at(i)];
  Placed& placed = scratch_->parts[at(i)];
  const bool is_fixed = has_fixed_shape(i);
  if (!is_fixed)
    for (int k = 0; k < m.n_s; ++k) {
      const auto parameter = at(m.part->parameters().dynamic()[at(k)]);
      const double value = state.q[m.q0 + 7 + k];
      if (values.b[parameter] != value) {
        placed.points_current = false;
        placed.hull.reset();
        placed.convex.reset();
      }
      values.b[parameter] = value;
      values.b_dot[parameter] = state.v[m.v0 + 6 + k];
    }
  placed.c = model_->position(state, i, t);
  placed.R = model_->orientation(state, i, t).toRotationMatrix();
  if (m.motion != nullptr) {
    const MovingFrame frame = m.motion->at(t);
    placed.c_dot = frame.c_dot;
    placed.omega = frame.omega;
  }
  if (is_fixed && placed.shape_known) return;
  placed.shape_known = true;
  placed.axes = surfaces_[at(i)]->semi_axes(values);
  placed.half = surfaces_[at(i)]->half_sizes(values);
  placed.reach = surfaces_[at(i)]->reach(values);
}

const Eigen::Matrix3Xd& ContactFinder::points_of(int i) const {
  if (has_fixed_shape(i)) return surfaces_[at(i)]->rest_points();
  Eigen::Matrix3Xd& points = scratch_->points[at(i)];
  if (!scratch_->parts[at(i)].points_current) points = surfaces_[at(i)]->points(scratch_->values[at(i)]);
  scratch_->parts[at(i)].points_current = true;
  return points;
}

/// Returns a box in the body frame that contains the sample points of a part. For an ellipsoid and for a
/// fixed shape the box contains the whole surface.
Eigen::AlignedBox3d ContactFinder::body_box(int i) const {
  const Placed& placed = scratch_->parts[at(i)];
  if (placed.axes) return {-*placed.axes, *placed.axes};
  if (has_fixed_shape(i)) return surfaces_[at(i)]->rest_box();
  const Eigen::Matrix3Xd& p = points_of(i);
  return {p.rowwise().minCoeff(), p.rowwise().maxCoeff()};
}

/// Returns a box in the world that contains a part. If the part has dynamic parameters and is no ellipsoid,
/// the box is that of a ball of radius Placed::reach.
Eigen::AlignedBox3d ContactFinder::world_box(int i) const {
  const Placed& placed = scratch_->parts[at(i)];
  Vec3<double> middle = placed.c, half = Vec3<double>::Constant(placed.reach);
  if (placed.axes) {
    half = (placed.R * placed.axes->asDiagonal()).rowwise().norm();
  } else if (has_fixed_shape(i)) {
    const Eigen::AlignedBox3d& box = surfaces_[at(i)]->rest_box();
    middle += placed.R * box.center();
    half = placed.R.cwiseAbs() * (0.5 * box.sizes());
    half.array() += kBulge * model_->parts()[at(i)].size;
  }
  return {middle - half, middle + half};
}

void ContactFinder::place_planes(double t) const {
  scratch_->planes.clear();
  for (const ContactPlane& plane : model_->body().contact.planes) {
    const Vec3<Taylor2<double>> moving = plane.point.at(t);
    scratch_->planes.push_back({plane.acts_before(t),
                                {moving[0].v, moving[1].v, moving[2].v},
                                {moving[0].d, moving[1].d, moving[2].d}});
  }
}

}  // namespace pliant
