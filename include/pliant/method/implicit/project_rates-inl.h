// Function bodies of project_rates.h: the projection of the changes of rates, island by island and part by
// part.
#pragma once

#include <pliant/method/implicit/project_rates.h>

#include <algorithm>
#include <memory>
#include <vector>

#include <pliant/body/advance.h>
#include <pliant/body/constraint/group.h>
#include <pliant/math/column_basis.h>
#include <pliant/math/header_only.h>
#include <pliant/project/projection.h>

namespace pliant {

namespace rate_projection {

/// Copies the metric of a part to `filtered`: the inverse of the compliance of an implicit part, or the mass
/// matrix of an explicit part (`implicit` is nullptr).
inline void copy_metric(const ImplicitPart* implicit, const PartWorkspace<double>& w,
                        PartWorkspace<double>& filtered) {
  if (implicit != nullptr) {
    if (!filtered.local) filtered.local = std::make_unique<LocalWorkspace>();
    filtered.local->set_compliance(implicit->compliance());
    filtered.inertia.M = filtered.local->A_inverse;
    return;
  }
  filtered.rigid = w.rigid;
  filtered.factor = w.factor;
  filtered.inertia.M = w.inertia.M;
}

/// Projects x, the changes of the rates by the filter, so that the rows of joints and the pushed rows vanish.
/// pushed: the rows of strings that pull and of limits that push. Three passes refine x if the factor of the
/// joints is not accurate.
template <int Max>
void project(const Group<double, Max>& group, const std::vector<OneSidedRow>& pushed,
             VecMax<double, Max>& x) {
  if (group.island() != nullptr) {
    const int passes = group.is_rough() ? 3 : 1;
    VecX<double> rows;
    for (int pass = 0; pass < passes; ++pass) {
      group.joint_rows(x, rows);
      group.correct(rows, x);
    }
  }
  if (pushed.empty()) return;
  const auto n = static_cast<Eigen::Index>(pushed.size());
  MatX<double> W(n, n), responses(group.size(), n);
  VecX<double> b(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const VecMax<double, Max> response = group.response(pushed[static_cast<std::size_t>(k)]);
    responses.col(k) = response;
    b[k] = -group.value(pushed[static_cast<std::size_t>(k)], x);
    for (Eigen::Index i = 0; i < n; ++i) W(i, k) = group.value(pushed[static_cast<std::size_t>(i)], response);
  }
  x += responses * least_norm(W, b);
}

/// Projects the changes that the filter made to the rates of a group, and adds the corrections to v_dot.
template <int Max>
void project_group_rates(const Group<double, Max>& group, const std::vector<OneSidedRow>& pushed,
                         const ImplicitParts& parts, const Workspace<double>& work, VecX<double>& v_dot) {
  VecMax<double, Max> before, x;
  group.gather(before, [&](int i) -> VecX<double> {
    const ImplicitPart* implicit = parts[at(group.part(i))].get();
    return implicit != nullptr ? implicit->change() : VecX<double>::Zero(group.model(i).n_x());
  });
  x = before;
  project(group, pushed, x);
  before = x - before;
  for (int i = 0; i < group.parts(); ++i) {
    const VecX<double> change = group.share(before, i);
    const PartWorkspace<double>& w = work.parts[at(group.part(i))];
    const PartModel& m = group.model(i);
    part_velocities(m, v_dot) += world_velocity(w, change.head(6 + m.n_s));
    if (const ImplicitPart* implicit = parts[at(group.part(i))].get())
      implicit->push(group.workspace(i).inertia.M * change, v_dot.segment(m.v0 + 6 + m.n_s, m.n_d()));
    for (const OneSidedRow& row : pushed)
      if (row.part == i) v_dot[m.v0 + 6 + row.k] = 0;  // exactly zero
  }
}

}  // namespace rate_projection

PLIANT_INLINE bool has_implicit(const Island& island, const ImplicitParts& parts) {
  return std::any_of(island.parts.begin(), island.parts.end(),
                     [&](int i) { return parts[at(i)] != nullptr; });
}

PLIANT_INLINE void project_rates(const Model& model, const ImplicitParts& parts,
                                 const Workspace<double>& work, Workspace<double>& filtered,
                                 VecX<double>& v_dot) {
  filtered.parts.resize(model.parts().size());
  for (std::size_t i = 0; i < model.parts().size(); ++i) {
    const std::vector<int>& pressed = work.parts[i].pressed;
    if (parts[i] == nullptr || model.parts()[i].island >= 0 || pressed.empty()) continue;
    rate_projection::copy_metric(parts[i].get(), work.parts[i], filtered.parts[i]);
    std::vector<OneSidedRow> rows;
    for (const int k : pressed) rows.push_back({0, k, 1, 0});
    rate_projection::project_group_rates(Group<double, kMaxVelocities>(model, filtered, static_cast<int>(i)),
                                         rows, parts, work, v_dot);
  }
  const ConstraintWorkspace<double>& joints = work.joints;
  for (std::size_t k = 0; k < model.islands().size(); ++k) {
    const Island& island = model.islands()[k];
    if (!has_implicit(island, parts)) continue;
    filtered.joints.modes = joints.modes;
    filtered.joints.rank = joints.rank;
    filtered.joints.C = joints.C;
    filtered.joints.Cq = joints.Cq;
    filtered.joints.Y.resize(joints.Y.size());
    filtered.joints.W_c.resize(model.islands().size());
    filtered.joints.W_closed.resize(model.islands().size());
    filtered.joints.vectors.resize(model.islands().size());
    for (const int i : island.parts)
      rate_projection::copy_metric(parts[at(i)].get(), work.parts[at(i)], filtered.parts[at(i)]);
    factor_joints<double>(model, island, filtered.parts, filtered.joints);
    rate_projection::project_group_rates(Group<double, Eigen::Dynamic>(model, filtered, island, false),
                                         joints.pushed[k], parts, work, v_dot);
  }
}

}  // namespace pliant
