// Function bodies of touched_parts.h: the evaluation of touched parts before the contact problem, and the
// application of its solution.
#pragma once

#include <pliant/contact/touched_parts.h>

#include <algorithm>

#include <pliant/body/advance.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace touched_parts {

/// Sorts numbers and removes repetitions.
inline void sort_unique(std::vector<int>& numbers) {
  std::sort(numbers.begin(), numbers.end());
  numbers.erase(std::unique(numbers.begin(), numbers.end()), numbers.end());
}

/// Calls act(mover, part, index of the first velocity of the part in the mover) for each part of each mover,
/// and then for each node.
template <class F>
void for_each_part(const std::vector<Mover>& movers, F&& act) {
  for (const Mover& mover : movers) {
    if (mover.node >= 0) continue;
    if (mover.island == nullptr) {
      act(mover, mover.part, 0);
      continue;
    }
    for (std::size_t i = 0; i < mover.island->parts.size(); ++i)
      act(mover, mover.island->parts[i], mover.island->first[i]);
  }
  for (const Mover& mover : movers)
    if (mover.node >= 0) act(mover, mover.part, 0);
}

/// Adds d to the displacement of a node, or to its rate.
inline void add_to_node(const Model& model, const Mover& mover, const Vec3<double>& d,
                        Eigen::Ref<VecX<double>> q_d) {
  const Eigen::Index n = model.parts()[at(mover.part)].local->mesh().X.rows();
  for (Eigen::Index r = 0; r < 3; ++r) q_d[mover.node + r * n] += d[r];
}

/// A part of a mover, and the index of the first velocity of the part in the mover.
struct PartOfMover {
  const Mover& mover;
  int part, first;
};

/// Applies a solution to a part whose local coordinates all move. m, w: of this part.
inline void displace_locally(const ContactProblem& problem, const PartOfMover& share, const PartModel& m,
                             const PartWorkspace<double>& w, State& state) {
  const Eigen::Index n_r = 6 + m.n_s;
  const VecX<double> x = problem.after(share.mover), shift = problem.shift(share.mover);
  const int first = share.first, local = problem.movers().first_local(share.mover, share.part);
  part_velocities(m, state.v) = world_velocity(w, x.segment(first, n_r));
  state.v.segment(m.v0 + n_r, m.n_d()) = x.segment(local, m.n_d());
  advance_part(m, state.q, world_velocity(w, shift.segment(first, n_r)), 1);
  state.q.segment(m.q0 + 1 + n_r, m.n_d()) += shift.segment(local, m.n_d());
}

}  // namespace touched_parts

PLIANT_INLINE std::vector<int> parts_touched(const Model& model, const std::vector<Contact>& contacts) {
  std::vector<int> touched;
  std::vector<bool> islands(model.islands().size(), false);
  for (const Contact& contact : contacts)
    for (const int part : {contact.a.part, contact.b.part}) {
      if (part < 0 || model.parts()[at(part)].q0 < 0) continue;
      const int island = model.parts()[at(part)].island;
      if (island < 0) {
        touched.push_back(part);
      } else if (!islands[at(island)]) {
        islands[at(island)] = true;
        const std::vector<int>& parts = model.islands()[at(island)].parts;
        touched.insert(touched.end(), parts.begin(), parts.end());
      }
    }
  touched_parts::sort_unique(touched);
  return touched;
}

PLIANT_INLINE bool are_driven(const Model& model, const std::vector<int>& parts) {
  return std::any_of(parts.begin(), parts.end(), [&](int part) {
    const int island = model.parts()[at(part)].island;
    if (island < 0) return false;
    const std::vector<int>& joints = model.islands()[at(island)].joints;
    return std::any_of(joints.begin(), joints.end(), [&](int j) { return model.joints()[at(j)].driven; });
  });
}

PLIANT_INLINE bool has_prescribed_motion(const Model& model, const std::vector<Contact>& contacts) {
  auto moves = [&](const ContactSide& side) {
    return side.part >= 0 && model.parts()[at(side.part)].motion != nullptr;
  };
  return std::any_of(contacts.begin(), contacts.end(),
                     [&](const Contact& c) {
                       return moves(c.a) || moves(c.b) ||
                              (c.plane >= 0 && !model.body().contact.planes[at(c.plane)].point.is_constant());
                     }) ||
         are_driven(model, parts_touched(model, contacts));
}

PLIANT_INLINE void evaluate_touched(const Dynamics& dynamics, const State& state, double t,
                                    const std::vector<Contact>& contacts, Workspace<double>& work) {
  const Model& model = dynamics.model();
  std::vector<int> alone, islands, by_nodes;
  for (const Contact& contact : contacts)
    for (const ContactSide& side : {contact.a, contact.b}) {
      if (side.part < 0) continue;
      const PartModel& m = model.parts()[at(side.part)];
      if (m.q0 < 0 || (side.at_nodes() && moves_by_nodes(m, work.parts[at(side.part)]))) continue;
      if (m.island < 0)
        alone.push_back(side.part);
      else
        islands.push_back(m.island);
      if (m.island < 0 && moves_by_nodes(m, work.parts[at(side.part)])) by_nodes.push_back(side.part);
    }
  for (std::vector<int>* numbers : {&alone, &islands, &by_nodes}) touched_parts::sort_unique(*numbers);
  dynamics.evaluate_masses(t, state.q, state.v, alone, work);
  for (const int i : by_nodes)
    model.parts()[at(i)].local->compliance(model.parts()[at(i)].joint_points, *work.parts[at(i)].local);
  for (const int i : islands)
    dynamics.factor_joints(t, state.q, state.v, state.joints, model.islands()[at(i)], work);
}

PLIANT_INLINE void apply_velocities(const ContactProblem& problem, const Model& model,
                                    const Workspace<double>& work, State& state) {
  touched_parts::for_each_part(problem.movers().all(), [&](const Mover& mover, int part, int first) {
    const PartModel& m = model.parts()[at(part)];
    scatter_velocity(m, work.parts[at(part)], problem.after(mover).segment(first, m.n_x()), state.v);
  });
}

PLIANT_INLINE void apply_solution(const ContactProblem& problem, const Model& model,
                                  const Workspace<double>& work, State& state) {
  touched_parts::for_each_part(problem.movers().all(), [&](const Mover& mover, int part, int first) {
    const PartModel& m = model.parts()[at(part)];
    if (problem.movers().n_local(part) > 0)
      return touched_parts::displace_locally(problem, {mover, part, first}, m, work.parts[at(part)], state);
    if (mover.node < 0) {
      scatter_velocity(m, work.parts[at(part)], problem.after(mover).segment(first, m.n_x()), state.v);
      return advance_part_in_group(m, work.parts[at(part)], problem.shift(mover).segment(first, m.n_x()), 1,
                                   state.q);
    }
    const Eigen::Quaterniond to_body = model.orientation(state, part).conjugate();
    const Vec3<double> shift = to_body * problem.shift(mover).head<3>(),
                       change = to_body * (problem.after(mover) - problem.before(mover)).head<3>(),
                       omega = state.v.segment<3>(m.v0 + 3);
    touched_parts::add_to_node(model, mover, shift, state.q.segment(m.q0 + 7 + m.n_s, m.n_d()));
    // The velocity of the node, body frame, is R^T c_dot + omega x p + J q_s_dot + d_dot. Only p and d_dot
    // change.
    touched_parts::add_to_node(model, mover, change - omega.cross(shift),
                               state.v.segment(m.v0 + 6 + m.n_s, m.n_d()));
  });
}

}  // namespace pliant
