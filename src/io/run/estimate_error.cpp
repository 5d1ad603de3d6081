#include <pliant/io/run/estimate_error.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <pliant/contact/longest_contact_step.h>
#include <pliant/method/error_scale.h>
#include <pliant/simulate/simulation.h>

namespace pliant {

namespace {

constexpr double kTighter = 10;  // tolerance of the run / tolerance of its repetition

/// Replaces a maximum by a larger value or by NaN. A maximum that is NaN stays NaN.
void raise_max(double& max, double value) {
  if (!(value <= max) && !std::isnan(max)) max = value;
}

/// Updates the maxima in `error` with the differences of coordinates and velocities between two states.
void compare(const Model& model, const State& a, const State& b, ErrorEstimate& error) {
  for (const PartModel& m : model.parts()) {
    if (m.q0 < 0) continue;
    const VecX<double> q = a.q - b.q, v = a.v - b.v;
    raise_max(error.place, q.segment<3>(m.q0).norm());
    raise_max(error.rotation, 2 * q.segment<4>(m.q0 + 3).norm());
    raise_max(error.velocity, v.segment<3>(m.v0).norm());
    raise_max(error.angular_velocity, v.segment<3>(m.v0 + 3).norm());
    for (int k = 0; k < m.n_s; ++k) {
      const bool is_length = m.part->parameters().moving(k).spec->quantity == Quantity::length;
      raise_max(is_length ? error.length : error.parameter, std::abs(q[m.q0 + 7 + k]));
    }
    if (m.n_d() > 0)
      raise_max(error.displacement, q.segment(m.q0 + 7 + m.n_s, m.n_d()).lpNorm<Eigen::Infinity>());
  }
}

/// Updates the maxima in `error` with the differences of joint forces between two states, and with the gaps
/// of closed joints. work_a, work_b: results of evaluations at the states.
void compare_joints(const Dynamics& dynamics, const State& a, const Workspace<double>& work_a, const State& b,
                    const Workspace<double>& work_b, ErrorEstimate& error) {
  const Model& model = dynamics.model();
  for (int j = 0; j < static_cast<int>(model.joints().size()); ++j) {
    const auto k = static_cast<std::size_t>(j);
    if (a.joints[k] == JointMode::closed) raise_max(error.gap, model.gap(a, j));
    if (a.joints[k] != b.joints[k]) continue;
    const Wrench one = dynamics.joint_wrench(a.time(), j, work_a),
                 other = dynamics.joint_wrench(b.time(), j, work_b);
    raise_max(error.joint_force, (one.force - other.force).norm());
    raise_max(error.joint_torque, (one.torque - other.torque).norm());
  }
}

/// While the object exists, the longest contact step at `tolerance` is half the longest contact step at the
/// original tolerance.
class HalfStepsInContact {
 public:
  HalfStepsInContact(ContactSettings& settings, double tolerance, double original_tolerance)
      : settings_(settings), longest_(settings.longest_step) {
    const double half = longest_contact_step(settings, original_tolerance) / 2;
    settings_.longest_step = half * longest_ / longest_contact_step(settings, tolerance);
  }
  ~HalfStepsInContact() { settings_.longest_step = longest_; }
  HalfStepsInContact(const HalfStepsInContact&) = delete;
  HalfStepsInContact& operator=(const HalfStepsInContact&) = delete;

 private:
  ContactSettings& settings_;
  double longest_;
};

/// Advances a simulation to a time `until` (s). With fixed steps, all steps have the same length, about
/// `step` (s). With a tolerance, there are at least two steps, because a step equal to the step of the run
/// would show no difference.
void step_to(Simulation& simulation, double until, double step) {
  const double now = simulation.time();
  if (!(until > now)) return;
  if (simulation.tolerance() > 0) {
    for (const double target : {0.5 * (now + until), until})
      while (simulation.time() < target) simulation.step_up_to(target);
    return;
  }
  const double steps = std::max(1.0, std::round((until - now) / step));
  for (double i = 0; i < steps; ++i) simulation.step((until - now) / steps);
}

}  // namespace

void require_better_run(const Scene& scene) {
  if (!(scene.tolerance > 0) || scene.tolerance > kMinTolerance) return;
  std::ostringstream message;
  message << "the error of a run with the tolerance " << scene.tolerance
          << " cannot be estimated, because no run is more accurate; choose a larger tolerance";
  throw std::invalid_argument(message.str());
}

ErrorEstimate estimate_error(Scene& scene, const std::string& integrator, double step, const Recording& run,
                             int threads, Progress& progress) {
  require_better_run(scene);
  ErrorEstimate error;
  error.tolerance = scene.tolerance > 0 ? std::max(kMinTolerance, scene.tolerance / kTighter) : 0;
  error.step = scene.tolerance > 0 ? 0 : step / 2;
  // The tolerance does not control the error of resting contacts of many bodies, so the longest contact step
  // is halved.
  const HalfStepsInContact half(scene.body.contact, error.tolerance, scene.tolerance);
  Simulation simulation(scene.body, integrator, threads, error.tolerance);
  const Dynamics& dynamics = simulation.dynamics();
  Workspace<double> run_work, better_work;
  const double end = run.rows() > 0 ? run.time(run.rows() - 1) : 0;
  progress.begin("estimate error", end, "s");
  for (std::int64_t row = 0; row < run.rows(); ++row) {
    const State recorded = run.state(row);
    step_to(simulation, recorded.time(), error.step);
    const State& better = simulation.state();
    compare(simulation.model(), recorded, better, error);
    raise_max(error.energy, std::abs(dynamics.ledger(recorded, run_work).energy() -
                                     dynamics.ledger(better, better_work).energy()));
    compare_joints(dynamics, recorded, run_work, better, better_work, error);
    progress.advance(recorded.time());
  }
  progress.end();
  return error;
}

}  // namespace pliant
