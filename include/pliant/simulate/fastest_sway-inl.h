// Function bodies of fastest_sway.h: the largest eigenvalue of the map x -> -(da/dq) x, where a(q) are the
// accelerations and x are velocities that the joints allow.
#pragma once

#include <pliant/simulate/fastest_sway.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <pliant/body/advance.h>
#include <pliant/body/constraint/group.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/math/header_only.h>

namespace pliant {

namespace sway {

/// Largest number of vectors of Lanczos' method.
inline constexpr std::size_t kMaxVectors = 30;
/// The iteration ends if the norm of the next vector is below this share of the largest norm of an image of
/// the map, because this vector then consists of rounding errors.
inline constexpr double kVanished = 1e-9;

/// The map x -> -(da/dq) x on the velocities x that the joints allow; a are the accelerations. For parts at
/// rest the map is symmetric in the mass metric. A positive eigenvalue is omega^2 of an oscillation; a
/// negative eigenvalue belongs to an unstable motion.
class Sway {
 public:
  Sway(const Dynamics& dynamics, const State& state, Workspace<double>& work)
      : dynamics_(dynamics),
        model_(dynamics.model()),
        state_(state),
        work_(work),
        along_{VecX<double>(), VecX<double>::Zero(state.v.size())} {}

  /// Returns the largest eigenvalue, by Lanczos' method with full orthogonalisation; 0 if the joints allow no
  /// motion.
  double largest() {
    VecX<double> x(state_.v.size());
    for (Eigen::Index i = 0; i < x.size(); ++i) x[i] = std::sin(1.0 + static_cast<double>(i));
    project_onto_joints(x);
    MatX<double> H = MatX<double>::Zero(kMaxVectors, kMaxVectors);
    std::vector<VecX<double>> basis;
    double size = std::sqrt(product(x, x)), scale = 0;
    while (basis.size() < kMaxVectors && size > kVanished * scale) {
      const auto k = static_cast<Eigen::Index>(basis.size());
      basis.push_back(x / size);
      x = -derivative(basis.back());
      project_onto_joints(x);
      scale = std::max(scale, std::sqrt(product(x, x)));
      for (const bool again : {false, true})
        for (Eigen::Index i = 0; i <= k; ++i) {
          const VecX<double>& v = basis[static_cast<std::size_t>(i)];
          const double share = product(v, x);
          x -= share * v;
          if (!again) H(i, k) = H(k, i) = share;
        }
      size = std::sqrt(product(x, x));
    }
    const auto n = static_cast<Eigen::Index>(basis.size());
    if (n == 0) return 0;
    return symmetric_eigenvalues(H.topLeftCorner(n, n)).maxCoeff();
  }

 private:
  VecX<double> derivative(const VecX<double>& x) {
    dynamics_.coordinate_rates(state_.q, x, along_.q);
    return dynamics_.jvp(state_.time(), state_.q, state_.v, along_, work_, dual_work_);
  }

  /// Projects changes x of the velocities of all parts so that C_q x = 0. Sets the changes of parts without
  /// joints to zero.
  void project_onto_joints(VecX<double>& all) {
    VecX<double> allowed = VecX<double>::Zero(all.size()), x, rows;
    for (const Island& island : model_.islands()) {
      const Group<double, Eigen::Dynamic> group(model_, work_, island, false);
      group.gather(x, [&](int i) {
        return body_velocity(group.workspace(i), part_velocities(group.model(i), std::as_const(all)));
      });
      group.joint_rows(x, rows);
      group.correct(rows, x);
      for (int i = 0; i < group.parts(); ++i)
        part_velocities(group.model(i), allowed) = world_velocity(group.workspace(i), group.share(x, i));
    }
    all = allowed;
  }

  /// Returns the inner product in the mass metric.
  double product(const VecX<double>& x, const VecX<double>& y) const {
    double sum = 0;
    for (const Island& island : model_.islands())
      for (const int i : island.parts) {
        const PartModel& m = model_.parts()[static_cast<std::size_t>(i)];
        const PartWorkspace<double>& w = work_.parts[static_cast<std::size_t>(i)];
        const VecMax<double> a = body_velocity(w, part_velocities(m, x)),
                             b = body_velocity(w, part_velocities(m, y));
        sum += a.dot(w.inertia.M * b);
      }
    return sum;
  }

  const Dynamics& dynamics_;
  const Model& model_;
  const State& state_;
  Workspace<double>& work_;
  Workspace<Dual<1>> dual_work_;
  StateDirection along_;
};

}  // namespace sway

PLIANT_INLINE bool sway_is_unknown(const Model& model) {
  return !model.islands().empty() && std::any_of(model.parts().begin(), model.parts().end(),
                                                 [](const PartModel& m) { return m.local != nullptr; });
}

PLIANT_INLINE double fastest_sway(const Dynamics& dynamics, const State& state, Workspace<double>& work) {
  const Model& model = dynamics.model();
  if (model.islands().empty() || sway_is_unknown(model)) return 0;
  const double value = sway::Sway(dynamics, state, work).largest();
  return value > 0 ? std::sqrt(value) : 0;
}

}  // namespace pliant
