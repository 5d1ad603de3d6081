// The description of a part: everything that the user sets. Part (part.h) inherits these setters through
// PartEvaluation. Part::prepare() computes the constants of the part from this description.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/part/constants_cache.h>
#include <pliant/part/continuum.h>
#include <pliant/part/inertia.h>
#include <pliant/part/local/local_deformation.h>
#include <pliant/part/parameters.h>
#include <pliant/part/prescribed_motion.h>
#include <pliant/part/quadrature/mass_distribution.h>

namespace pliant {

class Part;

class PartDescription {
 public:
  /// Pairs of a parameter name and a value: {{"a1", 0.5}, {"taper.tx", 0.2}}.
  using Named = std::vector<std::pair<std::string, double>>;

  PartDescription(const PartDescription&) = delete;
  PartDescription& operator=(const PartDescription&) = delete;

  // The setters. Each setter returns the part, so that calls can be chained. A setter throws
  // std::invalid_argument for an impossible argument. The message names the part, and the parameter, the
  // value and the allowed values if the error concerns a parameter. A setter throws std::logic_error while a
  // Model uses the part.

  /// Sets the position c of the frame (m, world) and its orientation R (body to world), which is normalised
  /// here.
  Part& place(const Vec3<double>& c, const Eigen::Quaterniond& R = Eigen::Quaterniond::Identity());
  /// Sets the velocity of the frame (m/s, world) and its angular velocity (rad/s, body frame) at time 0.
  Part& velocity(const Vec3<double>& c_dot, const Vec3<double>& omega);
  /// Sets constant rest values (m, rad or 1). A frozen parameter always has its rest value.
  Part& rest(const Named& values);
  /// Sets a rest value that is a function of time. Unless the function is constant, the parameter must be
  /// dynamic when prepare() runs.
  Part& rest(const std::string& parameter, TimeFunction of_time);
  /// Sets values at time 0 (m, rad or 1), and makes the parameters dynamic.
  Part& initial(const Named& values);
  /// Sets rates at time 0, per second, and makes the parameters dynamic.
  Part& initial_rate(const Named& values);
  /// Sets entries K of the diagonal of K_s, and makes the parameters dynamic. The energy (J) of a parameter q
  /// is 1/2 K (q - rest)^2.
  Part& stiffness(const Named& values);
  /// Sets a symmetric, positive semidefinite block K of K_s over the named parameters, and makes these
  /// parameters dynamic.
  Part& stiffness(const std::vector<std::string>& parameters, const MatX<double>& K);
  /// Sets the lower and the upper limit of a dynamic parameter. Each limit is a one-sided constraint.
  /// prepare() checks that the limits are within the dynamic range of the ParameterSpec. With
  /// ParameterSpec::relative, this range is in multiples of the rest value.
  Part& limits(const std::string& parameter, Range range);
  /// Makes the part elastic: the strain energy of the map from the rest shape to the present shape is added
  /// to the energy of K_s. prepare() throws if the part also deforms locally; the laws of the local
  /// deformation then give the elasticity.
  Part& elasticity(ContinuumSettings settings);
  /// Makes the parameters degrees of freedom.
  Part& make_dynamic(const std::vector<std::string>& parameters);
  /// Makes the parameters constants.
  Part& freeze(const std::vector<std::string>& parameters);
  /// Sets the damping D = alpha M_ss + beta K_s of the global parameters (alpha in 1/s, beta in s) and the
  /// drag -nu M v on all velocities v (nu in 1/s). M_ss is the block of M over q_s. beta also multiplies the
  /// viscous stress of elastic material.
  Part& damping(double alpha, double beta, double nu = 0);
  /// Puts the mass on the surface. The density is then per area (kg/m^2).
  Part& make_shell();
  /// Sets the total mass (kg). The masses of all mass points are scaled to this total.
  Part& mass(double total);
  /// Sets the mass distribution mu(u), Eq. (11): density() times a function of the material point. Cannot be
  /// combined with inertia(), nor with local deformation by modes or polynomials.
  Part& distribute_mass(MassDistribution distribution);
  /// Makes accelerations follow from the diagonal of M, section 5 of the paper: M then does not couple
  /// translation, rotation and parameters. This option is for comparisons. Energy and momenta are not
  /// conserved, and the free fall of a body whose centre of mass is not the origin of its frame is wrong.
  /// Cannot be combined with local deformation.
  Part& use_diagonal_mass();
  /// Sets the mass (kg), the inertia tensor about the origin of the frame (kg m^2, body frame) and the centre
  /// of mass (m, body frame) of a rigid part. These values replace the density.
  Part& inertia(double mass, const Mat3<double>& about_origin,
                const Vec3<double>& centre = Vec3<double>::Zero());
  /// Makes the part deform locally, with nodal displacements or modes (LocalSettings::Basis). The mesh covers
  /// the surface of a shell or the body of a solid.
  Part& deform_locally(LocalSettings settings);
  /// Multiplies the forces of all laws of the local deformation, and their damping by beta, by a function of
  /// time that is continuous and at least 0; 1 by default. The energy of the laws has this factor too, and a
  /// change of the factor does work of actuation. The part must deform locally.
  Part& scale_local(TimeFunction factor);
  /// Fixes the part: it does not move and has no coordinates.
  Part& fix();
  /// Prescribes the motion of the part, including the position and orientation at time 0. The part has no
  /// coordinates.
  Part& prescribe(PrescribedMotion motion);

