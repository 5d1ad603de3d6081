// Function bodies of PartDescription: the setters of a part with their checks, and the checks of the whole
// description.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstring>
#include <sstream>
#include <stdexcept>
#include <typeinfo>

#include <pliant/math/eigenvalues.h>
#include <pliant/math/header_only.h>
#include <pliant/part/part.h>

namespace pliant {

namespace detail {

/// Returns x as text: with 6 digits if this text reads back as exactly x, else with 17 digits.
inline std::string part_text(double x) {
  std::ostringstream out;
  out.precision(17);
  out << x;
  std::ostringstream brief;
  brief << x;
  return std::stod(brief.str()) == x ? brief.str() : out.str();
}
inline std::string part_text(const Range& r) {
  return "[" + part_text(r.min) + ", " + part_text(r.max) + "]";
}

/// Returns the inertia of a rigid part with g_q = 0. The arguments are those of PartDescription::inertia().
inline Inertia<double> rigid_part_inertia(double mass, const Mat3<double>& about_origin,
                                          const Vec3<double>& centre) {
  Inertia<double> inertia;
  inertia.mass = mass;
  inertia.moment = mass * centre;
  inertia.M = MatMax<double>::Zero(6, 6);
  inertia.M.topLeftCorner<3, 3>() = mass * Mat3<double>::Identity();
  inertia.M.topRightCorner<3, 3>() = -skew(inertia.moment);
  inertia.M.bottomLeftCorner<3, 3>() = skew(inertia.moment);
  inertia.M.bottomRightCorner<3, 3>() = about_origin;
  inertia.g_q = VecMax<double>::Zero(6);
  return inertia;
}

/// Appends the bits of numbers, addresses and texts to a key.
class KeyWriter {
 public:
  explicit KeyWriter(ConstantsKey& key) : key_(key) {}
  void add(double x) {
    std::uint64_t bits;
    static_assert(sizeof bits == sizeof x);
    std::memcpy(&bits, &x, sizeof bits);
    key_.push_back(bits);
  }
  void add(const void* address) { key_.push_back(reinterpret_cast<std::uintptr_t>(address)); }
  template <class Matrix>
  void add_all(const Matrix& numbers) {
    key_.push_back(static_cast<std::uint64_t>(numbers.size()));
    for (Eigen::Index i = 0; i < numbers.size(); ++i) add(numbers.data()[i]);
  }
  void add_text(const std::string& text) {
    key_.push_back(text.size());
    for (const char c : text) key_.push_back(static_cast<unsigned char>(c));
  }
  void add_count(std::size_t n) { key_.push_back(n); }

