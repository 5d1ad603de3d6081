// Function bodies of load_work.h: the work of forces and torques during a displacement. Forces and torques
// are evaluated at the end of the displacement.
#pragma once

#include <pliant/contact/load_work.h>

#include <algorithm>

#include <pliant/math/header_only.h>
#include <pliant/math/index.h>
#include <pliant/math/rotation_vector.h>

namespace pliant {

PLIANT_INLINE LoadWork::LoadWork(const Dynamics& dynamics, const State& from) : dynamics_(dynamics) {
  const Model& model = dynamics.model();
  for (const ForceModel& f : model.forces()) loaded_.push_back(f.at.part);
  for (const TorqueModel& m : model.torques()) {
    loaded_.push_back(m.part);
    loaded_.push_back(m.against);
  }
  std::sort(loaded_.begin(), loaded_.end());
  loaded_.erase(std::unique(loaded_.begin(), loaded_.end()), loaded_.end());
  loaded_.erase(std::remove_if(loaded_.begin(), loaded_.end(),
                               [&](int i) { return i < 0 || model.parts()[at(i)].q0 < 0; }),
                loaded_.end());
  evaluate_frames(from);
  for (const ForceModel& f : model.forces())
    x_.push_back(std::binary_search(loaded_.begin(), loaded_.end(), f.at.part)
                     ? work_.parts[at(f.at.part)].port_x[at(f.at.port)]
                     : Vec3<double>::Zero());
  for (const int i : loaded_) R_.push_back(work_.parts[at(i)].R);
}

PLIANT_INLINE void LoadWork::evaluate_frames(const State& state) {
  for (const int i : loaded_) dynamics_.evaluate_frame(state.q, state.v, i, work_);
}

PLIANT_INLINE double LoadWork::work_until(double t, const State& to) {
  if (loaded_.empty()) return 0;
  evaluate_frames(to);
  const Model& model = dynamics_.model();
  double work = 0;
  for (std::size_t k = 0; k < x_.size(); ++k) {
    const ForceModel& f = model.forces()[k];
    if (!std::binary_search(loaded_.begin(), loaded_.end(), f.at.part)) continue;
    const PartWorkspace<double>& w = work_.parts[at(f.at.part)];
    const Vec3<double>&x = w.port_x[at(f.at.port)], &x_dot = w.port_x_dot[at(f.at.port)];
    Vec3<double> force = f.force->custom ? f.force->custom(t, x, x_dot) : f.force->force.value(t);
    if (!f.force->custom && f.force->frame == Frame::body) force = (w.R * force).eval();
    work += force.dot(x - x_[k]);
  }
  auto rotation_of = [&](int part) -> Vec3<double> {
    const auto found = std::lower_bound(loaded_.begin(), loaded_.end(), part);
    if (found == loaded_.end() || *found != part) return Vec3<double>::Zero();
    const Mat3<double>& before = R_[static_cast<std::size_t>(found - loaded_.begin())];
    return rotation_vector<double>(work_.parts[at(part)].R * before.transpose());
  };
  for (const TorqueModel& m : model.torques()) {
    Vec3<double> torque = m.torque->torque.value(t);
    if (m.torque->frame == Frame::body) torque = (work_.parts[at(m.part)].R * torque).eval();
    work += torque.dot(rotation_of(m.part) - rotation_of(m.against));
  }
  return work;
}

}  // namespace pliant
