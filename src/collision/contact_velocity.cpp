// Relative velocity at a contact, and the largest depth that the search can resolve.
#include <algorithm>
#include <limits>

#include <pliant/collision/mesh/node_motion.h>
#include <pliant/math/index.h>

#include "finder_scratch.h"

namespace pliant {

double ContactFinder::max_resolved_depth(const Contact& contact) const {
  double thickness = std::numeric_limits<double>::infinity();
  for (const ContactSide* side : {&contact.a, &contact.b})
    if (side->part >= 0) thickness = std::min(thickness, surfaces_[at(side->part)]->thickness());
  return kMaxTravelShare * thickness;
}

Vec3<double> ContactFinder::velocity(const State& state, const Contact& contact) const {
  auto of = [&](const ContactSide& side) -> Vec3<double> {
    if (side.part < 0 || model_->parts()[at(side.part)].q0 < 0) return Vec3<double>::Zero();
    const PartModel& m = model_->parts()[at(side.part)];
    if (side.at_nodes()) {
      scratch_->nodes.clear();
      for (std::size_t k = 0; k < side.node.size() && side.node[k] >= 0; ++k)
        scratch_->nodes.push_back(side.node[k]);
      node_velocities(*model_, state, side.part, scratch_->nodes, scratch_->x_dot);
      return scratch_->x_dot * side.weight.head(scratch_->x_dot.cols());
    }
    const Mat3<double> R = model_->orientation(state, side.part).toRotationMatrix();
    const auto v = state.v.segment(m.v0, m.n_v());
    const Vec3<double> p = R.transpose() * (contact.x - state.q.segment<3>(m.q0));
    Vec3<double> p_dot = v.segment<3>(3).cross(p);
    if (m.n_s > 0) {
      Counters counters;
      scratch_->material[0] = side.material;
      m.part->points(scratch_->material, state.q.segment(m.q0 + 7, m.n_s), v.segment(6, m.n_s),
                     scratch_->jets, counters);
      p_dot += scratch_->jets[0].p1;
    }
    return v.head<3>() + R * p_dot;
  };
  return of(contact.a) - of(contact.b) - contact.prescribed_velocity;
}

}  // namespace pliant
