// The workspace of an evaluation: all quantities that are recomputed from (t, q, v), in the order of the
// stages that compute them. A workspace belongs to one model, and keeps constants of the model between
// evaluations. S is double, or Dual<1> for directional derivatives. include/pliant/body/README.md lists the
// sizes.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <pliant/body/constraint/constraints.h>
#include <pliant/body/constraint/rigid_island.h>
#include <pliant/body/model.h>

namespace pliant {

/// The quantities of one part.
template <class S>
struct PartWorkspace {
  // Stage 1, positions.
  Vec3<S> c;                                ///< position of the frame, m, world
  Mat3<S> R;                                ///< orientation of the frame, body to world
  VecX<S> q_s, q_s_dot;                     ///< dynamic global parameters and their rates, n_s each
  VecX<S> v_r;                              ///< (R^T c_dot, omega, q_s_dot), 6 + n_s
  std::unique_ptr<LocalWorkspace> local;    ///< nullptr unless the part deforms locally
  std::vector<PointJet<S>> ports;           ///< p, J and rates of each attachment point, body frame
  std::vector<Vec3<S>> port_x, port_x_dot;  ///< position (m) and velocity (m/s) of each, world
  // Stage 2, mass.
  /// M, (6 + n_s) x (6 + n_s), and g_q of Eq. (11). For a part that deforms locally, g_q is not computed, and
  /// M is n_x x n_x, the mass matrix of its velocities in a group. Stage 5 computes this M if a joint or a
  /// limit can push on the part. Stage 2 leaves inertia.M of a rigid part empty, see M().
  Inertia<S> inertia;
  const PartModel* rigid = nullptr;  ///< set for a rigid part, whose constants replace inertia.M and `factor`
  // Stage 3, forces.
  /// Sum of all generalised forces on v_r, body frame, 6 + n_s; for a part that deforms locally, without the
  /// forces of LocalDeformation::forces().
  VecX<S> f;
  Vec<S, kWorks> power;             ///< power (W) of the works of this part: damping, drag, actuation
  std::vector<Vec3<S>> port_force;  ///< force of the loads at each attachment point, N, world
  // Stage 5, accelerations. Stage 4 is in Workspace::joints.
  SymmetricFactor<S> factor;  ///< L D L^T of M
  VecX<S> a_r;                ///< (R^T c_ddot, omega_dot, q_s_ddot), then d_ddot at the part's joints, n_x
  /// Factor, s^2: M is increased by this factor times K_s while impulses act after an implicit step, see
  /// method/implicit/stiff_projection_metric.h.
  double stiffening = 0;
  /// For a part without joints: numbers of the dynamic parameters that a limit pushes. For parts in islands:
  /// ConstraintWorkspace::pushed.
  std::vector<int> pressed;
  Counters counters;  ///< numbers of quantities that were evaluated (part/counters.h)

  /// Returns M: RigidMass::inertia.M of a rigid part, else inertia.M.
  const MatX<S>& M() const {
    if constexpr (std::is_same_v<S, double>)
      if (rigid != nullptr) return rigid->rigid_mass->inertia.M;
    return inertia.M;
  }
  /// Returns M^-1 of a rigid part, with zeros for velocities without inertia; nullptr for other parts.
  const Eigen::Matrix<double, 6, 6>* rigid_mass_inverse() const {
    return rigid == nullptr ? nullptr : &rigid->rigid_mass->inverse;
  }
  /// Replaces x, n_x forces, by M^-1 x, with zeros for velocities without inertia.
  template <class Vector>
  void solve_mass(Vector&& x) const {
    if constexpr (std::is_same_v<S, double>) {
      if (local) {
        x = (local->A * x).eval();
        return;
      }
      if (const auto* inverse = rigid_mass_inverse()) {
        x = (*inverse * Eigen::Matrix<double, 6, 1>(x.template head<6>())).eval();
        return;
      }
    }
    factor.solve(x);
  }
  /// Whether velocity k of v_r has no inertia now; its acceleration is zero.
  bool without_inertia(int k) const {
    if (local) return local->without_inertia.test(static_cast<std::size_t>(k));
    return rigid != nullptr ? rigid->rigid_mass->factor.excluded(k) : factor.excluded(k);
  }
};

/// Returns the mass matrix of v_r of a part, (6 + n_s) x (6 + n_s). For a part that deforms locally, returns
/// the mass matrix without local displacements.
inline const MatX<double>& mass_matrix(const PartWorkspace<double>& w) {
  return w.local ? w.local->H0 : w.M();
}
inline const MatX<Dual<1>>& mass_matrix(const PartWorkspace<Dual<1>>& w) {
  return w.inertia.M;
}

/// The rows of a coordinate of a joint, which are evaluated when a load or sensor first reads them.
template <class S>
struct CoordinateWorkspace {
  bool known = false;  ///< whether `rows` belong to this evaluation
  JointRows<S> rows;   ///< C, C_dot and C_x; the bias is not valid
};

/// The quantities of all parts and joints.
template <class S>
struct Workspace {
  std::vector<PartWorkspace<S>> parts;
  std::vector<int> before_joints;             ///< numbers of the parts that are evaluated before any joint
  std::vector<std::uint8_t> without_inertia;  ///< of each part: 1 if one of its velocities has no inertia
  VecX<double> inputs;                        ///< State::inputs
  std::vector<CoordinateWorkspace<S>> coordinates;  ///< of joints: stage 3
  ConstraintWorkspace<S> joints;                    ///< stage 4
  GroupVectors<S, kMaxVelocities> alone;            ///< vectors of the part whose limits are being projected
  std::vector<RigidWorkspace> rigid;                ///< quantities of each rigid island
  VecX<S> v_dot;         ///< stage 5: c_ddot (world), omega_dot, q_s_ddot, q_d_ddot; n_v
  Vec<S, kWorks> power;  ///< stages 3 to 5: power of each kind of work, W
};

}  // namespace pliant
