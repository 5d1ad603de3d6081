// The largest stable step: M, K and D of each group of parts tied by springs, in mass-normalised coordinates,
// and the step at which the method's growth passes 1.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include <Eigen/Cholesky>

#include <pliant/math/eigenvalues.h>
#include <pliant/method/free_oscillation.h>
#include <pliant/simulate/stable_step.h>

#include "fastest_sway.h"

namespace pliant {

namespace {

/// Parts of a group with more velocities are bounded one by one.
constexpr int kLargestGroup = 120;
/// Largest rotation in a step that a method follows, rad.
constexpr double kMaxTurn = 0.5;
/// Largest phase of a mode in a step, rad. Beyond it impacts move the mode like a free body and add energy.
constexpr double kMaxPhase = 1;

/// L of a port on v_r of its part: 3 x n_v, world.
MatX<double> port_jacobian(const PartModel& m, const PartWorkspace<double>& w, int port) {
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

MatX<double> columns_of(const MatX<double>& A, const std::vector<Eigen::Index>& which) {
  MatX<double> kept(A.rows(), static_cast<Eigen::Index>(which.size()));
  for (std::size_t i = 0; i < which.size(); ++i) kept.col(static_cast<Eigen::Index>(i)) = A.col(which[i]);
  return kept;
}

double stable_step_of(const Integrator& method, const Linear& system) {
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
LocalDeformation::Bound bound_locally(const Model& model, std::size_t i, const PartWorkspace<double>& w,
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
std::string limit_of_group(const Model& model, const std::vector<std::size_t>& group) {
  const std::string name = "'" + model.parts()[group.front()].part->name() + "'";
  if (group.size() == 1) return "the springs and parameters of part " + name;
  return "the springs and parameters of part " + name + " and of " + std::to_string(group.size() - 1) +
         " tied to it";
}

/// Groups of parts that springs connect, and their linear systems M x_ddot + D x_dot + K x = 0.
class SpringGroups {
 public:
  SpringGroups(const Model& model, const State& state, const Workspace<double>& work, bool implicit)
      : model_(model),
        state_(state),
        work_(work),
        implicit_(implicit),
        members_(model.parts().size()),
        springs_at_(model.parts().size()),
        first_(model.parts().size(), -1) {
    const std::size_t n = model.parts().size();
    std::vector<std::size_t> joined(n);
    std::iota(joined.begin(), joined.end(), std::size_t{0});
    auto root = [&](std::size_t i) {
      while (joined[i] != i) i = joined[i] = joined[joined[i]];
      return i;
    };
    for (const SpringModel& s : model.springs())
      if (moves(s.a.part) && moves(s.b.part))
        joined[root(static_cast<std::size_t>(s.a.part))] = root(static_cast<std::size_t>(s.b.part));
    for (std::size_t i = 0; i < n; ++i)
      if (model.parts()[i].q0 >= 0) members_[root(i)].push_back(i);
    const std::vector<SpringModel>& springs = model.springs();
    for (std::size_t k = 0; k < springs.size(); ++k)
      for (const int end : {springs[k].a.part, springs[k].b.part})
        if (moves(end)) springs_at_[static_cast<std::size_t>(end)].push_back(k);
  }

  /// Parts of each group; empty for the parts that are in the group of another one.
  const std::vector<std::vector<std::size_t>>& members() const { return members_; }
  /// Returns the number of velocities of some parts, without local ones.
  int size_of(const std::vector<std::size_t>& parts) const {
    int size = 0;
    for (const std::size_t i : parts) size += 6 + model_.parts()[i].n_s;
    return size;
  }
  /// Assembles the system of some parts and their springs. open_weight: weight of springs with one end
  /// outside.
  Linear system_of(const std::vector<std::size_t>& parts, double open_weight) {
    const int size = size_of(parts);
    Linear system{MatX<double>::Zero(size, size), MatX<double>::Zero(size, size),
                  MatX<double>::Zero(size, size)};
    std::vector<std::size_t> ours;
    int next = 0;
    for (const std::size_t i : parts) {
      first_[i] = next;
      next += 6 + model_.parts()[i].n_s;
    }
    for (const std::size_t i : parts) {
      add_part(i, system);
      ours.insert(ours.end(), springs_at_[i].begin(), springs_at_[i].end());
    }
    std::sort(ours.begin(), ours.end());
    ours.erase(std::unique(ours.begin(), ours.end()), ours.end());
    for (const std::size_t k : ours) add_spring(model_.springs()[k], open_weight, system);
    for (const std::size_t i : parts) first_[i] = -1;
    return system;
  }

 private:
  bool moves(int part) const { return part >= 0 && model_.parts()[static_cast<std::size_t>(part)].q0 >= 0; }
  bool is_outside(int part) const { return moves(part) && first_[static_cast<std::size_t>(part)] < 0; }

  void add_part(std::size_t i, Linear& system) const {
    const PartModel& m = model_.parts()[i];
    const Part& part = *m.part;
    const int at = first_[i], n_v = 6 + m.n_s;
    const MatX<double>& M = mass_matrix(work_.parts[i]);
    system.M.block(at, at, n_v, n_v) = M;
    const VecMax<double> q_s = state_.q.segment(m.q0 + 7, m.n_s);
    if (m.local == nullptr || !implicit_) {
      system.K.block(at + 6, at + 6, m.n_s, m.n_s) += part.elastic_stiffness(q_s);
      system.D.block(at + 6, at + 6, m.n_s, m.n_s) +=
          part.alpha() * M.bottomRightCorner(m.n_s, m.n_s) + part.beta() * part.strain_stiffness(q_s);
    }
    system.D.block(at, at, n_v, n_v) += part.drag() * M;
  }

  /// d = x_b - x_a; an axial spring is bounded by the isotropic spring of its stiffness.
  void add_spring(const SpringModel& s, double open_weight, Linear& system) const {
    MatX<double> L = MatX<double>::Zero(3, system.M.cols());
    for (const auto& [ref, sign] : {std::pair{s.a, -1.0}, std::pair{s.b, 1.0}}) {
      if (!moves(ref.part) || is_outside(ref.part)) continue;
      const auto i = static_cast<std::size_t>(ref.part);
      L.middleCols(first_[i], 6 + model_.parts()[i].n_s) +=
          sign * port_jacobian(model_.parts()[i], work_.parts[i], ref.port);
    }
    const double weight = is_outside(s.a.part) || is_outside(s.b.part) ? open_weight : 1.0;
    system.K += weight * s.spring->stiffness * L.transpose() * L;
    system.D += weight * s.spring->damping * L.transpose() * L;
  }

  const Model& model_;
  const State& state_;
  const Workspace<double>& work_;
  bool implicit_;
  std::vector<std::vector<std::size_t>> members_, springs_at_;
  std::vector<int> first_;  // first row of each part in the system that is being assembled; -1: not in it
};

/// The bounds of the step of a simulation; the smallest counts.
class StepBounds {
 public:
  explicit StepBounds(const Simulation& simulation)
      : simulation_(simulation),
        model_(simulation.model()),
        state_(simulation.state()),
        implicit_(simulation.integrator().local_is_implicit()) {
    simulation.dynamics().accelerations(state_.time(), state_.q, state_.v, state_, work_);
  }

  StableStep smallest() {
    bound_joints();
    for (std::size_t i = 0; i < model_.parts().size(); ++i)
      if (model_.parts()[i].q0 >= 0) bound_part(i);
    bound_groups();
    if (sway_is_unknown(model_))
      smallest_.uncounted = "the sway of joints is not counted, because parts deform locally";
    return smallest_;
  }

 private:
  void add(double step, const std::string& limit) {
    if (step < smallest_.step) smallest_ = {step, limit, {}};
  }
  /// Returns the stable step of x_ddot = -stiffness x - damping x_dot.
  double step_of(double stiffness, double damping) const {
    const auto number = [](double x) { return MatX<double>::Constant(1, 1, x); };
    return stable_step_of(simulation_.integrator(), {number(1), number(stiffness), number(damping)});
  }

  void bound_joints() {
    const double sway = fastest_sway(simulation_.dynamics(), state_, work_);
    add(step_of(std::pow(sway, 2), 0), "the sway of parts on joints");
    const JointPolicy& policy = simulation_.dynamics().joint_policy();
    const Stabilization& rule = model_.body().stabilization;
    const bool by_gains =
        !rule.follows_step(policy.step_consistent) &&
        std::any_of(state_.joints.begin(), state_.joints.end(), [&](JointMode mode) {
          return mode == JointMode::closing || (mode == JointMode::closed && !policy.projected);
        });
    if (!by_gains) return;
    const Gains gains = rule.gains(state_.h, policy.step_consistent);
    add(step_of(gains.beta * gains.beta, 2 * gains.alpha),
        "the gaps of joints, which Baumgarte's terms close");
  }

  void bound_part(std::size_t i) {
    const PartModel& m = model_.parts()[i];
    const double turning = state_.v.segment<3>(m.v0 + 3).norm();
    const std::string name = "part '" + m.part->name() + "'";
    if (turning > 0) add(kMaxTurn / turning, "the spin of " + name);
    if (m.local == nullptr) return;
    if (const Oscillators* modes = m.local->oscillators();
        modes != nullptr && !implicit_ && model_.body().contact.active)
      add(kMaxPhase / std::sqrt(modes->omega2.maxCoeff()),
          "the modes of " + name + ", which contacts may hit");
    const LocalDeformation::Bound bound = bound_locally(model_, i, work_.parts[i], implicit_);
    add(step_of(bound.K, bound.D), (implicit_ ? "the springs at " : "the local elasticity of ") + name);
  }

  void bound_groups() {
    SpringGroups groups(model_, state_, work_, implicit_);
    const Integrator& method = simulation_.integrator();
    for (const std::vector<std::size_t>& group : groups.members()) {
      const int size = groups.size_of(group);
      if (size == 0) continue;
      if (size <= kLargestGroup) {
        add(stable_step_of(method, groups.system_of(group, 1)), limit_of_group(model_, group));
        continue;
      }
      // For one part, a spring acts with up to twice its stiffness.
      for (const std::size_t i : group)
        add(stable_step_of(method, groups.system_of({i}, 2)), limit_of_group(model_, {i}));
    }
  }

  const Simulation& simulation_;
  const Model& model_;
  const State& state_;
  bool implicit_;
  Workspace<double> work_;
  StableStep smallest_{std::numeric_limits<double>::infinity(), {}, {}};
};

}  // namespace

double largest_stable_step(const Simulation& simulation) {
  return stable_step(simulation).step;
}

StableStep stable_step(const Simulation& simulation) {
  return StepBounds(simulation).smallest();
}

}  // namespace pliant
