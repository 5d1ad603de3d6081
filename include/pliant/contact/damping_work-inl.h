// Function bodies of damping_work.h: Simpson's rule for a power that is quadratic in velocities that are
// linear in time,
//   W = h / 6 (P(v_0) + 4 P((v_0 + v_1) / 2) + P(v_1)).
// P(v_0) has equal values with and without impulses, unless a part of the impulses acts at the start.
#pragma once

#include <pliant/contact/damping_work.h>

#include <algorithm>
#include <cmath>

#include <pliant/body/stages/loads.h>
#include <pliant/body/stages/part_stages.h>
#include <pliant/math/header_only.h>
#include <pliant/math/index.h>

namespace pliant {

namespace damping_work {

/// Factors of P in the formula above, without h, in the middle and at the end of a motion. The sum of these
/// two factors and the factor at the start is 1.
struct Weights {
  double middle, end;
  double start() const { return 1 - middle - end; }
};
inline constexpr Weights kLinear{2.0 / 3, 1.0 / 6};

/// Returns the factors for velocities that change in time as exp(-nu t) by a drag nu, 1/s. x: nu h.
inline Weights of_drag(double x) {
  constexpr double small = 1e-3;  // below it the formulas lose digits; the series has an error of x^2 / 100
  if (x < small) return {kLinear.middle, kLinear.end + x / 12};
  const double relaxed = -std::expm1(-x);
  const double m_1 = 1 / relaxed - 1 / x,
               m_2 = (1 - 2 * relaxed / x - std::expm1(-2 * x) / (2 * x)) / (relaxed * relaxed);
  return {4 * (m_1 - m_2), 2 * m_2 - m_1};
}

}  // namespace damping_work

PLIANT_INLINE DampingWork::DampingWork(const Dynamics& dynamics, const Starts& starts, const State& free,
                                       const std::vector<int>& parts, double t, double h)
    : dynamics_(dynamics), starts_(starts), t_(t), h_(h) {
  for (const int i : parts) {
    const PartModel& m = dynamics.model().parts()[at(i)];
    const bool damped = m.n_s > 0 && (m.part->alpha() > 0 || m.part->beta() > 0);
    if (m.local == nullptr && (m.drag > 0 || damped)) damped_.push_back(i);
  }
  find_dampers(parts);
  if (!acts()) return;
  q_ = free.q;
  work_.inputs = free.inputs;
  work_.parts.resize(dynamics.model().parts().size());
  without_impulses_ = works(starts_.free, free.v);
}

/// Finds the dampers at parts that impulses move, and the parts that their evaluation needs.
PLIANT_INLINE void DampingWork::find_dampers(const std::vector<int>& moved) {
  const Model& model = dynamics_.model();
  const auto is_moved = [&](int part) { return std::binary_search(moved.begin(), moved.end(), part); };
  const auto is_zero = [](const StateFunction& damping) {
    return damping.is_constant() && damping.constant() == 0;
  };
  for (const SpringModel& s : model.springs()) {
    if (is_zero(s.spring->damping) || !(is_moved(s.a.part) || is_moved(s.b.part))) continue;
    springs_.push_back(&s);
    at_dampers_.insert(at_dampers_.end(), {s.a.part, s.b.part});
    for (const FunctionModel& function : s.functions) model.append_parts(function, at_dampers_);
  }
  for (const DriveModel& m : model.drives()) {
    if (is_zero(m.drive->damping) || !detail::stores_energy(model, m)) continue;
    std::vector<int> parts;
    model.append_parts(m.on, parts);
    if (std::none_of(parts.begin(), parts.end(), is_moved)) continue;
    drives_.push_back(&m);
    at_dampers_.insert(at_dampers_.end(), parts.begin(), parts.end());
  }
  std::sort(at_dampers_.begin(), at_dampers_.end());
  at_dampers_.erase(std::unique(at_dampers_.begin(), at_dampers_.end()), at_dampers_.end());
  at_dampers_.erase(std::remove(at_dampers_.begin(), at_dampers_.end(), -1), at_dampers_.end());
}

/// Returns the works of the formula above, at the positions at the end of the motion without impulses. The
/// terms of v_0 are left out if no part of the impulses acts at the start.
PLIANT_INLINE DampingWork::Works DampingWork::works(const VecX<double>& v_start, const VecX<double>& v_end) {
  enum Instant { start, middle, end };
  const Model& model = dynamics_.model();
  Works sum = Works::Zero();
  for (const Instant instant : {start, middle, end}) {
    if (instant == start && starts_.corrected == nullptr) continue;
    const VecX<double> v = instant == start    ? v_start
                           : instant == middle ? VecX<double>(0.5 * (v_start + v_end))
                                               : v_end;
    const auto factor = [&](const damping_work::Weights& weights) {
      return h_ * (instant == start ? weights.start() : instant == middle ? weights.middle : weights.end);
    };
    const Evaluation<double> e{dynamics_, t_, q_, v, work_};
    for (const int i : damped_) {
      const PartModel& m = model.parts()[at(i)];
      PartWorkspace<double>& w = work_.parts[at(i)];
      dynamics_.evaluate_frame(t_, q_, v, i, work_);
      w.power.setZero();
      detail::evaluate_own_forces(m, e.gravity, t_, w, nullptr);
      sum[0] += factor(damping_work::kLinear) * w.power[static_cast<int>(Work::damping)];
      sum[1] += factor(damping_work::of_drag(m.drag * h_)) * w.power[static_cast<int>(Work::drag)];
    }
    if (at_dampers_.empty()) continue;
    for (const int i : at_dampers_)
      detail::evaluate_positions<double>(model.parts()[at(i)], t_, q_, v, work_.parts[at(i)]);
    detail::forget_coordinates(e);
    for (const SpringModel* spring : springs_)
      sum[2] += factor(damping_work::kLinear) * detail::damper_power(e, *spring);
    for (const DriveModel* drive : drives_)
      sum[2] += factor(damping_work::kLinear) * detail::damper_power(e, *drive);
  }
  return sum;
}

PLIANT_INLINE void DampingWork::correct(State& after) {
  if (!acts()) return;
  const VecX<double>& v_start = starts_.corrected == nullptr ? starts_.free : *starts_.corrected;
  const Works change = works(v_start, after.v) - without_impulses_;
  after.work[static_cast<int>(Work::damping)] += change[0];
  after.work[static_cast<int>(Work::drag)] += change[1];
  after.work[static_cast<int>(Work::spring_damping)] += change[2];
}

}  // namespace pliant
