// The dynamics of all parts, read like sections 3 and 4 of the paper: positions -> mass -> forces -> limits
// -> accelerations. S is double, or Dual<1> for directional derivatives.
#pragma once

#include <string>
#include <vector>

#include <pliant/body/constraint/constraints.h>
#include <pliant/body/constraint/rigid_island.h>
#include <pliant/body/model.h>
#include <pliant/math/thread_pool.h>

namespace pliant {

/// What is recomputed at each evaluation, in the order of the stages. A workspace is for one model: what is
/// constant stays in it.
template <class S>
struct PartWorkspace {
  // positions
  Vec3<S> c;
  Mat3<S> R;
  VecX<S> q_s, q_s_dot, v_r;                ///< v_r = (R^T c_dot, omega, q_s_dot)
  std::unique_ptr<LocalWorkspace> local;    ///< of a part that deforms locally
  std::vector<PointJet<S>> ports;           ///< body frame
  std::vector<Vec3<S>> port_x, port_x_dot;  ///< world
  // mass
  Inertia<S> inertia;  ///< Eq. (11); of a part that deforms locally M is that of its velocities in a group
  // forces, body frame, on v_r
  VecX<S> f;
  Vec<S, kWorks> power;
  std::vector<Vec3<S>> port_force;  ///< world
  // limits and accelerations
  SymmetricFactor<S> factor;         ///< of M
  const PartModel* rigid = nullptr;  ///< instead of factor: a part whose M^-1 is constant
  VecX<S> a_r;                       ///< (R^T c_ddot, omega_dot, q_s_ddot), and the d_ddot at its joints
  double stiffening = 0;             ///< this times K of q_s is added to M: what pushes move is stiff
  std::vector<int> pressed;          ///< dynamic parameters that their limit holds back
  Counters counters;

  /// x = M^-1 x.
  template <class Vector>
  void solve_mass(Vector&& x) const {
    if constexpr (std::is_same_v<S, double>) {
      if (local) {
        x = (local->A * x).eval();
        return;
      }
      if (rigid != nullptr) {
        x = (rigid->rigid_inverse * Eigen::Matrix<double, 6, 1>(x.template head<6>())).eval();
        return;
      }
    }
    factor.solve(x);
  }
  /// Whether a velocity has no inertia right now, and is held.
  bool held(int k) const {
    if (local) return local->held.test(static_cast<std::size_t>(k));
    return rigid != nullptr ? rigid->rigid_factor.held(k) : factor.held(k);
  }
};

/// M over (c, theta, q_s) of a part.
inline const MatX<double>& mass_matrix(const PartWorkspace<double>& w) {
  return w.local ? w.local->H0 : w.inertia.M;
}
inline const MatX<Dual<1>>& mass_matrix(const PartWorkspace<Dual<1>>& w) {
  return w.inertia.M;
}

template <class S>
struct Workspace {
  std::vector<PartWorkspace<S>> parts;
  std::vector<int> one_by_one;     ///< parts that are evaluated before any joint
  std::vector<std::uint8_t> held;  ///< of each part, whether a velocity of it has no inertia, and is held
  ConstraintWorkspace<S> joints;
  GroupVectors<S, kMaxVelocities> alone;  ///< of a part alone that a limit pushes
  std::vector<RigidWorkspace> rigid;      ///< of each rigid island
  VecX<S> v_dot;                          ///< accelerations: c_ddot in the world, omega_dot, q_s_ddot
  Vec<S, kWorks> power;                   ///< rates of the works of the ledger, W
};

/// What a joint does to the part of its first side, world: a force (N) at its first point, and a torque (N m)
/// about that point.
struct Wrench {
  Vec3<double> force, torque;
};

/// A direction in the space of states: changes of q (of each quaternion its derivative) and of v.
struct StateDirection {
  VecX<double> q, v;
};

/// How the method of integration treats joints.
struct JointPolicy {
  bool step_consistent = true;  ///< whether the rule `automatic` takes gains that follow the step length
  bool projected = false;  ///< whether closed joints are projected after each step, without Baumgarte terms
  bool first_order =
      true;  ///< whether steps may be of first order, which leave a gap on closing joints that turn
};

class Dynamics {
 public:
  explicit Dynamics(const Model& model, ThreadPool* pool = nullptr) : model_(&model), pool_(pool) {}
  const Model& model() const { return *model_; }

  void set_joint_policy(const JointPolicy& policy) { joint_policy_ = policy; }
  const JointPolicy& joint_policy() const { return joint_policy_; }