  const std::string& name() const { return name_; }
  const Parameters& parameters() const { return parameters_; }
  const ShapeInterface& shape() const { return *shape_; }
  /// Whether the part has no coordinates because it is fixed or its motion is prescribed.
  bool fixed() const { return fixed_; }
  /// The prescribed motion; nullptr if there is none.
  const PrescribedMotion* motion() const { return motion_.get(); }
  bool shell() const { return shell_; }
  /// The density that the constructor got: kg/m^3 of a solid, kg/m^2 of a shell. mass() and inertia() do not
  /// change this value.
  double density() const { return density_; }
  /// The function that multiplies the density; nullptr if the density is the same everywhere.
  const MassDistribution* mass_distribution() const { return mass_distribution_.get(); }
  bool has_diagonal_mass() const { return diagonal_mass_; }
  double alpha() const { return alpha_; }
  double beta() const { return beta_; }
  double drag() const { return drag_; }
  /// The function of scale_local(); nullptr if the factor is 1.
  const TimeFunction* local_factor() const { return local_factor_.get(); }
  /// The frame at time 0: position (m, world), orientation (body to world), velocity (m/s, world) and angular
  /// velocity (rad/s, body frame).
  const Vec3<double>& c0() const { return c0_; }
  const Eigen::Quaterniond& R0() const { return R0_; }
  const Vec3<double>& c0_dot() const { return c0_dot_; }
  const Vec3<double>& omega0() const { return omega0_; }
  /// Number of dynamic global parameters q_s; 0 if fixed().
  int n_s() const { return fixed_ ? 0 : parameters_.n_dynamic(); }
  /// Whether the part is rigid: no parameter is dynamic, and there is no local deformation.
  bool rigid() const { return parameters_.n_dynamic() == 0 && !local_settings_; }
  /// Whether s is linear in q_s, so that J never changes: all dynamic parameters are lengths in which the
  /// shape is linear, and no link of the chain acts. False if no parameter is dynamic.
  bool linear() const;
  /// Throws std::invalid_argument if the part cannot have the elastic material that elasticity() set.
  /// prepare() calls this function too.
  void check_elasticity() const;

  /// A Model keeps a copy of this token while it uses the part. The part cannot be changed as long as copies
  /// exist.
  using Use = std::shared_ptr<const int>;
  const Use& use() const { return use_; }

 protected:
  PartDescription(std::string name, double density, std::unique_ptr<ShapeInterface> shape,
                  const std::vector<LinkInfo>& links);
  ~PartDescription() = default;

  /// Throws std::invalid_argument if the description contradicts itself. prepare() calls this function before
  /// it computes the constants.
  void check() const;
  /// Returns the Part of which this object is the base class.
  const Part& part() const;
  Part& part();
  /// Throws std::invalid_argument with the name of the part and the text `what`.
  [[noreturn]] void refuse(const std::string& what) const;

  // Settings that only prepare() needs.
  const std::optional<double>& given_mass() const { return total_mass_; }
  /// The next three functions return nullptr if the user did not set the value.
  const Inertia<double>* given_inertia() const { return given_inertia_.get(); }
  const LocalSettings* local_settings() const { return local_settings_.get(); }
  const ContinuumSettings* continuum_settings() const { return continuum_settings_.get(); }
  /// K_s over the dynamic parameters.
  MatX<double> dynamic_stiffness() const;
  /// Returns the bits of all settings on which the constants depend; equal keys give equal constants. Returns
  /// nullopt for a part that deforms locally or has a mass distribution: functions cannot be compared.
  /// update_parameters() must have run.
  std::optional<ConstantsKey> constants_key() const;

  /// Whether a setter ran since the constants were computed.
  bool changed() const { return changed_; }
  void set_unchanged() { changed_ = false; }
  /// Brings the lists of dynamic and frozen parameters up to date.
  void update_parameters() { parameters_.update(); }

 private:
  /// Throws std::logic_error while a Model uses the part.
  void require_unused() const;
  /// Marks the description as changed; every setter of a quantity on which the constants depend calls this
  /// function first. Throws std::logic_error while a Model uses the part.
  void change();
  /// Throws if the limits, the rest value or the initial value of a dynamic parameter are not admissible, or
  /// if the rest value of a frozen parameter changes in time.
  void check_parameter(const Parameter& p) const;
  /// Throws if the limits exceed the dynamic range of the parameter, see limits().
  void check_limits(const Parameter& p) const;
  /// Throws if the strain energy of the material is not defined while parameter number i changes.
  void check_elastic_parameter(int i) const;
  /// Returns the number of the named parameter. Throws if there is no parameter of this name.
  int require(const std::string& parameter) const;

  Use use_ = std::make_shared<const int>(0);
  std::string name_;
  std::unique_ptr<ShapeInterface> shape_;
  Parameters parameters_;
  double density_;
  std::optional<double> total_mass_;
  // Settings that few parts have are on the heap, so that a part without them is small.
  std::unique_ptr<const Inertia<double>> given_inertia_;
  std::unique_ptr<const MassDistribution> mass_distribution_;
  std::unique_ptr<const PrescribedMotion> motion_;
  std::unique_ptr<const LocalSettings> local_settings_;
  std::unique_ptr<const TimeFunction> local_factor_;
  std::unique_ptr<const ContinuumSettings> continuum_settings_;
  MatX<double> stiffness_;  // K_s over all parameters, including frozen parameters
  double alpha_ = 0, beta_ = 0, drag_ = 0;
  bool fixed_ = false, shell_ = false, diagonal_mass_ = false, changed_ = true;
  Vec3<double> c0_ = Vec3<double>::Zero(), c0_dot_ = Vec3<double>::Zero(), omega0_ = Vec3<double>::Zero();
  Eigen::Quaterniond R0_ = Eigen::Quaterniond::Identity();
};

}  // namespace pliant