 private:
  ConstantsKey& key_;
};

}  // namespace detail

PLIANT_INLINE PartDescription::PartDescription(std::string name, double density,
                                               std::unique_ptr<ShapeInterface> shape,
                                               const std::vector<LinkInfo>& links)
    : name_(std::move(name)), shape_(std::move(shape)), parameters_(*shape_, links), density_(density) {
  if (!(density > 0) || !std::isfinite(density))
    refuse("density " + detail::part_text(density) + " is not a positive number");
  stiffness_ = MatX<double>::Zero(parameters_.size(), parameters_.size());
}

PLIANT_INLINE const Part& PartDescription::part() const {
  return static_cast<const Part&>(*this);
}
PLIANT_INLINE Part& PartDescription::part() {
  return static_cast<Part&>(*this);
}

PLIANT_INLINE void PartDescription::refuse(const std::string& what) const {
  throw std::invalid_argument("part '" + name_ + "': " + what);
}

PLIANT_INLINE void PartDescription::require_unused() const {
  if (use_.use_count() > 1)
    throw std::logic_error("part '" + name_ +
                           "' is in a simulation and cannot be changed until the simulation ends");
}

PLIANT_INLINE void PartDescription::change() {
  require_unused();
  changed_ = true;
}

PLIANT_INLINE int PartDescription::require(const std::string& parameter) const {
  const int i = parameters_.find(parameter);
  if (i < 0) refuse("no parameter '" + parameter + "'; it has: " + parameters_.names());
  return i;
}

PLIANT_INLINE Part& PartDescription::place(const Vec3<double>& c, const Eigen::Quaterniond& R) {
  change();
  if (motion_) refuse("its motion is prescribed and sets its position; do not place it");
  if (!c.allFinite()) refuse("its position is not finite");
  if (!(R.norm() > 0) || !std::isfinite(R.norm()))
    refuse("its orientation is not a rotation: its quaternion has length 0 or is not finite");
  c0_ = c;
  R0_ = R.normalized();
  return part();
}

PLIANT_INLINE Part& PartDescription::velocity(const Vec3<double>& c_dot, const Vec3<double>& omega) {
  change();
  if (!c_dot.allFinite() || !omega.allFinite()) refuse("its initial velocity is not finite");
  c0_dot_ = c_dot;
  omega0_ = omega;
  return part();
}

PLIANT_INLINE Part& PartDescription::rest(const Named& values) {
  change();
  for (const auto& [parameter, value] : values) {
    Parameter& p = parameters_[require(parameter)];
    if (!p.spec->frozen.contains(value))
      refuse(parameter + " = " + detail::part_text(value) +
             " is out of range; allowed: " + detail::part_text(p.spec->frozen));
    p.rest = TimeFunction(value);
  }
  parameters_.update();
  return part();
}

PLIANT_INLINE Part& PartDescription::rest(const std::string& parameter, TimeFunction of_time) {
  change();
  const int i = require(parameter);
  if (!parameters_[i].spec->frozen.contains(of_time.value(0)))
    refuse(parameter + " = " + detail::part_text(of_time.value(0)) +
           " at time 0 is out of range; allowed: " + detail::part_text(parameters_[i].spec->frozen));
  parameters_[i].rest = std::move(of_time);
  parameters_.update();
  return part();
}

PLIANT_INLINE Part& PartDescription::initial(const Named& values) {
  change();
  for (const auto& [parameter, value] : values) {
    Parameter& p = parameters_[require(parameter)];
    if (!std::isfinite(value)) refuse("initial " + parameter + " is not finite");
    p.dynamic = true;
    p.initial = value;
    p.initial_given = true;
  }
  parameters_.update();
  return part();
}

PLIANT_INLINE Part& PartDescription::initial_rate(const Named& values) {
  change();
  for (const auto& [parameter, value] : values) {
    Parameter& p = parameters_[require(parameter)];
    if (!std::isfinite(value)) refuse("initial rate of " + parameter + " is not finite");
    p.dynamic = true;
    p.initial_rate = value;
  }
  parameters_.update();
  return part();
}

PLIANT_INLINE Part& PartDescription::stiffness(const Named& values) {
  change();
  for (const auto& [parameter, value] : values) {
    const int i = require(parameter);
    if (!(value >= 0) || !std::isfinite(value))
      refuse("stiffness " + detail::part_text(value) + " of " + parameter + " is not a number >= 0");
    parameters_[i].dynamic = true;
    stiffness_(i, i) = value;
  }
  parameters_.update();
  return part();
}

PLIANT_INLINE Part& PartDescription::stiffness(const std::vector<std::string>& parameters,
                                               const MatX<double>& K) {
  change();
  const auto n = static_cast<Eigen::Index>(parameters.size());
  if (K.rows() != n || K.cols() != n)
    refuse("the stiffness matrix must be " + std::to_string(n) + " x " + std::to_string(n));
  if (!K.allFinite() || !K.isApprox(K.transpose(), 1e-12))
    refuse("the stiffness matrix must be finite and symmetric");
  const double lowest = symmetric_eigenvalues(K).minCoeff();
  if (lowest < -1e-12 * K.cwiseAbs().maxCoeff())
    refuse("the stiffness matrix has the negative eigenvalue " + detail::part_text(lowest));
  for (Eigen::Index i = 0; i < n; ++i) {
    const int row = require(parameters[static_cast<std::size_t>(i)]);
    parameters_[row].dynamic = true;
    for (Eigen::Index j = 0; j < n; ++j)
      stiffness_(row, require(parameters[static_cast<std::size_t>(j)])) = K(i, j);
  }
  parameters_.update();
  return part();
}

PLIANT_INLINE Part& PartDescription::limits(const std::string& parameter, Range range) {
  change();
  Parameter& p = parameters_[require(parameter)];
  if (!(range.min < range.max))
    refuse("limits " + detail::part_text(range) + " of " + parameter + " must be increasing");
  p.limits = range;
  p.limits_given = true;
  return part();
}

PLIANT_INLINE void PartDescription::check_limits(const Parameter& p) const {
  const double scale = p.spec->relative ? p.rest_value() : 1.0;
  const Range allowed{p.spec->dynamic.min * scale, p.spec->dynamic.max * scale};
  if (p.limits.min < allowed.min || p.limits.max > allowed.max)
    refuse("limits " + detail::part_text(p.limits) + " of " + p.name + " must be within " +
           detail::part_text(allowed));
}

PLIANT_INLINE Part& PartDescription::make_dynamic(const std::vector<std::string>& parameters) {
  change();
  for (const std::string& parameter : parameters) parameters_[require(parameter)].dynamic = true;
  parameters_.update();
  return part();
}

PLIANT_INLINE Part& PartDescription::freeze(const std::vector<std::string>& parameters) {
  change();
  for (const std::string& parameter : parameters) parameters_[require(parameter)].dynamic = false;
  parameters_.update();
  return part();
}

PLIANT_INLINE Part& PartDescription::damping(double alpha, double beta, double nu) {
  change();
  if (!(alpha >= 0) || !(beta >= 0) || !(nu >= 0) || !std::isfinite(alpha + beta + nu))
    refuse("damping alpha, beta and drag must be numbers >= 0");
  alpha_ = alpha;
  beta_ = beta;
  drag_ = nu;
  return part();
}

PLIANT_INLINE Part& PartDescription::make_shell() {
  change();
  shell_ = true;
  return part();
}

PLIANT_INLINE Part& PartDescription::mass(double total) {
  change();
  if (!(total > 0) || !std::isfinite(total))
    refuse("mass " + detail::part_text(total) + " is not a positive number");
  total_mass_ = total;
  return part();
}

PLIANT_INLINE Part& PartDescription::use_diagonal_mass() {
  change();
  diagonal_mass_ = true;
  return part();
}

PLIANT_INLINE Part& PartDescription::distribute_mass(MassDistribution distribution) {
  change();
  if (!distribution) refuse("its mass distribution is an empty function");
  mass_distribution_ = std::make_unique<const MassDistribution>(std::move(distribution));
  return part();
}

PLIANT_INLINE Part& PartDescription::inertia(double mass, const Mat3<double>& about_origin,
                                             const Vec3<double>& centre) {
  change();
  if (!(mass > 0) || !std::isfinite(mass))
    refuse("mass " + detail::part_text(mass) + " is not a positive number");
  const Mat3<double> about_centre =
      about_origin - mass * (centre.squaredNorm() * Mat3<double>::Identity() - centre * centre.transpose());
  const Vec3<double> I = symmetric_eigenvalues(about_centre);
  if (!about_origin.isApprox(about_origin.transpose(), 1e-12) || !(I[0] > 0) ||
      I[0] + I[1] < I[2] * (1 - 1e-12))
    refuse("no body has this inertia: its principal moments about the centre of mass are " +
           detail::part_text(I[0]) + ", " + detail::part_text(I[1]) + ", " + detail::part_text(I[2]) +
           "; each must be positive and at most the sum of the others, and the matrix must be symmetric");
  given_inertia_ =
      std::make_unique<const Inertia<double>>(detail::rigid_part_inertia(mass, about_origin, centre));
  return part();
}

PLIANT_INLINE Part& PartDescription::deform_locally(LocalSettings settings) {
  change();
  if (!(settings.alpha >= 0) || !(settings.beta >= 0) || !std::isfinite(settings.alpha + settings.beta))
    refuse("alpha " + detail::part_text(settings.alpha) + " and beta " + detail::part_text(settings.beta) +
           " of its local deformation must be numbers >= 0");
  if (settings.order != 1 && settings.order != 2)
    refuse("there are no elements of order " + std::to_string(settings.order) + "; expected 1 or 2");
  local_settings_ = std::make_unique<const LocalSettings>(std::move(settings));
  return part();
}

PLIANT_INLINE Part& PartDescription::scale_local(TimeFunction factor) {
  require_unused();
  if (!local_settings_) refuse("it does not deform locally, so that its local stiffness has no factor");
  if (const double first = factor.value(0); !(first >= 0) || !std::isfinite(first))
    refuse("the factor of its local stiffness is " + detail::part_text(first) +
           " at time 0; expected a number >= 0");
  const bool one = factor.is_constant() && factor.value(0) == 1;
  local_factor_ = one ? nullptr : std::make_unique<const TimeFunction>(std::move(factor));
  return part();
}

PLIANT_INLINE Part& PartDescription::elasticity(ContinuumSettings settings) {
  change();
  try {
    continuum_law(settings);
  } catch (const std::invalid_argument& e) {
    refuse(e.what());
  }
  continuum_settings_ = std::make_unique<const ContinuumSettings>(std::move(settings));
  return part();
}

PLIANT_INLINE Part& PartDescription::fix() {
  change();
  if (motion_) refuse("its motion is prescribed; it cannot be fixed as well");
  fixed_ = true;
  return part();
}

PLIANT_INLINE Part& PartDescription::prescribe(PrescribedMotion motion) {
  change();
  if (fixed_ && !motion_) refuse("it is fixed; its motion cannot be prescribed as well");
  if (!motion.axis.allFinite() || motion.axis.isZero(0)) refuse("the axis of its motion has no direction");
  if (!(motion.orientation.norm() > 0) || !std::isfinite(motion.orientation.norm()))
    refuse("its orientation is not a rotation: its quaternion has length 0 or is not finite");
  motion.axis.stableNormalize();
  motion.orientation.normalize();
  const MovingFrame start = motion.at(0);
  if (!start.c.allFinite() || !start.R.allFinite()) refuse("its motion is not finite at time 0");
  c0_ = start.c;
  R0_ = motion.orientation_at(0);
  motion_ = std::make_unique<const PrescribedMotion>(std::move(motion));
  fixed_ = true;
  return part();
}

PLIANT_INLINE void PartDescription::check_elasticity() const {
  if (!continuum_settings_) return;
  const auto& laws = all_continuum_laws();
  const auto law = std::find_if(laws.begin(), laws.end(), [&](const ContinuumLawInfo& info) {
    return info.name == continuum_settings_->law;
  });
  if (law->shell != shell_)
    refuse("the law '" + continuum_settings_->law + "' of its elasticity is for " +
           (law->shell ? "shells, not for solids" : "solids, not for shells"));
  if (local_settings_)
    refuse(
        "it deforms locally, so its elasticity must be a law of its local deformation, which covers its "
        "global deformation too");
  for (const int i : parameters_.dynamic()) check_elastic_parameter(i);
}

PLIANT_INLINE void PartDescription::check_elastic_parameter(int i) const {
  const Parameter& p = parameters_[i];
  if (p.spec->quantity == Quantity::exponent && !shape_->bounded_exponents())
    refuse("a changing " + p.name + " strains the material of a " + shape_->name() +
           " without bound, so it has no elastic energy; freeze " + p.name +
           (shape_->name() == std::string("superellipsoid")
                ? ", or use the shape superellipsoid_radial, whose strains stay bounded"
                : ""));
  if (!p.rest.is_constant() && stiffness_.row(i).isZero(0))
    refuse("the rest value of " + p.name +
           " changes in time, but the rest shape of its elastic material is that of time 0; give " + p.name +
           " a stiffness, which pulls it to its rest value");
}

PLIANT_INLINE void PartDescription::check_parameter(const Parameter& p) const {
  if (!p.dynamic) {
    if (!p.rest.is_constant())
      refuse("the rest value of " + p.name + " changes in time, so " + p.name + " must be dynamic");
    return;
  }
  if (p.limits_given) check_limits(p);
  if (!p.limits.contains(p.rest_value()))
    refuse("the rest value " + detail::part_text(p.rest_value()) + " of " + p.name +
           " is outside its limits " + detail::part_text(p.limits));
  if (!p.limits.contains(p.initial))
    refuse("the initial value " + detail::part_text(p.initial) + " of " + p.name + " is outside its limits " +
           detail::part_text(p.limits));
}

PLIANT_INLINE void PartDescription::check() const {
  for (int k = 0; k < parameters_.size(); ++k) check_parameter(parameters_[k]);
  const int n = parameters_.n_dynamic();
  const std::string without_coordinates = motion_ ? "a part of prescribed motion" : "a fixed part";
  if (fixed_ && n > 0)
    refuse(without_coordinates + " has no dynamic parameters; freeze " + parameters_.moving(0).name);
  if (given_inertia_ && n > 0) refuse("only a rigid part can be given an inertia; freeze its parameters");
  if (given_inertia_ && local_settings_)
    refuse("a part that deforms locally gets its inertia from its density; do not give it an inertia");
  if (given_inertia_ && mass_distribution_)
    refuse("its inertia is given, so that a mass distribution has no effect; give one of them");
  if (diagonal_mass_ && local_settings_)
    refuse("a part that deforms locally has the consistent mass matrix; do not give it a diagonal one");
  if (mass_distribution_ && local_settings_ && local_settings_->basis != LocalSettings::Basis::nodes)
    refuse(
        "modes and polynomials have the same density everywhere; use the basis \"nodes\" with a mass "
        "distribution");
  if (fixed_ && local_settings_) refuse(without_coordinates + " does not deform locally");
  check_elasticity();
}

PLIANT_INLINE MatX<double> PartDescription::dynamic_stiffness() const {
  const std::vector<int>& dynamic = parameters_.dynamic();
  const int n = parameters_.n_dynamic();
  MatX<double> K_s(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      K_s(i, j) = stiffness_(dynamic[static_cast<std::size_t>(i)], dynamic[static_cast<std::size_t>(j)]);
  return K_s;
}

PLIANT_INLINE std::optional<ConstantsKey> PartDescription::constants_key() const {
  if (local_settings_ || mass_distribution_) return std::nullopt;
  ConstantsKey key;
  detail::KeyWriter writer(key);
  const auto& self = part();
  writer.add(&typeid(self));  // the type fixes the shape, and the chain unless it is an AnyChain
  writer.add_count(parameters_.all_links().size());
  for (const LinkInfo& link : parameters_.all_links()) {
    writer.add(link.parameters);
    writer.add_count(static_cast<std::size_t>(link.amplitudes));
  }
  for (int i = 0; i < parameters_.size(); ++i) {
    const Parameter& p = parameters_[i];
    writer.add(p.spec);
    writer.add_count(p.dynamic ? 1 : 0);
    for (const double x : {p.rest_value(), p.initial, p.limits.min, p.limits.max}) writer.add(x);
  }
  writer.add_all(dynamic_stiffness());
  writer.add_count(shell_ ? 1 : 0);
  writer.add_count(fixed_ ? 1 : 0);
  writer.add_count(diagonal_mass_ ? 1 : 0);
  writer.add(density_);
  writer.add_count(total_mass_ ? 1 : 0);
  writer.add(total_mass_.value_or(0));
  writer.add_count(given_inertia_ ? 1 : 0);
  if (given_inertia_) {
    writer.add(given_inertia_->mass);
    writer.add_all(given_inertia_->moment);
    writer.add_all(given_inertia_->M);
  }
  writer.add_count(continuum_settings_ ? 1 : 0);
  if (continuum_settings_) {
    writer.add_text(continuum_settings_->law);
    for (const double x : {continuum_settings_->E, continuum_settings_->nu_P, continuum_settings_->thickness})
      writer.add(x);
  }
  return key;
}

PLIANT_INLINE bool PartDescription::linear() const {
  const std::vector<int>& dynamic = parameters_.dynamic();
  return !dynamic.empty() && parameters_.links().empty() && shape_->linear_lengths() &&
         std::all_of(dynamic.begin(), dynamic.end(),
                     [&](int i) { return parameters_[i].spec->quantity == Quantity::length; });
}

}  // namespace pliant
