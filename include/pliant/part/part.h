// A part: a solid primitive with its global deformations, its mass and its elasticity. This class holds
// everything that does not depend on the type of the shape; Primitive<Shape, GlobalDeform> adds the kernels.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/part/continuum.h>
#include <pliant/part/inertia.h>
#include <pliant/part/linear_inertia.h>
#include <pliant/part/local/local_deformation.h>
#include <pliant/part/mesh/triangle_mesh.h>
#include <pliant/part/parameters.h>
#include <pliant/part/prescribed_motion.h>
#include <pliant/part/quadrature/mass_points.h>

namespace pliant {

/// How often the kernels of a part ran; tests and run.json show by them what a scene did not need.
struct Counters {
  long jacobian_points = 0;  ///< mass points whose J was evaluated
  long rate_points = 0;      ///< mass points whose Jdot qs_dot was evaluated
  long mass_matrices = 0;    ///< mass matrices summed
  long inertial_forces = 0;  ///< inertial forces g_q evaluated
  long point_jets = 0;       ///< material points evaluated for forces
  long surfaces = 0;         ///< surfaces evaluated for output
  long strain_points = 0;    ///< points of the body whose strain was evaluated
  Counters& operator+=(const Counters& o);
};

class Part {
 public:
  using Named = std::vector<std::pair<std::string, double>>;

  virtual ~Part() = default;
  Part(const Part&) = delete;
  Part& operator=(const Part&) = delete;

  // Building. Each throws std::invalid_argument naming part, parameter, value and what is allowed, and
  // std::logic_error while a Model runs the part.

  /// Position of the frame (m, world) and orientation (body to world; normalised).
  Part& place(const Vec3<double>& c, const Eigen::Quaterniond& R = Eigen::Quaterniond::Identity());
  /// Initial velocity of the frame (m/s, world) and angular velocity (rad/s, body frame).
  Part& velocity(const Vec3<double>& c_dot, const Vec3<double>& omega);
  /// Rest values: of frozen parameters their values.
  Part& rest(const Named& values);
  Part& rest(const std::string& parameter, TimeFunction of_time);
  /// Values and rates at time 0; the parameters become dynamic.
  Part& initial(const Named& values);
  Part& initial_rate(const Named& values);
  /// Diagonal of K_s (energy 1/2 K (q - rest)^2); the parameters become dynamic.
  Part& stiffness(const Named& values);
  /// Full symmetric K_s over the named parameters; they become dynamic.
  Part& stiffness(const std::vector<std::string>& parameters, const MatX<double>& K);
  /// One-sided limits of dynamic parameters; judged at the rest value when the part is prepared.
  Part& limits(const std::string& parameter, Range range);
  /// Elastic material: the strain energy of the whole map from rest to now, beside what stiffnesses there
  /// are. Of a part whose nodes deform locally the laws of these are that.
  Part& elasticity(ContinuumSettings settings);
  /// Throws std::invalid_argument when its elastic material cannot be that of the part, as prepare() does.
  void check_elasticity() const;
  Part& make_dynamic(const std::vector<std::string>& parameters);
  Part& freeze(const std::vector<std::string>& parameters);
  /// D = alpha M_ss + beta K_s on the global parameters, beta times the rate of strain in its material; drag
  /// nu M on all motion (1/s, s, 1/s).
  Part& damping(double alpha, double beta, double nu = 0);
  /// Mass on the surface only; the density is then per area (kg/m^2).
  Part& make_shell();
  /// Total mass (kg) instead of the density.
  Part& mass(double total);
  /// Inertia tensor about the frame's origin (kg m^2, body frame) and mass of a rigid part, instead of the
  /// density.
  Part& inertia(double mass, const Mat3<double>& about_origin,
                const Vec3<double>& centre = Vec3<double>::Zero());
  /// Its nodes deform locally: those of a surface mesh of a shell, of a mesh of the body of a solid.
  Part& deform_locally(LocalSettings settings);
  /// The part does not move and has no coordinates.
  Part& fix();
  /// Nor has one that moves as prescribed, which places it.
  Part& prescribe(PrescribedMotion motion);

