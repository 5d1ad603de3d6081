#include <pliant/view/stable_stiffness.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include <pliant/math/column_basis.h>
#include <pliant/math/eigenvalues.h>
#include <pliant/part/local/local_deformation.h>
#include <pliant/simulate/stable_step.h>

namespace pliant {

namespace {

/// The K of a motion is its stiffness divided by its effective mass, 1/s^2. The K of the scene counts as at
/// most this share of the largest stable K, so that the user can add stiffnesses.
constexpr double kMaxPresentShare = 0.75;
/// A stiffness is at most this share of the largest stable stiffness, because the effective mass is an
/// estimate.
constexpr double kStiffnessShare = 0.8;
/// If a damping is reduced, it becomes this share of the largest stable damping, so that a stiffness can be
/// added.
constexpr double kDampingShare = 0.5;
/// Steps of length h resolve a motion with K h^2 and D h up to these numbers. D is the damping divided by the
/// effective mass, 1/s.
constexpr double kResolvedStiffness = 0.25, kResolvedDamping = 0.5;
/// Number of halvings of each search.
constexpr int kHalvings = 60;

bool is_stable(const Integrator& method, double K, double D, double h) {
  return method.growth(MatX<double>::Constant(1, 1, K), MatX<double>::Constant(1, 1, D), h) <= 1 + 1e-9;
}

/// Returns, by bisection, the largest stable number below an unstable number.
template <class Condition>
double largest_below(double unstable, Condition&& stable) {
  double low = 0, high = unstable;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = 0.5 * (low + high);
    (stable(middle) ? low : high) = middle;
  }
  return low;
}

/// Returns the largest stable K without damping, 1/s^2, by bisection; 0 if there is no bound.
double largest_stable(const Integrator& method, double h) {
  double low = 1e-6 / (h * h), high = 1e3 / (h * h);
  if (is_stable(method, high, 0, h)) return 0;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = std::sqrt(low * high);
    (is_stable(method, middle, 0, h) ? low : high) = middle;
  }
  return low;
}

/// The frame and the mass matrix of a part at the state of a simulation.
struct PlacedPart {
  const PartModel& model;
  std::size_t number;
  Workspace<double> work;

  const PartWorkspace<double>& part() const { return work.parts[number]; }
  /// Returns the inverse of M over (c, theta, q_s) in the body frame, 0 for coordinates without inertia.
  MatX<double> inverse() const { return pseudo_inverse(mass_matrix(part())); }
};

PlacedPart place(const Simulation& simulation, const Part& part) {
  const Model& model = simulation.model();
  const int number = model.body().index(part);
  const auto k = static_cast<std::size_t>(number);
  PlacedPart placed{model.parts()[k], k, {}};
  const State& state = simulation.state();
  simulation.dynamics().evaluate_frame(state.time(), state.q, state.v, number, placed.work);
  return placed;
}

}  // namespace

InverseMass inverse_mass(const Simulation& simulation, const Point& point) {
  const PlacedPart placed = place(simulation, *point.part);
  const PartWorkspace<double>& w = placed.part();
  std::vector<PointJet<double>> at;
  Counters unused;
  point.part->points({point.material}, w.q_s, w.q_s_dot, at, unused);
  MatX<double> L(3, 6 + placed.model.n_s);  // Eq. (9): the velocity of the point is L v_r
  L << Mat3<double>::Identity(), -skew(at[0].p), at[0].J;
  const MatX<double> response = L * placed.inverse() * L.transpose();
  const LocalDeformation* local = placed.model.local;
  return {symmetric_eigenvalues(response).maxCoeff(),
          local != nullptr ? local->mobility(Model::node_weights(point)) : 0};
}

double inverse_mass(const Simulation& simulation, const Part& part, int k) {
  return place(simulation, part).inverse()(6 + k, 6 + k);
}

StableStiffness::StableStiffness(const Simulation& simulation, double step) : step_(step) {
  if (step == 0) return;
  const double largest = largest_stable(simulation.integrator(), step),
               ratio = step / stable_step(simulation).step;
  present_ = std::min(kMaxPresentShare, ratio * ratio) * largest;
}

SpringConstants StableStiffness::resolved(const SpringConstants& wanted,
                                          const InverseMass& inverse_mass) const {
  if (step_ == 0 || !(inverse_mass.frame > 0)) return wanted;
  return {std::min(wanted.stiffness, kResolvedStiffness / (step_ * step_ * inverse_mass.frame)),
          std::min(wanted.damping, kResolvedDamping / (step_ * inverse_mass.frame))};
}

SpringConstants StableStiffness::bounded(const Integrator& method, const SpringConstants& wanted,
                                         double inverse_mass) const {
  if (step_ == 0 || !std::isfinite(inverse_mass)) return wanted;
  SpringConstants bounded = wanted;
  const auto damping_is_stable = [&](double damping) {
    return is_stable(method, 0, damping * inverse_mass, step_);
  };
  if (!damping_is_stable(wanted.damping))
    bounded.damping = kDampingShare * largest_below(wanted.damping, damping_is_stable);
  // The stiffness of the scene may stabilise a strong damping. A motion without this stiffness must be stable
  // too, so K is tested with and without present_.
  const auto stiffness_is_stable = [&](double stiffness) {
    const double K = stiffness * inverse_mass / kStiffnessShare, D = bounded.damping * inverse_mass;
    return is_stable(method, K, D, step_) && is_stable(method, present_ + K, D, step_);
  };
  if (!stiffness_is_stable(wanted.stiffness))
    bounded.stiffness = largest_below(wanted.stiffness, stiffness_is_stable);
  return bounded;
}

}  // namespace pliant