  /// Accelerations and powers (none of parts that sleep) at (t, q, v), with the step and the modes of limits
  /// and joints of a state. Parameters that rest at a limit, with a rate of exactly 0, may only leave it;
  /// those that move there are the integrator's to stop.
  void accelerations(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
                     Workspace<double>& work, RankRule rank = RankRule::decide) const;
  /// work.v_dot and work.power of the same, for a stage of a method, and the factors of W_c. Parts that sleep
  /// have no rates, and are as they were in work. Rigid islands
  /// whose joints are closed leave no more: frames, velocities, points and accelerations of their parts, and
  /// rows and forces of their joints, are as they were or zero.
  void rates(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
             Workspace<double>& work, RankRule rank = RankRule::decide) const;
  /// Frames and points of the parts of an island, and its joints' C, C_dot and C_q, at (t, q, v); nothing
  /// else of work changes.
  void evaluate_joints(double t, const VecX<double>& q, const VecX<double>& v,
                       const std::vector<JointMode>& modes, const Island& island,
                       Workspace<double>& work) const;
  /// The same, with the mass matrices, M^-1 C_q^T and the factor of W_c.
  void factor_joints(double t, const VecX<double>& q, const VecX<double>& v,
                     const std::vector<JointMode>& modes, const Island& island, Workspace<double>& work,
                     RankRule rank = RankRule::decide) const;
  /// What a joint does to its first side; work as accelerations(t, ...) left it.
  Wrench joint_wrench(double t, int joint, const Workspace<double>& work) const {
    return joint_wrench(t, joint, work, work.joints.lambda);
  }
  /// The same of other forces, or impulses, of the rows of all joints; work as evaluate_joints left it.
  Wrench joint_wrench(double t, int joint, const Workspace<double>& work, const VecX<double>& lambda) const;
  /// Directional derivative of the accelerations at a state, the pressed limits staying as they are.
  VecX<double> jvp(const State& state, const StateDirection& along) const;
  /// The same without an evaluation of its own. work: as the evaluation at (t, q, v) left it; dual_work: any,
  /// kept from call to call.
  VecX<double> jvp(double t, const VecX<double>& q, const VecX<double>& v, const StateDirection& along,
                   const Workspace<double>& work, Workspace<Dual<1>>& dual_work) const;
  /// q_dot of (q, v): quaternion rate theta_dot = 1/2 theta o (0, omega).
  void coordinate_rates(const VecX<double>& q, const VecX<double>& v, VecX<double>& q_dot) const;
  /// Frames, points, mass matrices and their factors of some parts.
  void evaluate_masses(const VecX<double>& q, const VecX<double>& v, const std::vector<int>& parts,
                       Workspace<double>& work) const;
  /// Frame, points and mass matrix of a part, without its factor.
  void evaluate_frame(const VecX<double>& q, const VecX<double>& v, int part, Workspace<double>& work) const;
  /// Energy of some parts and of the springs at them, J. work: any.
  double energy(double t, const VecX<double>& q, const VecX<double>& v, const std::vector<int>& parts,
                Workspace<double>& work) const;
  /// Energies, works and momenta; balance is left to the caller.
  Ledger ledger(const State& state, Workspace<double>& work) const {
    return ledger(state.time(), state, work);
  }
  /// The same with the coordinates and velocities of the state taken at time t (s).
  Ledger ledger(double t, const State& state, Workspace<double>& work) const;
  /// The first term that is not finite in an evaluation at this state, in words; empty if all are finite.
  std::string diagnose(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
                       Workspace<double>& work) const;

 private:
  template <class S>
  void evaluate(double t, const VecX<S>& q, const VecX<S>& v, const State* modes,
                const Workspace<double>* fixed_modes, bool rates_only, Workspace<S>& work) const;
  /// Which rigid islands an evaluation in these modes uses (nullptr: none), and what is left to do.
  template <class S>
  void choose_rigid_islands(const State* modes, Workspace<S>& work) const;
  /// Adds the energies of a part that was evaluated, and of a spring.
  void add_energy(double t, const PartModel& part, const PartWorkspace<double>& work, Ledger& ledger) const;
  void add_energy(double t, const SpringModel& spring, const Workspace<double>& work, Ledger& ledger) const;
  /// Modes of the joints of an island, and frames and points of what moves as prescribed.
  void place_anchors(double t, const VecX<double>& q, const VecX<double>& v,
                     const std::vector<JointMode>& modes, const Island& island,
                     Workspace<double>& work) const;
  /// Gives the workspace of the joints its sizes.
  template <class S>
  void size_joints(Workspace<S>& work) const;
  template <class S>
  void join(double t, const State* modes, const State* sleepers, const Workspace<double>* fixed_modes,
            const PlacePart& evaluate_part, Workspace<S>& work) const;
  /// Whether the parts of an island are evaluated with its joints, each just before the first that asks for
  /// it: by one thread, and where no load has to know first where they all are.
  template <class S>
  bool with_joints(const Island& island, const Workspace<S>& work) const;

  const Model* model_;
  ThreadPool* pool_;
  JointPolicy joint_policy_;
};

}  // namespace pliant