  const std::string& name() const { return name_; }
  const Parameters& parameters() const { return parameters_; }
  const ShapeFace& shape() const { return *shape_; }
  /// Whether it has no coordinates: it does not move, or as prescribed.
  bool fixed() const { return fixed_; }
  /// nullptr of a part whose motion is not prescribed.
  const PrescribedMotion* motion() const { return motion_ ? &*motion_ : nullptr; }
  bool shell() const { return shell_; }
  double density() const { return density_; }
  double alpha() const { return alpha_; }
  double beta() const { return beta_; }
  double drag() const { return drag_; }
  const Vec3<double>& c0() const { return c0_; }
  const Eigen::Quaterniond& R0() const { return R0_; }
  const Vec3<double>& c0_dot() const { return c0_dot_; }
  const Vec3<double>& omega0() const { return omega0_; }
  int n_s() const { return fixed_ ? 0 : parameters_.n_dynamic(); }
  /// Local coordinates; valid after prepare().
  int n_d() const { return local_ ? static_cast<int>(local_->n_d()) : 0; }
  int n_v() const { return fixed_ ? 0 : 6 + n_s() + n_d(); }
  int n_q() const { return fixed_ ? 0 : 7 + n_s() + n_d(); }
  bool rigid() const { return parameters_.n_dynamic() == 0 && !local_settings_; }
  /// Whether s is linear in q_s, so that J never changes: all dynamic parameters are lengths in which the
  /// shape is linear, and no link acts.
  bool linear() const;

  /// Held by a Model for as long as it runs the part.
  using Use = std::shared_ptr<const int>;
  const Use& use() const { return use_; }

  // Prepared constants; valid after prepare().

  /// Lays the mass points and takes the constants of a rigid part; at once when nothing has changed since.
  /// Throws std::invalid_argument on a bad model; rest and initial values at which the part folds over make
  /// one.
  void prepare();
  bool prepared() const { return prepared_; }
  const MassPoints& mass_points() const { return mass_points_; }
  /// Stiffness K_s over the dynamic parameters.
  const MatX<double>& K_s() const { return K_s_; }
  /// The strain energy of its material; nullptr of a part that has none, or that nothing strains.
  const ContinuumEnergy* continuum() const { return continuum_.get(); }
  /// d2E/dq_s2 of its whole elastic energy at q_s.
  MatX<double> elastic_stiffness(const VecMax<double>& q_s) const;
  /// The part of it that material strains by themselves make, without their stress: never negative, and what
  /// beta multiplies.
  MatX<double> strain_stiffness(const VecMax<double>& q_s) const;
  double total_mass() const { return rest_inertia_.mass; }
  /// Inertia at rest; of a rigid part for ever.
  const Inertia<double>& rest_inertia() const { return rest_inertia_; }
  /// A length of the body at rest: its largest half extent, m.
  double size() const { return size_; }
  /// An entry of the diagonal of M below which a dynamic parameter has no inertia: rounding noise of a body
  /// of this mass and size.
  double inertia_floor(int k) const;
  /// The local deformation; nullptr of a part that has none.
  const LocalDeformation* local() const { return local_.get(); }

  // Evaluation. q_s, q_s_dot: the dynamic parameters and their rates; omega: body frame.

  /// Mass matrix and inertial forces, by the mass points.
  void inertia(const VecMax<double>& q_s, const VecMax<double>& q_s_dot, const Vec3<double>& omega,
               Inertia<double>& out, Counters& counters) const;
  void inertia(const VecMax<Dual<1>>& q_s, const VecMax<Dual<1>>& q_s_dot, const Vec3<Dual<1>>& omega,
               Inertia<Dual<1>>& out, Counters& counters) const;
  /// Of a rigid part g_q alone; the rest of out is as its inertia() left it.
  static void rigid_force(const Vec3<double>& omega, Inertia<double>& out, Counters& counters);
  /// Material points: position, J, rates, in the body frame.
  void points(const std::vector<Material<double>>& at, const VecMax<double>& q_s,
              const VecMax<double>& q_s_dot, std::vector<PointJet<double>>& out, Counters& counters) const;
  void points(const std::vector<Material<double>>& at, const VecMax<Dual<1>>& q_s,
              const VecMax<Dual<1>>& q_s_dot, std::vector<PointJet<Dual<1>>>& out, Counters& counters) const;

