// Function body of gather_velocity().
#pragma once

#include <pliant/body/constraint/group.h>
#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE void gather_velocity(const PartModel& m, const PartWorkspace<double>& w, const VecX<double>& v,
                                   Eigen::Ref<VecX<double>> x) {
  x.head(6 + m.n_s) = v.segment(m.v0, 6 + m.n_s);
  x.head<3>() = w.R.transpose() * v.segment<3>(m.v0);
  if (m.shared.empty()) return;
  VecX<double> buffer;
  x.tail(x.size() - 6 - m.n_s) = at_points(m.shared, m.local->at_nodes(v.data() + m.v0 + 6 + m.n_s, buffer));
}

}  // namespace pliant
