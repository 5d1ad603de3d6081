#include <pliant/part/part.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

#include <pliant/math/eigenvalues.h>
#include <pliant/part/mesh/folds.h>
#include <pliant/part/sum_inertia.h>

namespace pliant {

namespace {
std::string text(double x) {
  std::ostringstream out;
  out.precision(17);
  out << x;
  std::ostringstream brief;
  brief << x;
  return std::stod(brief.str()) == x ? brief.str() : out.str();
}
std::string text(const Range& r) {
  return "[" + text(r.min) + ", " + text(r.max) + "]";
}
}  // namespace

Part::Part(std::string name, double density, std::unique_ptr<ShapeFace> shape,
           const std::vector<LinkInfo>& links)
    : name_(std::move(name)), shape_(std::move(shape)), parameters_(*shape_, links), density_(density) {
  if (!(density > 0) || !std::isfinite(density))
    refuse("density " + text(density) + " is not a positive number");
  stiffness_ = MatX<double>::Zero(parameters_.size(), parameters_.size());
}

void Part::refuse(const std::string& what) const {
  throw std::invalid_argument("part '" + name_ + "': " + what);
}

void Part::change() {
  if (use_.use_count() > 1)
    throw std::logic_error("part '" + name_ + "' is in a simulation, and cannot be changed before that ends");
  prepared_ = false;
}

int Part::require(const std::string& parameter) const {
  const int i = parameters_.find(parameter);
  if (i < 0) refuse("no parameter '" + parameter + "'; it has: " + parameters_.names());
  return i;
}

Part& Part::place(const Vec3<double>& c, const Eigen::Quaterniond& R) {
  change();
  if (motion_) refuse("its motion is prescribed, which places it");
  if (!c.allFinite()) refuse("its position is not finite");
  if (!(R.norm() > 0) || !std::isfinite(R.norm()))
    refuse("its orientation is not a rotation (quaternion of length 0)");
  c0_ = c;
  R0_ = R.normalized();
  return *this;
}

Part& Part::velocity(const Vec3<double>& c_dot, const Vec3<double>& omega) {
  change();
  if (!c_dot.allFinite() || !omega.allFinite()) refuse("its initial velocity is not finite");
  c0_dot_ = c_dot;
  omega0_ = omega;
  return *this;
}

Part& Part::rest(const Named& values) {
  change();
  for (const auto& [parameter, value] : values) {
    Parameter& p = parameters_[require(parameter)];
    if (!p.spec->frozen.contains(value))
      refuse(parameter + " = " + text(value) + " is out of range; allowed: " + text(p.spec->frozen));
    p.rest = TimeFunction(value);
  }
  parameters_.update();
  return *this;
}

Part& Part::rest(const std::string& parameter, TimeFunction of_time) {
  change();
  const int i = require(parameter);
  if (!parameters_[i].spec->frozen.contains(of_time.value(0)))
    refuse(parameter + " = " + text(of_time.value(0)) +
           " at time 0 is out of range; allowed: " + text(parameters_[i].spec->frozen));
  parameters_[i].rest = std::move(of_time);
  parameters_.update();
  return *this;
}

Part& Part::initial(const Named& values) {
  change();
  for (const auto& [parameter, value] : values) {
    Parameter& p = parameters_[require(parameter)];
    if (!std::isfinite(value)) refuse("initial " + parameter + " is not finite");
    p.dynamic = true;
    p.initial = value;
    p.initial_given = true;
  }
  parameters_.update();
  return *this;
}

Part& Part::initial_rate(const Named& values) {
  change();
  for (const auto& [parameter, value] : values) {
    Parameter& p = parameters_[require(parameter)];
    if (!std::isfinite(value)) refuse("initial rate of " + parameter + " is not finite");
    p.dynamic = true;
    p.initial_rate = value;
  }
  parameters_.update();
  return *this;
}

Part& Part::stiffness(const Named& values) {
  change();
  for (const auto& [parameter, value] : values) {
    const int i = require(parameter);
    if (!(value >= 0) || !std::isfinite(value))
      refuse("stiffness " + text(value) + " of " + parameter + " is not a number >= 0");
    parameters_[i].dynamic = true;
    stiffness_(i, i) = value;
  }
  parameters_.update();
  return *this;
}

Part& Part::stiffness(const std::vector<std::string>& parameters, const MatX<double>& K) {
  change();
  const auto n = static_cast<Eigen::Index>(parameters.size());
  if (K.rows() != n || K.cols() != n)
    refuse("the stiffness matrix must be " + std::to_string(n) + " x " + std::to_string(n));
  if (!K.allFinite() || !K.isApprox(K.transpose(), 1e-12))
    refuse("the stiffness matrix must be finite and symmetric");
  const double lowest = symmetric_eigenvalues(K).minCoeff();
  if (lowest < -1e-12 * K.cwiseAbs().maxCoeff())
    refuse("the stiffness matrix has the negative eigenvalue " + text(lowest));
  for (Eigen::Index i = 0; i < n; ++i) {
    const int row = require(parameters[static_cast<std::size_t>(i)]);
    parameters_[row].dynamic = true;
    for (Eigen::Index j = 0; j < n; ++j)
      stiffness_(row, require(parameters[static_cast<std::size_t>(j)])) = K(i, j);
  }
  parameters_.update();
  return *this;
}

Part& Part::limits(const std::string& parameter, Range range) {
  change();
  Parameter& p = parameters_[require(parameter)];
  if (!(range.min < range.max)) refuse("limits " + text(range) + " of " + parameter + " must be increasing");
  p.limits = range;
  p.limits_given = true;
  return *this;
}

void Part::check_limits(const Parameter& p) const {
  const double scale = p.spec->relative ? p.rest_value() : 1.0;
  const Range allowed{p.spec->dynamic.min * scale, p.spec->dynamic.max * scale};
  if (p.limits.min < allowed.min || p.limits.max > allowed.max)
    refuse("limits " + text(p.limits) + " of " + p.name + " must be within " + text(allowed));
}

Part& Part::make_dynamic(const std::vector<std::string>& parameters) {
  change();
  for (const std::string& parameter : parameters) parameters_[require(parameter)].dynamic = true;
  parameters_.update();
  return *this;
}

Part& Part::freeze(const std::vector<std::string>& parameters) {
  change();
  for (const std::string& parameter : parameters) parameters_[require(parameter)].dynamic = false;
  parameters_.update();
  return *this;
}

Part& Part::damping(double alpha, double beta, double nu) {
  change();
  if (!(alpha >= 0) || !(beta >= 0) || !(nu >= 0) || !std::isfinite(alpha + beta + nu))
    refuse("damping alpha, beta and drag must be numbers >= 0");
  alpha_ = alpha;
  beta_ = beta;
  drag_ = nu;
  return *this;
}

Part& Part::make_shell() {
  change();
  shell_ = true;
  return *this;
}

Part& Part::mass(double total) {
  change();
  if (!(total > 0) || !std::isfinite(total)) refuse("mass " + text(total) + " is not a positive number");
  total_mass_ = total;
  return *this;
}

Part& Part::inertia(double mass, const Mat3<double>& about_origin, const Vec3<double>& centre) {
  change();
  if (!(mass > 0) || !std::isfinite(mass)) refuse("mass " + text(mass) + " is not a positive number");
  const Mat3<double> about_centre =
      about_origin - mass * (centre.squaredNorm() * Mat3<double>::Identity() - centre * centre.transpose());
  const Vec3<double> I = symmetric_eigenvalues(about_centre);
  if (!about_origin.isApprox(about_origin.transpose(), 1e-12) || !(I[0] > 0) ||
      I[0] + I[1] < I[2] * (1 - 1e-12))
    refuse("no body has this inertia: its principal moments about the centre of mass are " + text(I[0]) +
           ", " + text(I[1]) + ", " + text(I[2]) +
           "; each must be positive and at most the sum of the others");
  Inertia<double> given;
  given.mass = mass;
  given.moment = mass * centre;
  given.M = MatMax<double>::Zero(6, 6);
  given.M.topLeftCorner<3, 3>() = mass * Mat3<double>::Identity();
  given.M.topRightCorner<3, 3>() = -skew(given.moment);
  given.M.bottomLeftCorner<3, 3>() = skew(given.moment);
  given.M.bottomRightCorner<3, 3>() = about_origin;
  given.g_q = VecMax<double>::Zero(6);
  given_inertia_ = given;
  return *this;
}

Part& Part::deform_locally(LocalSettings settings) {
  change();
  if (!(settings.alpha >= 0) || !(settings.beta >= 0) || !std::isfinite(settings.alpha + settings.beta))
    refuse("the damping of its nodes, alpha " + text(settings.alpha) + " and beta " + text(settings.beta) +
           ", must not be negative");
  if (settings.order != 1 && settings.order != 2)
    refuse("elements of order " + std::to_string(settings.order) + " are not there; expected 1 or 2");
  local_settings_ = std::move(settings);
  return *this;
}

Part& Part::elasticity(ContinuumSettings settings) {
  change();
  try {
    continuum_law(settings);
  } catch (const std::invalid_argument& e) {
    refuse(e.what());
  }
  continuum_settings_ = std::move(settings);
  return *this;
}

Part& Part::fix() {
  change();
  if (motion_) refuse("its motion is prescribed; it cannot be fixed too");
  fixed_ = true;
  return *this;
}

Part& Part::prescribe(PrescribedMotion motion) {
  change();
  if (fixed_ && !motion_) refuse("it is fixed; its motion cannot be prescribed too");
  if (!motion.axis.allFinite() || motion.axis.isZero(0)) refuse("the axis of its motion has no direction");
  if (!(motion.orientation.norm() > 0) || !std::isfinite(motion.orientation.norm()))
    refuse("its orientation is not a rotation (quaternion of length 0)");
  motion.axis.stableNormalize();
  motion.orientation.normalize();
  const MovingFrame start = motion.at(0);
  if (!start.c.allFinite() || !start.R.allFinite()) refuse("its motion is not finite at time 0");
  c0_ = start.c;
  R0_ = motion.orientation_at(0);
  motion_ = std::move(motion);
  fixed_ = true;
  return *this;
}

void Part::check_elasticity() const {
  if (!continuum_settings_) return;
  const auto& laws = all_continuum_laws();
  const auto law = std::find_if(laws.begin(), laws.end(), [&](const ContinuumLawInfo& info) {
    return info.name == continuum_settings_->law;
  });
  if (law->shell != shell_)
    refuse("the law '" + continuum_settings_->law + "' of its elasticity is of " +
           (law->shell ? "shells, not of solids" : "solids, not of shells"));
  if (local_settings_)
    refuse(
        "its nodes deform locally, so a law of these is to be its elasticity: it is that of the whole map");
  for (const int i : parameters_.dynamic()) {
    const Parameter& p = parameters_[i];
    if (p.spec->quantity == Quantity::exponent && !shape_->bounded_exponents())
      refuse("a changing " + p.name + " strains the material of a " + shape_->name() +
             " without bound, so it has no elastic energy; freeze " + p.name +
             (shape_->name() == std::string("superellipsoid")
                  ? ", or take the shape superellipsoid_radial, whose material follows by bounded strains"
                  : ""));
    if (!p.rest.is_constant() && stiffness_.row(i).isZero(0))
      refuse("the rest value of " + p.name +
             " moves in time, but its elastic material rests in the shape of time 0; give " + p.name +
             " a stiffness, through which its rest value pulls");
  }
}

bool Part::linear() const {
  const std::vector<int>& dynamic = parameters_.dynamic();
  return !dynamic.empty() && parameters_.links().empty() && shape_->linear_lengths() &&
         std::all_of(dynamic.begin(), dynamic.end(),
                     [&](int i) { return parameters_[i].spec->quantity == Quantity::length; });
}

void Part::prepare() {
  if (prepared_) return;
  parameters_.update();
  const int n = parameters_.n_dynamic();
  for (int k = 0; k < parameters_.size(); ++k) {
    const Parameter& p = parameters_[k];
    if (!p.dynamic) {
      if (!p.rest.is_constant())
        refuse("the rest value of " + p.name + " moves in time, so " + p.name + " must be dynamic");
      continue;
    }
    if (p.limits_given) check_limits(p);
    if (!p.limits.contains(p.rest_value()))
      refuse("the rest value " + text(p.rest_value()) + " of " + p.name + " is outside its limits " +
             text(p.limits));
    if (!p.limits.contains(p.initial))
      refuse("the initial value " + text(p.initial) + " of " + p.name + " is outside its limits " +
             text(p.limits));
  }
  const std::string unmoved = motion_ ? "a part of prescribed motion" : "a fixed part";
  if (fixed_ && n > 0) refuse(unmoved + " has no dynamic parameters; freeze " + parameters_.moving(0).name);
  if (given_inertia_ && n > 0) refuse("an inertia can be given to a rigid part only; freeze its parameters");
  if (given_inertia_ && local_settings_)
    refuse("a part that deforms locally takes its inertia from its density");
  if (fixed_ && local_settings_) refuse(unmoved + " does not deform locally");
  check_elasticity();
  K_s_.resize(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      K_s_(i, j) = stiffness_(parameters_.dynamic()[static_cast<std::size_t>(i)],
                              parameters_.dynamic()[static_cast<std::size_t>(j)]);

  const ParameterValues<double> rest = parameters_.rest();
  std::vector<Material<double>> surface;
  for (int i = 0; i < 16; ++i)
    for (int j = -4; j <= 4; ++j) surface.push_back(material_at(j * kPi / 8, i * kPi / 8));
  size_ = s(surface, rest).rowwise().lpNorm<Eigen::Infinity>().maxCoeff();

  if (given_inertia_) {
    refuse_folds(*this, rest, "rest");
    rest_inertia_ = *given_inertia_;
    prepared_ = true;
    return;
  }
  mass_points_ = place_mass_points(*this);
  VecMax<double> q_s(n);
  for (int k = 0; k < n; ++k) q_s[k] = parameters_.moving(k).rest_value();
  Counters unused;
  auto take = [&] {
    Inertia<double> sum;
    sum_inertia(*this, mass_points_, q_s, VecMax<double>::Zero(n), Vec3<double>::Zero(), sum, unused);
    return sum;
  };
  rest_inertia_ = take();
  const double volume = rest_inertia_.mass / density_;
  if (total_mass_) {
    const double factor = *total_mass_ / rest_inertia_.mass;
    for (Pack& m : mass_points_.mass) m *= Pack(factor);
    rest_inertia_ = take();
  }
  linear_inertia_.reset();
  if (linear()) linear_inertia_ = make_linear_inertia(*this, mass_points_);
  if (local_settings_) local_ = make_local_deformation(*this, *local_settings_);
  continuum_.reset();
  if (continuum_settings_ && n > 0)
    continuum_ = std::make_unique<ContinuumEnergy>(*this, *continuum_settings_, volume);
  prepared_ = true;
}

double Part::inertia_floor(int k) const {
  constexpr double part_of_mass = 1e-24;
  const bool length = parameters_.moving(k).spec->quantity == Quantity::length;
  return part_of_mass * total_mass() * (length ? 1.0 : size_ * size_);
}

MatX<double> Part::elastic_stiffness(const VecMax<double>& q_s) const {
  return continuum_ ? MatX<double>(K_s_ + continuum_->stiffness(*this, q_s)) : K_s_;
}
MatX<double> Part::strain_stiffness(const VecMax<double>& q_s) const {
  return continuum_ ? MatX<double>(K_s_ + continuum_->strain_stiffness(*this, q_s)) : K_s_;
}

}  // namespace pliant