  /// Reference shape of material points, body frame: 3 x n.
  Eigen::Matrix3Xd s(const std::vector<Material<double>>& at, const ParameterValues<double>& values) const;
  /// Its derivative by the direction that the dual parts of the values carry: 3 x n.
  Eigen::Matrix3Xd s_along(const std::vector<Material<double>>& at,
                           const ParameterValues<Dual<1>>& values) const;
  /// dF: derivative of the chain of deformations at undeformed points e (3 x n), one 3x3 each.
  std::vector<Mat3<double>> chain_gradient(const Eigen::Matrix3Xd& e,
                                           const ParameterValues<double>& values) const;
  /// ds/d(u, v, w) at a material point, 3x3; infinite entries where the trigonometric map has them (eps < 1).
  Mat3<double> material_gradient(double u, double v, double w, const ParameterValues<double>& values) const;
  /// Inside-outside function at a body-frame point: w - 1 of the point, zero on the surface, negative inside;
  /// through the inverse deformations. And its gradient, 1/m; at the tip of a full taper its limit along z.
  double inside_outside(const Vec3<double>& p, const ParameterValues<double>& values) const;
  Vec3<double> inside_outside_gradient(const Vec3<double>& p, const ParameterValues<double>& values) const;
  /// Unit outward normal at a material point of the surface, body frame; where the deformation draws a
  /// section into one point (the tip of a full taper), its limit along z.
  Vec3<double> normal(const Material<double>& m, const ParameterValues<double>& values) const;
  std::vector<Vec3<double>> normals(const std::vector<Material<double>>& at,
                                    const ParameterValues<double>& values) const;
  /// Whether some of the surface is turned inside out at these values of the dynamic parameters.
  bool folded(const VecMax<double>& q_s) const;
  /// The material point at a body-frame point of the part at these values.
  Material<double> label(const Vec3<double>& p, const ParameterValues<double>& values) const;

  /// Jets of material points: position, J, rates, by level.
  virtual void jets(const ParameterValues<double>& values, const Material<Pack>* at,
                    JetBatch<Pack>& batch) const = 0;
  /// Their derivatives by the direction that the dual parts of the values and of the material points carry.
  virtual void jets(const ParameterValues<Dual<1>>& values, const Material<Dual<1, Pack>>* at,
                    JetBatch<Dual<1, Pack>>& batch) const = 0;
  /// By that of the values alone.
  void jets(const ParameterValues<Dual<1>>& values, const Material<Pack>* at,
            JetBatch<Dual<1, Pack>>& batch) const;

 protected:
  Part(std::string name, double density, std::unique_ptr<ShapeFace> shape,
       const std::vector<LinkInfo>& links);

  /// The chain alone: takes seeded jets through all links with every parameter held.
  virtual void deform(const ParameterValues<double>& values, JetBatch<Pack>& batch) const = 0;
  virtual Vec3<double> undeform(const Vec3<double>& p, const ParameterValues<double>& values) const = 0;

 private:
  template <class P>
  void moving_inertia(const VecMax<P>& q_s, const VecMax<P>& q_s_dot, const Vec3<P>& omega, Inertia<P>& out,
                      Counters& counters) const;
  /// The undeformed point that the chain takes to p.
  Vec3<double> preimage(const Vec3<double>& p, const ParameterValues<double>& values) const;
  /// Before every change: refuses while in use, and has prepare() do its work again.
  void change();
  /// Throws when limits are not within what the parameter allows at its rest value.
  void check_limits(const Parameter& p) const;
  int require(const std::string& parameter) const;
  [[noreturn]] void refuse(const std::string& what) const;

  Use use_ = std::make_shared<const int>(0);
  std::string name_;
  std::unique_ptr<ShapeFace> shape_;
  Parameters parameters_;
  double density_;
  std::optional<double> total_mass_;
  std::optional<Inertia<double>> given_inertia_;
  std::optional<PrescribedMotion> motion_;
  std::optional<LocalSettings> local_settings_;
  std::optional<ContinuumSettings> continuum_settings_;
  MatX<double> stiffness_;  // over all parameters
  double alpha_ = 0, beta_ = 0, drag_ = 0;
  bool fixed_ = false, shell_ = false, prepared_ = false;
  Vec3<double> c0_ = Vec3<double>::Zero(), c0_dot_ = Vec3<double>::Zero(), omega0_ = Vec3<double>::Zero();
  Eigen::Quaterniond R0_ = Eigen::Quaterniond::Identity();

  MassPoints mass_points_;
  std::optional<LinearInertia> linear_inertia_;
  MatX<double> K_s_;
  Inertia<double> rest_inertia_;
  double size_ = 0;
  std::unique_ptr<LocalDeformation> local_;
  std::unique_ptr<ContinuumEnergy> continuum_;
};

}  // namespace pliant
