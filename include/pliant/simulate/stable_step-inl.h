// Function bodies of stable_step.h: M, K and D of each group of parts that springs connect, and the largest
// step for which the growth of the method is at most 1. The growth is the largest factor by which one step
// multiplies a solution of M x_ddot + D x_dot + K x = 0.
#pragma once

#include <pliant/simulate/stable_step.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/Cholesky>

#include <pliant/math/eigenvalues.h>
#include <pliant/math/header_only.h>
#include <pliant/method/free_oscillation.h>
#include <pliant/simulate/fastest_sway.h>

namespace pliant {

namespace stability {

/// If a group of parts has more velocities than this, each part limits the step separately.
inline constexpr int kMaxGroupVelocities = 120;
/// Largest rotation of a part in a step, rad.
inline constexpr double kMaxRotation = 0.5;
/// Largest change of phase of a mode in a step, rad. In longer steps, impacts add energy, because they act on
/// a mode as on a free body.
inline constexpr double kMaxPhase = 1;

/// Returns L of Eq. (9) at a port, an attachment point of a part: the velocity of the port in the world frame
/// is L v with v = (R^T c_dot, omega, q_s_dot), m/s. Size: 3 x (6 + n_s), n_s: number of dynamic parameters.
inline MatX<double> port_jacobian(const PartModel& m, const PartWorkspace<double>& w, int port) {
  const PointJet<double>& jet = w.ports[static_cast<std::size_t>(port)];
  MatX<double> L(3, 6 + m.n_s);
  L.leftCols<3>().setIdentity();
  L.middleCols<3>(3) = -skew(jet.p);
  L.rightCols(m.n_s) = jet.J;
  return w.R * L;
}

/// The system M x_ddot + D x_dot + K x = 0.
struct LinearSystem {
  MatX<double> M, K, D;
};

/// Returns the columns of A with the given numbers.
inline MatX<double> columns_of(const MatX<double>& A, const std::vector<Eigen::Index>& which) {
  MatX<double> columns(A.rows(), static_cast<Eigen::Index>(which.size()));
  for (std::size_t i = 0; i < which.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = A.col(which[i]);
  return columns;
}

/// Returns the largest step (s) for which a method keeps the solutions of a linear system bounded: infinite
/// without stiffness and damping, 0 if the system is not finite.
inline double stable_step_of(const Integrator& method, const LinearSystem& system) {
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
  // Motions without stiffness and damping are always stable. Their double root 1 would only reduce the
  // accuracy of the other roots.
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

/// Returns upper bounds of K (1/s^2) and D (1/s) of part i, which deforms locally, in mass-normalised
/// coordinates. They are sums over its local elasticity, its global parameters, its drag and the springs at
/// its ports. implicit: whether the method integrates local elasticity implicitly; then only drag and springs
/// are included. The local elasticity is also omitted if the modes of the part oscillate freely and no spring
/// is attached to the part, because methods then integrate the modes exactly.
inline LocalDeformation::Bound bound_locally(const Model& model, std::size_t i,
                                             const PartWorkspace<double>& w, bool implicit) {
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
      // The factor 2: the other end may move by an equal amount in the opposite direction.
      bound.K += 2 * s.spring->stiffness * mobility;
      bound.D += 2 * s.spring->damping * mobility;
    }
  return bound;
}

/// Returns the text that names the springs and parameters of a group as the cause of a limit.
inline std::string limit_of_group(const Model& model, const std::vector<std::size_t>& group) {
  const std::string name = "'" + model.parts()[group.front()].part->name() + "'";
  if (group.size() == 1) return "the springs and parameters of part " + name;
  return "the springs and parameters of part " + name + " and of " + std::to_string(group.size() - 1) +
         (group.size() == 2 ? " part" : " parts") + " that springs connect to it";
}

inline bool moves(const Model& model, int part) {
  return part >= 0 && model.parts()[static_cast<std::size_t>(part)].q0 >= 0;
}

/// Groups of moving parts that springs connect, and the springs at each part. A part without springs to other
/// moving parts is a group of its own.
struct SpringGroups {
  std::vector<std::vector<std::size_t>> members;     ///< parts of each group; empty entries are unused
  std::vector<std::vector<std::size_t>> springs_at;  ///< springs at each part

  explicit SpringGroups(const Model& model)
      : members(model.parts().size()), springs_at(model.parts().size()) {
    const std::size_t n = model.parts().size();
    std::vector<std::size_t> joined(n);
    std::iota(joined.begin(), joined.end(), std::size_t{0});
    auto root = [&](std::size_t i) {
      while (joined[i] != i) i = joined[i] = joined[joined[i]];
      return i;
    };
    const std::vector<SpringModel>& springs = model.springs();
    for (const SpringModel& s : springs)
      if (moves(model, s.a.part) && moves(model, s.b.part))
        joined[root(static_cast<std::size_t>(s.a.part))] = root(static_cast<std::size_t>(s.b.part));
    for (std::size_t i = 0; i < n; ++i)
      if (model.parts()[i].q0 >= 0) members[root(i)].push_back(i);
    for (std::size_t k = 0; k < springs.size(); ++k)
      for (const int end : {springs[k].a.part, springs[k].b.part})
        if (moves(model, end)) springs_at[static_cast<std::size_t>(end)].push_back(k);
  }
};

/// The search for the smallest of all limits of the step.
class StableStepSearch {
 public:
  explicit StableStepSearch(const Simulation& simulation)
      : simulation_(simulation),
        model_(simulation.model()),
        state_(simulation.state()),
        implicit_(simulation.integrator().local_is_implicit()),
        groups_(model_),
        first_(model_.parts().size(), -1) {
    simulation.dynamics().accelerations(state_.time(), state_.q, state_.v, state_, work_);
  }

  StableStep run() {
    limit_by(scalar_step(std::pow(fastest_sway(simulation_.dynamics(), state_, work_), 2), 0),
             "the oscillation of parts on joints");
    limit_by_stabilization();
    for (std::size_t i = 0; i < model_.parts().size(); ++i)
      if (model_.parts()[i].q0 >= 0) limit_by_part(i);
    for (const std::vector<std::size_t>& group : groups_.members) limit_by_group(group);
    if (sway_is_unknown(model_))
      smallest_.uncounted =
          "the oscillation of parts on joints is not included, because parts deform locally";
    return smallest_;
  }

 private:
  void limit_by(double step, const std::string& limit) {
    if (step < smallest_.step) smallest_ = {step, limit, {}};
  }
  /// Returns the stable step for x_ddot + damping x_dot + stiffness x = 0.
  double scalar_step(double stiffness, double damping) const {
    const auto matrix = [](double x) { return MatX<double>::Constant(1, 1, x); };
    return stable_step_of(simulation_.integrator(), {matrix(1), matrix(stiffness), matrix(damping)});
  }

  /// Limits the step by Baumgarte's terms, which act on open joints, and on closed joints without projection.
  /// Gains that depend on the step length are stable for any step, so that they give no limit.
  void limit_by_stabilization() {
    const JointPolicy& policy = simulation_.dynamics().joint_policy();
    const Stabilization& rule = model_.body().stabilization;
    const bool acts = !rule.follows_step(policy.step_consistent) &&
                      std::any_of(state_.joints.begin(), state_.joints.end(), [&](JointMode mode) {
                        return mode == JointMode::closing || (mode == JointMode::closed && !policy.projected);
                      });
    if (!acts) return;
    const Gains gains = rule.gains(state_.h, policy.step_consistent);
    limit_by(scalar_step(gains.beta * gains.beta, 2 * gains.alpha),
             "the gaps of joints, which Baumgarte's terms close");
  }

  void limit_by_part(std::size_t i) {
    const PartModel& m = model_.parts()[i];
    const double speed = state_.v.segment<3>(m.v0 + 3).norm();
    const std::string name = "part '" + m.part->name() + "'";
    if (speed > 0) limit_by(kMaxRotation / speed, "the rotation of " + name);
    if (m.local == nullptr) return;
    if (const Oscillators* modes = m.local->oscillators();
        modes != nullptr && !implicit_ && model_.body().contact.active)
      limit_by(kMaxPhase / std::sqrt(modes->omega2.maxCoeff()),
               "the modes of " + name + ", which impacts may excite");
    const LocalDeformation::Bound bound = bound_locally(model_, i, work_.parts[i], implicit_);
    limit_by(scalar_step(bound.K, bound.D),
             (implicit_ ? "the springs at " : "the local elasticity of ") + name);
  }

  void limit_by_group(const std::vector<std::size_t>& group) {
    int size = 0;
    for (const std::size_t i : group) size += 6 + model_.parts()[i].n_s;
    if (size == 0) return;
    if (size <= kMaxGroupVelocities) {
      limit_by(stable_step_of(simulation_.integrator(), system_of(group, 1)), limit_of_group(model_, group));
      return;
    }
    // If the other end of a spring moves in the opposite direction, the spring acts on a part with up to
    // twice its stiffness.
    for (const std::size_t i : group)
      limit_by(stable_step_of(simulation_.integrator(), system_of({i}, 2)), limit_of_group(model_, {i}));
  }

  /// Returns the system of some parts and their springs. open_weight: factor of the stiffness and damping of
  /// springs that have one end on a moving part outside these parts.
  LinearSystem system_of(const std::vector<std::size_t>& parts, double open_weight) {
    int size = 0;
    for (const std::size_t i : parts) {
      first_[i] = size;
      size += 6 + model_.parts()[i].n_s;
    }
    LinearSystem system{MatX<double>::Zero(size, size), MatX<double>::Zero(size, size),
                        MatX<double>::Zero(size, size)};
    std::vector<std::size_t> springs;
    for (const std::size_t i : parts) {
      add_part(i, system);
      springs.insert(springs.end(), groups_.springs_at[i].begin(), groups_.springs_at[i].end());
    }
    std::sort(springs.begin(), springs.end());
    springs.erase(std::unique(springs.begin(), springs.end()), springs.end());
    for (const std::size_t k : springs) add_spring(model_.springs()[k], open_weight, system);
    for (const std::size_t i : parts) first_[i] = -1;
    return system;
  }
  void add_part(std::size_t i, LinearSystem& system) const {
    const PartModel& m = model_.parts()[i];
    const Part& part = *m.part;
    const int row = first_[i], n_v = 6 + m.n_s;
    const MatX<double>& M = mass_matrix(work_.parts[i]);
    system.M.block(row, row, n_v, n_v) = M;
    const VecMax<double> q_s = state_.q.segment(m.q0 + 7, m.n_s);
    if (m.local == nullptr || !implicit_) {
      system.K.block(row + 6, row + 6, m.n_s, m.n_s) += part.elastic_stiffness(q_s);
      system.D.block(row + 6, row + 6, m.n_s, m.n_s) +=
          part.alpha() * M.bottomRightCorner(m.n_s, m.n_s) + part.beta() * part.strain_stiffness(q_s);
    }
    system.D.block(row, row, n_v, n_v) += part.drag() * M;
  }
  /// Adds a spring that resists every change of x_b - x_a, the vector between its ends. In every direction
  /// this spring is at least as stiff as the axial spring of the model.
  void add_spring(const SpringModel& s, double open_weight, LinearSystem& system) const {
    const auto is_outside = [&](int part) {
      return moves(model_, part) && first_[static_cast<std::size_t>(part)] < 0;
    };
    const bool closed = !is_outside(s.a.part) && !is_outside(s.b.part);
    MatX<double> L = MatX<double>::Zero(3, system.M.rows());
    for (const auto& [ref, sign] : {std::pair{s.a, -1.0}, std::pair{s.b, 1.0}}) {
      if (!moves(model_, ref.part) || is_outside(ref.part)) continue;
      const auto i = static_cast<std::size_t>(ref.part);
      L.middleCols(first_[i], 6 + model_.parts()[i].n_s) +=
          sign * port_jacobian(model_.parts()[i], work_.parts[i], ref.port);
    }
    const double weight = closed ? 1.0 : open_weight;
    system.K += weight * s.spring->stiffness * L.transpose() * L;
    system.D += weight * s.spring->damping * L.transpose() * L;
  }

  const Simulation& simulation_;
  const Model& model_;
  const State& state_;
  const bool implicit_;  // whether local elasticity is integrated implicitly
  const SpringGroups groups_;
  std::vector<int> first_;  // first row of each part in the system that is being assembled; -1: not included
  Workspace<double> work_;
  StableStep smallest_{std::numeric_limits<double>::infinity(), {}, {}};
};

}  // namespace stability

PLIANT_INLINE double largest_stable_step(const Simulation& simulation) {
  return stable_step(simulation).step;
}

PLIANT_INLINE StableStep stable_step(const Simulation& simulation) {
  return stability::StableStepSearch(simulation).run();
}

}  // namespace pliant
