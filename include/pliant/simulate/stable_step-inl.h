// The largest stable step: M, K and D of each group of parts tied by springs, in mass-normalised coordinates,
// and the step at which the method's growth passes 1.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/Cholesky>

#include <pliant/math/header_only.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/method/free_oscillation.h>
#include <pliant/simulate/stable_step.h>

#include <pliant/simulate/fastest_sway.h>

namespace pliant {

namespace stable_step {

/// Parts of a group with more velocities are bounded one by one.
inline constexpr int kLargestGroup = 120;
/// Largest rotation in a step that a method follows, rad.
inline constexpr double kMostTurnInStep = 0.5;
/// Largest phase of a mode in a step, rad. Beyond it impacts move the mode like a free body and add energy.
inline constexpr double kMostPhase = 1;

/// L of a port on v_r of its part: 3 x n_v, world.
inline MatX<double> port_jacobian(const PartModel& m, const PartWorkspace<double>& w, int port) {
  const PointJet<double>& jet = w.ports[static_cast<std::size_t>(port)];
  MatX<double> L(3, 6 + m.n_s);
  L.leftCols<3>().setIdentity();
  L.middleCols<3>(3) = -skew(jet.p);
  L.rightCols(m.n_s) = jet.J;
  return w.R * L;
}

struct Linear {
  MatX<double> M, K, D;
};

inline MatX<double> columns_of(const MatX<double>& A, const std::vector<Eigen::Index>& which) {
  MatX<double> kept(A.rows(), static_cast<Eigen::Index>(which.size()));
  for (std::size_t i = 0; i < which.size(); ++i) kept.col(static_cast<Eigen::Index>(i)) = A.col(which[i]);
  return kept;
}

inline double stable_step_of(const Integrator& method, const Linear& system) {
  // Coordinates without inertia are fixed: remove them.
  std::vector<Eigen::Index> kept;
  for (Eigen::Index i = 0; i < system.M.rows(); ++i)
    if (system.M(i, i) > 0) kept.push_back(i);
  const MatX<double> M = system.M(kept, kept), K = system.K(kept, kept), D = system.D(kept, kept);
  const VecX<double> scale = M.diagonal().cwiseSqrt().cwiseInverse();
  const MatX<double> scaled = scale.asDiagonal() * M * scale.asDiagonal();
  const auto [values, vectors] = symmetric_eigenpairs(scaled);
  std::vector<Eigen::Index> solid;
  for (Eigen::Index i = 0; i < values.size(); ++i)
    if (values[i] > 1e-10) solid.push_back(i);
  MatX<double> T =
      scale.asDiagonal() * vectors * values.cwiseMax(1e-300).cwiseSqrt().cwiseInverse().asDiagonal();
  const MatX<double> all = columns_of(T, solid);
  // Free motions are stable by themselves. Their double root 1 would only reduce the accuracy of the other
  // roots.
  const MatX<double> resistance = all.transpose() * (K + D) * all;
  const Eigenpairs resisted = symmetric_eigenpairs(resistance);
  std::vector<Eigen::Index> stiff_modes;
  for (Eigen::Index i = 0; i < resistance.rows(); ++i)
    if (resisted.values[i] > 1e-12 * resisted.values.cwiseAbs().maxCoeff()) stiff_modes.push_back(i);
  const MatX<double> basis = all * columns_of(resisted.vectors, stiff_modes);
  const MatX<double> k = basis.transpose() * K * basis, d = basis.transpose() * D * basis;
  const double stiff = k.norm(), damped = d.norm();
  if (!(stiff > 0) && !(damped > 0)) return std::numeric_limits<double>::infinity();
  if (!std::isfinite(stiff + damped)) return 0;
  // Bisection between a stable and an unstable step.
  double low = 0.05 / std::max(std::sqrt(stiff), damped), high = low;
  const double slack = 1 + 1e-9;
  while (method.growth(k, d, high) <= slack && high < 1e12) high *= 2;
  while (method.growth(k, d, low) > slack && low > 1e-30) low /= 2;
  for (int i = 0; i < 40 && high - low > 1e-6 * high; ++i) {
    const double middle = 0.5 * (low + high);
    (method.growth(k, d, middle) <= slack ? low : high) = middle;
  }
  return low;
}

/// Bounds of K and D of a part that deforms locally, in mass-normalised coordinates: the sum of those of
/// elasticity, of the global parameters and of springs at its points. implicit: springs alone count.
inline LocalDeformation::Bound bound_locally(const Model& model, std::size_t i, const PartWorkspace<double>& w,
                                      bool implicit) {
  const PartModel& m = model.parts()[i];
  const Part& part = *m.part;
  LocalDeformation::Bound bound;
  const bool pulled = std::any_of(model.springs().begin(), model.springs().end(), [&](const SpringModel& s) {
    return s.a.part == static_cast<int>(i) || s.b.part == static_cast<int>(i);
  });
  if (!implicit && (!oscillates_freely(m) || pulled)) {
    bound = m.local->stiffness_bound(*w.local);
    bound.D += m.local->alpha();
  }
  bound.D += m.drag;
  if (m.n_s > 0 && !implicit) {
    const MatX<double> compliance = w.local->A.block(6, 6, m.n_s, m.n_s);
    const double omega2 = spectral_radius(compliance * part.K_s());
    bound.K += omega2;
    bound.D += part.alpha() + part.beta() * omega2;
  }
  for (const SpringModel& s : model.springs())
    for (const PortRef& ref : {s.a, s.b}) {
      if (ref.part != static_cast<int>(i)) continue;
      const double mobility = m.local->mobility(m.node_weights[static_cast<std::size_t>(ref.port)]);
      // The other end may move as much.
      bound.K += 2 * s.spring->stiffness * mobility;
      bound.D += 2 * s.spring->damping * mobility;
    }
  return bound;
}

/// Returns "the parameters of part 'a'", with "and 2 parts tied to it" if springs connect it.
inline std::string limit_of_group(const Model& model, const std::vector<std::size_t>& group) {
  const std::string name = "'" + model.parts()[group.front()].part->name() + "'";
  if (group.size() == 1) return "the springs and parameters of part " + name;
  return "the springs and parameters of part " + name + " and of " + std::to_string(group.size() - 1) +
         " tied to it";
}

}  // namespace stable_step

PLIANT_INLINE double largest_stable_step(const Simulation& simulation) {
  return stable_step(simulation).step;
}

PLIANT_INLINE StableStep stable_step(const Simulation& simulation) {
  const Model& model = simulation.model();
  const State& state = simulation.state();
  Workspace<double> work;
  simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
  const std::size_t n = model.parts().size();
  const bool implicit = simulation.integrator().local_is_implicit();

  // Groups of parts that springs connect.
  std::vector<std::size_t> joined(n);
  std::iota(joined.begin(), joined.end(), std::size_t{0});
  auto root = [&](std::size_t i) {
    while (joined[i] != i) i = joined[i] = joined[joined[i]];
    return i;
  };
  auto moves = [&](int part) { return part >= 0 && model.parts()[static_cast<std::size_t>(part)].q0 >= 0; };
  for (const SpringModel& s : model.springs())
    if (moves(s.a.part) && moves(s.b.part))
      joined[root(static_cast<std::size_t>(s.a.part))] = root(static_cast<std::size_t>(s.b.part));

  // Members of each group, and the springs at each of their parts.
  std::vector<std::vector<std::size_t>> members(n), springs_at(n);
  for (std::size_t i = 0; i < n; ++i)
    if (model.parts()[i].q0 >= 0) members[root(i)].push_back(i);
  const std::vector<SpringModel>& springs = model.springs();
  for (std::size_t k = 0; k < springs.size(); ++k)
    for (const int end : {springs[k].a.part, springs[k].b.part})
      if (moves(end)) springs_at[static_cast<std::size_t>(end)].push_back(k);

  std::vector<int> first(n, -1);  // first row of each part in its system
  /// Assembles the system of some parts and their springs. weight: of springs with one end outside.
  auto system_of = [&](const std::vector<std::size_t>& parts, double open_weight) {
    int size = 0;
    for (const std::size_t i : parts) {
      first[i] = size;
      size += 6 + model.parts()[i].n_s;
    }
    stable_step::Linear system{MatX<double>::Zero(size, size), MatX<double>::Zero(size, size),
                  MatX<double>::Zero(size, size)};
    std::vector<std::size_t> ours;
    for (const std::size_t i : parts) {
      const PartModel& m = model.parts()[i];
      const Part& part = *m.part;
      const int at = first[i], n_v = 6 + m.n_s;
      const MatX<double>& M = mass_matrix(work.parts[i]);
      system.M.block(at, at, n_v, n_v) = M;
      const VecMax<double> q_s = state.q.segment(m.q0 + 7, m.n_s);
      if (m.local == nullptr || !implicit) {
        system.K.block(at + 6, at + 6, m.n_s, m.n_s) += part.elastic_stiffness(q_s);
        system.D.block(at + 6, at + 6, m.n_s, m.n_s) +=
            part.alpha() * M.bottomRightCorner(m.n_s, m.n_s) + part.beta() * part.strain_stiffness(q_s);
      }
      system.D.block(at, at, n_v, n_v) += part.drag() * M;
      ours.insert(ours.end(), springs_at[i].begin(), springs_at[i].end());
    }
    std::sort(ours.begin(), ours.end());
    ours.erase(std::unique(ours.begin(), ours.end()), ours.end());
    for (const std::size_t k : ours) {
      // d = x_b - x_a; an axial spring is bounded by the isotropic one of its stiffness.
      const SpringModel& s = springs[k];
      const bool closed = (!moves(s.a.part) || first[static_cast<std::size_t>(s.a.part)] >= 0) &&
                          (!moves(s.b.part) || first[static_cast<std::size_t>(s.b.part)] >= 0);
      MatX<double> L = MatX<double>::Zero(3, size);
      for (const auto& [ref, sign] : {std::pair{s.a, -1.0}, std::pair{s.b, 1.0}}) {
        if (!moves(ref.part) || first[static_cast<std::size_t>(ref.part)] < 0) continue;
        const auto i = static_cast<std::size_t>(ref.part);
        L.middleCols(first[i], 6 + model.parts()[i].n_s) +=
            sign * stable_step::port_jacobian(model.parts()[i], work.parts[i], ref.port);
      }
      const double weight = closed ? 1.0 : open_weight;
      system.K += weight * s.spring->stiffness * L.transpose() * L;
      system.D += weight * s.spring->damping * L.transpose() * L;
    }
    for (const std::size_t i : parts) first[i] = -1;
    return system;
  };

  StableStep smallest{std::numeric_limits<double>::infinity(), {}, {}};
  auto take = [&](double step, const std::string& limit) {
    if (step < smallest.step) smallest = {step, limit, {}};
  };
  /// x_ddot = -stiffness x - damping x_dot.
  auto one = [&](double stiffness, double damping) {
    const auto number = [](double x) { return MatX<double>::Constant(1, 1, x); };
    return stable_step::stable_step_of(simulation.integrator(), {number(1), number(stiffness), number(damping)});
  };
  take(one(std::pow(fastest_sway(simulation.dynamics(), state, work), 2), 0), "what sways on joints");
  const JointPolicy& policy = simulation.dynamics().joint_policy();
  const Stabilization& rule = model.body().stabilization;
  const bool by_gains =
      !rule.follows_step(policy.step_consistent) &&
      std::any_of(state.joints.begin(), state.joints.end(), [&](JointMode mode) {
        return mode == JointMode::closing || (mode == JointMode::closed && !policy.projected);
      });
  if (by_gains) {
    const Gains gains = rule.gains(state.h, policy.step_consistent);
    take(one(gains.beta * gains.beta, 2 * gains.alpha), "the gaps of joints, which Baumgarte's terms close");
  }
  for (std::size_t i = 0; i < n; ++i) {
    const PartModel& m = model.parts()[i];
    if (m.q0 < 0) continue;
    const double turning = state.v.segment<3>(m.v0 + 3).norm();
    const std::string name = "part '" + m.part->name() + "'";
    if (turning > 0) take(stable_step::kMostTurnInStep / turning, "the spin of " + name);
    if (m.local == nullptr) continue;
    if (const Oscillators* modes = m.local->oscillators();
        modes != nullptr && !implicit && model.body().contact.active)
      take(stable_step::kMostPhase / std::sqrt(modes->omega2.maxCoeff()),
           "the modes of " + name + ", which may be struck");
    const LocalDeformation::Bound bound = stable_step::bound_locally(model, i, work.parts[i], implicit);
    take(one(bound.K, bound.D), (implicit ? "the springs at " : "the local elasticity of ") + name);
  }
  for (const std::vector<std::size_t>& group : members) {
    int size = 0;
    for (const std::size_t i : group) size += 6 + model.parts()[i].n_s;
    if (size == 0) continue;
    if (size <= stable_step::kLargestGroup) {
      take(stable_step::stable_step_of(simulation.integrator(), system_of(group, 1)), stable_step::limit_of_group(model, group));
      continue;
    }
    // For one part, a spring acts with up to twice its stiffness.
    for (const std::size_t i : group)
      take(stable_step::stable_step_of(simulation.integrator(), system_of({i}, 2)), stable_step::limit_of_group(model, {i}));
  }
  if (sway_is_unknown(model))
    smallest.uncounted = "what sways on joints is not counted, since parts deform locally";
  return smallest;
}

}  // namespace pliant
