#include <pliant/io/recorded_step.h>

#include <algorithm>

#include <pliant/body/dynamics.h>

namespace pliant {
namespace {

/// An impact is assumed at the end of a step if the rates jump there by more than this fraction of their
/// change due to the accelerations.
constexpr double kJump = 0.5;
/// Other forces, such as contact, are assumed within a step if two predictions fail. The first prediction is
/// the displacement, from the rate and the acceleration at the start. The second is the rate at the end, from
/// the mean of the accelerations at both ends. A prediction fails if its error (times 2 / h for the
/// displacement) is more than this fraction of the change of the rates due to the accelerations.
constexpr double kPushed = 0.2;
/// Relative rounding error of rates.
constexpr double kRounding = 1e-9;

/// The rates and the second derivatives of all coordinates q.
struct CoordinateMotion {
  VecX<double> rate, curvature;
};

CoordinateMotion motion_at(const Dynamics& dynamics, const State& state, Workspace<double>& work) {
  CoordinateMotion motion;
  dynamics.accelerations(state.time(), state.q, state.v, state, work);
  dynamics.coordinate_rates(state.q, state.v, motion.rate);
  dynamics.coordinate_rates(state.q, work.v_dot, motion.curvature);
  VecX<double> turning;
  dynamics.coordinate_rates(motion.rate, state.v, turning);
  for (const PartModel& part : dynamics.model().parts())
    if (part.q0 >= 0) motion.curvature.segment<4>(part.q0 + 3) += turning.segment<4>(part.q0 + 3);
  return motion;
}

/// Returns the path of the coordinates between two states. Each block of coordinates is a polynomial of
/// degree 5 through q, its rates and its second derivatives at both states. If there is an impact at the end,
/// the rate and the second derivative there are not used. If other forces acted within the step, the cubic
/// Hermite polynomial is used.
StepPath quintic(const Model& model, const State& low, double h, const State& high) {
  const Dynamics dynamics(model);
  Workspace<double> work;
  const CoordinateMotion a = motion_at(dynamics, low, work), b = motion_at(dynamics, high, work);
  StepPolynomial path{low.q, hermite_terms(low.q, a.rate, h, high.q, b.rate, 2)};
  auto fill = [&](int first, int count) {
    auto of = [&](const VecX<double>& all) { return all.segment(first, count); };
    auto term = [&](int i) { return path.terms.col(i - 1).segment(first, count); };
    term(4).setZero();
    term(5).setZero();
    // The displacement minus the displacement due to the rate and the acceleration at the start.
    const VecX<double> rest = of(high.q) - of(low.q) - h * of(a.rate) - 0.5 * h * h * of(a.curvature);
    const double bend = std::max(of(a.curvature).norm(), of(b.curvature).norm());
    const double pushed =
        std::min(2 / h * rest.norm(),
                 (of(b.rate) - of(a.rate) - 0.5 * h * (of(a.curvature) + of(b.curvature))).norm());
    const double rounding = kRounding * std::max(of(a.rate).norm(), of(b.rate).norm());
    if (pushed > kPushed * h * bend + rounding) return;
    const double jump = (of(a.rate) + h * of(a.curvature) + 3 / h * rest - of(b.rate)).norm();
    if (jump > kJump * h * bend) {  // impact at the end: b.rate is the rate after the impact
      term(3) = 0.5 * h * h * of(a.curvature) + term(2);
      return;
    }
    term(4) = 0.5 * h * h * of(a.curvature) + term(2) - term(3);
    term(5) = 0.5 * h * h * of(b.curvature) + term(2) + 2 * term(3) - term(4);
  };
  for (const PartModel& part : model.parts()) {
    if (part.q0 < 0) continue;
    fill(part.q0, 3);
    fill(part.q0 + 3, 4);
    for (int k = 0; k < part.n_s; ++k) fill(part.q0 + 7 + k, 1);
    if (part.n_d() > 0) fill(part.q0 + 7 + part.n_s, part.n_d());
  }
  return {model, std::move(path)};
}

}  // namespace

RecordedStep::RecordedStep(const Model& model, const State& low, const State& high)
    : low_(&low),
      high_(&high),
      span_(high.time() - low.time()),
      q_(is_long() ? quintic(model, low, span_, high) : StepPath(Dynamics(model), low, span_, high)) {}

State RecordedStep::at(double t) const {
  const double x = (t - low_->time()) / span_;
  State state = *low_;
  q_.at(x, state.q);
  state.v = (1 - x) * low_->v + x * high_->v;
  state.work = (1 - x) * low_->work + x * high_->work;
  state.start = t;
  state.step = 0;
  return state;
}

}  // namespace pliant
