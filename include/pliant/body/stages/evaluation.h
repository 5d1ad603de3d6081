// One evaluation of the dynamics: its arguments, and which islands and parts its stages leave out. S is
// double, or Dual<1> for a directional derivative.
#pragma once

#include <cstddef>
#include <functional>

#include <pliant/body/dynamics.h>

namespace pliant {

template <class S>
struct Evaluation {
  const Dynamics& dynamics;
  double t;          ///< s
  const VecX<S>& q;  ///< coordinates of all parts
  const VecX<S>& v;  ///< velocities of all parts
  Workspace<S>& work;
  /// Step length, modes of limits and joints, sleeping parts; nullptr for a derivative.
  const State* modes = nullptr;
  /// The evaluation whose modes, pushed limits and taut strings a derivative keeps; nullptr otherwise.
  const Workspace<double>* fixed_modes = nullptr;
  /// Whether the caller needs only v_dot, power and the factors of W_c = C_q M^-1 C_q^T. The stages then skip
  /// sleeping parts (unless loads need their positions) and may use rigid islands.
  bool rates_only = false;
  Vec3<double> gravity = dynamics.model().body().gravity_at(t);  ///< m/s^2, world

  const Model& model() const { return dynamics.model(); }
  const PartModel& part(int i) const { return model().parts()[static_cast<std::size_t>(i)]; }
  PartWorkspace<S>& part_work(int i) const { return work.parts[static_cast<std::size_t>(i)]; }

  /// Returns whether the stages leave out part i because it sleeps. Always false unless only rates are
  /// requested.
  bool skips(int i) const { return rates_only && modes != nullptr && sleeps(*modes, i); }
  /// Returns whether the stages leave out an island because it sleeps. All parts of an island sleep together.
  bool skips(const Island& island) const { return skips(island.parts.front()); }
  /// Returns whether an island is evaluated as a rigid island (constraint/rigid_island.h).
  bool uses_rigid(const Island& island) const { return uses_rigid(island.rigid); }
  /// Returns whether a part is evaluated with its rigid island. Then the general stages evaluate only its
  /// positions for loads, and the loads.
  bool uses_rigid(const PartModel& m) const { return uses_rigid(m.rigid_island); }
  /// Returns whether the parts of an island are evaluated together with its joints: each part before the
  /// first joint on the part, while both are in the cache. This is impossible with loads, which need the
  /// positions of all parts first, and with threads, among which the parts are divided.
  bool with_joints(const Island& island) const {
    return dynamics.pool() == nullptr && !island.loaded && !uses_rigid(island);
  }

  /// Calls act(k) for k = 0 ... n - 1, on the threads of the pool if there is one.
  template <class Act>
  void for_each(std::size_t n, Act&& act) const {
    if (dynamics.pool() != nullptr)
      dynamics.pool()->run(static_cast<int>(n), std::ref(act));
    else
      for (std::size_t k = 0; k < n; ++k) act(static_cast<int>(k));
  }

 private:
  bool uses_rigid(int rigid) const { return rigid >= 0 && work.rigid[static_cast<std::size_t>(rigid)].used; }
};

}  // namespace pliant
