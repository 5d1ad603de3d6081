// The evaluation of a part at given values of its parameters: the reference shape s, Eq. (3), its derivatives
// J = ds/dq_s, Eq. (9), and Jdot qs_dot, normals, the material point at a position, and the mass matrix M and
// the inertial forces g_q of Eq. (11). Part (part.h) derives from PartEvaluation. The function bodies are in
// part_evaluation-inl.h (geometry) and inertia-inl.h (M and g_q).
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include <pliant/deform/jet.h>
#include <pliant/part/counters.h>
#include <pliant/part/part_constants.h>
#include <pliant/part/part_description.h>

namespace pliant {

class PartEvaluation : public PartDescription {
 public:
  virtual ~PartEvaluation() = default;

  // Dynamics. q_s and q_s_dot are the dynamic parameters and their rates; the angular velocity omega (rad/s)
  // is in the body frame. The overloads for Dual<1> also compute the derivatives along the direction of the
  // dual parts of the arguments.

  /// Computes the mass matrix and the inertial forces, Eq. (11), over (c, omega, q_s) without local
  /// deformation (d = 0). M of a rigid part is constant. If s is linear in q_s, moments replace the sums over
  /// the mass points. Valid after Part::prepare().
  void evaluate_inertia(const VecMax<double>& q_s, const VecMax<double>& q_s_dot, const Vec3<double>& omega,
                        Inertia<double>& out, Counters& counters) const;
  void evaluate_inertia(const VecMax<Dual<1>>& q_s, const VecMax<Dual<1>>& q_s_dot,
                        const Vec3<Dual<1>>& omega, Inertia<Dual<1>>& out, Counters& counters) const;
  /// Computes g_q of a rigid part. constant: M and the first moment of this part (Part::rest_inertia()).
  static void rigid_force(const Inertia<double>& constant, const Vec3<double>& omega, VecX<double>& g_q,
                          Counters& counters);
  /// Computes position, J, J q_s_dot and Jdot q_s_dot of material points in the body frame, without local
  /// deformation. out: one PointJet for each point.
  void points(const std::vector<Material<double>>& at, const VecMax<double>& q_s,
              const VecMax<double>& q_s_dot, std::vector<PointJet<double>>& out, Counters& counters) const;
  void points(const std::vector<Material<double>>& at, const VecMax<Dual<1>>& q_s,
              const VecMax<Dual<1>>& q_s_dot, std::vector<PointJet<Dual<1>>>& out, Counters& counters) const;

  // Geometry, in the body frame. values: all parameters, including frozen parameters.

  /// Returns the reference shape s of n material points, m: 3 x n.
  Eigen::Matrix3Xd s(const std::vector<Material<double>>& at, const ParameterValues<double>& values) const;
  /// Returns the derivatives of s of n material points along the direction of the dual parts of the values:
  /// 3 x n.
  Eigen::Matrix3Xd s_along(const std::vector<Material<double>>& at,
                           const ParameterValues<Dual<1>>& values) const;
  /// Images of four undeformed positions under the chain of deformations T.
  struct ChainImages {
    Eigen::Matrix<double, 3, 4> x;  ///< T(e), one column for each position, m
    std::array<Mat3<double>, 4> F;  ///< dT/de at each position
  };
  /// Computes the images of four undeformed positions e (columns, m).
  void apply_chain(const Eigen::Matrix<double, 3, 4>& e, const ParameterValues<double>& values,
                   ChainImages& images) const;
  /// Returns the derivative dT/de of the chain of deformations T at n undeformed positions e (3 x n, m): one
  /// 3 x 3 matrix for each position.
  std::vector<Mat3<double>> chain_gradient(const Eigen::Matrix3Xd& e,
                                           const ParameterValues<double>& values) const;
  /// Returns ds/d(u, v, w) at a material point, 3 x 3. Entries are infinite where the derivatives of the
  /// trigonometric map are infinite (exponents below 1).
  Mat3<double> material_gradient(double u, double v, double w, const ParameterValues<double>& values) const;
  /// Returns the inside-outside function at a position p (m, body frame): w - 1, where w is the radial
  /// coordinate of the material point at p. The value is 0 on the surface, negative inside and positive
  /// outside.
  double inside_outside(const Vec3<double>& p, const ParameterValues<double>& values) const;
  /// Returns the gradient of the inside-outside function at a position p, 1/m. At the tip of a full taper the
  /// result is the limit along z.
  Vec3<double> inside_outside_gradient(const Vec3<double>& p, const ParameterValues<double>& values) const;
  /// Returns the unit outward normal at a material point of the surface. Where the deformation maps a whole
  /// section to one point (the tip of a full taper), the result is the limit along z.
  Vec3<double> normal(const Material<double>& m, const ParameterValues<double>& values) const;
  /// Returns normal() of each material point.
  std::vector<Vec3<double>> normals(const std::vector<Material<double>>& at,
                                    const ParameterValues<double>& values) const;
  /// Returns whether a piece of the surface is turned inside out at these values of the dynamic parameters;
  /// see folds() in mesh/folds.h.
  bool is_inverted(const VecMax<double>& q_s) const;
  /// Returns the material point at the position p (m, body frame).
  Material<double> label(const Vec3<double>& p, const ParameterValues<double>& values) const;

  // The kernels, for batches of material points. Primitive implements these functions.

  /// Computes s of batch.count packs of material points and, if batch.level requires them, J, J q_s_dot and
  /// Jdot q_s_dot (deform/jet.h).
  virtual void jets(const ParameterValues<double>& values, const Material<Pack>* at,
                    JetBatch<Pack>& batch) const = 0;
  /// Computes the jets of jets() above with their derivatives along the dual parts of the values and of the
  /// material points.
  virtual void jets(const ParameterValues<Dual<1>>& values, const Material<Dual<1, Pack>>* at,
                    JetBatch<Dual<1, Pack>>& batch) const = 0;
  /// Computes the jets with their derivatives along the dual parts of the values; the material points are
  /// constant.
  void jets(const ParameterValues<Dual<1>>& values, const Material<Pack>* at,
            JetBatch<Dual<1, Pack>>& batch) const;

 protected:
  using PartDescription::PartDescription;

  /// Applies the chain of deformations to jets that contain undeformed positions s and columns J. All
  /// parameters are constants here.
  virtual void deform(const ParameterValues<double>& values, JetBatch<Pack>& batch) const = 0;
  /// Returns the position that the chain maps to p (m, body frame).
  virtual Vec3<double> inverse_chain(const Vec3<double>& p, const ParameterValues<double>& values) const = 0;

  /// The constants of the part; before Part::prepare() a PartConstants without data.
  std::shared_ptr<const PartConstants> constants_ = no_constants();

 private:
  template <class P>
  void evaluate_inertia_of(const VecMax<P>& q_s, const VecMax<P>& q_s_dot, const Vec3<P>& omega,
                           Inertia<P>& out, Counters& counters) const;
  /// Returns the constants of parts that are not prepared.
  static const std::shared_ptr<const PartConstants>& no_constants();
  /// Returns the undeformed position that the chain maps to p; at a tip the pole of the shape.
  Vec3<double> undeformed_point(const Vec3<double>& p, const ParameterValues<double>& values) const;
};

}  // namespace pliant
