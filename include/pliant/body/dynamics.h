// The dynamics of all parts: accelerations from Eqs. (11)-(14), their derivatives, energies and momenta.
// dynamics-inl.h lists the stages of an evaluation in the order of sections 2 to 4 of the paper.
#pragma once

#include <string>
#include <vector>

#include <pliant/body/constraint/constraints.h>
#include <pliant/body/constraint/rigid_island.h>
#include <pliant/body/model.h>
#include <pliant/body/workspace.h>
#include <pliant/math/thread_pool.h>

namespace pliant {

template <class S>
struct Evaluation;

/// The action of a joint on its first side (a part, or the world): a force (N) at the first point of the
/// joint, and a torque (N m) about that point. Both are in the world frame.
struct Wrench {
  Vec3<double> force, torque;
};

/// A direction in the space of states: the derivatives of all entries of q, quaternions included, and of v.
struct StateDirection {
  VecX<double> q, v;
};

/// How a method of integration treats joints.
struct JointPolicy {
  /// Whether BaumgarteRule::automatic chooses gains that depend on the step length.
  bool step_consistent = true;
  /// Whether closed joints are projected after each step. Closed joints then have no Baumgarte terms.
  bool projected = false;
  /// Whether steps may be of first order. Baumgarte's terms then do not close the gap of a rotating joint
  /// completely. The joint becomes closed with the small gap that remains (close_joints() in
  /// project/project_joints-inl.h).
  bool first_order = true;
};

class Dynamics {
 public:
  /// pool: threads for the parts and islands of an evaluation; nullptr: the calling thread alone.
  explicit Dynamics(const Model& model, ThreadPool* pool = nullptr) : model_(&model), pool_(pool) {}
  const Model& model() const { return *model_; }
  ThreadPool* pool() const { return pool_; }

  void set_joint_policy(const JointPolicy& policy) { joint_policy_ = policy; }
  const JointPolicy& joint_policy() const { return joint_policy_; }

  // The time t (s), q, v and the modes are separate arguments, because the stages of a method of integration
  // evaluate at coordinates and velocities that belong to no State.

  /// Computes work.v_dot and work.power at (t, q, v), and all other fields of work except the fields of rigid
  /// islands. modes: the step length, the modes of limits and joints, and the sleeping parts, whose
  /// accelerations and powers are zero. rank: the rule that decides which rows of joints are dependent
  /// (solve/pivots.h). A parameter at a limit with a rate of exactly 0 can only move into its range. A
  /// parameter at a limit with another rate is free here: the method of integration has to stop it.
  void accelerations(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
                     Workspace<double>& work, RankRule rank = RankRule::decide) const;
  /// Computes work.v_dot, work.power and the factors of W_c = C_q M^-1 C_q^T, which is enough for a stage of
  /// a method. Other fields of work may be out of date. Sleeping parts are skipped unless loads act on them
  /// or on their island. If all joints of a rigid island are closed and projected, the fields of its parts
  /// and joints keep values of earlier calls, or zeros.
  void rates(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
             Workspace<double>& work, RankRule rank = RankRule::decide) const;
  /// Computes frames and attachment points of the parts of an island, and C, C_dot, bias (constraints.h) and
  /// C_q of its joints, at (t, q, v). Also sets the modes of these joints, and sets port_force of parts with
  /// loads to zero. No other field of work changes.
  void evaluate_joints(double t, const VecX<double>& q, const VecX<double>& v,
                       const std::vector<JointMode>& modes, const Island& island,
                       Workspace<double>& work) const;
  /// Does evaluate_joints(), and computes the mass matrices, their factors, M^-1 C_q^T and the factors of
  /// W_c.
  void factor_joints(double t, const VecX<double>& q, const VecX<double>& v,
                     const std::vector<JointMode>& modes, const Island& island, Workspace<double>& work,
                     RankRule rank = RankRule::decide) const;
  /// Returns the action of a joint on its first side. work: as accelerations(t, ...) left it.
  Wrench joint_wrench(double t, int joint, const Workspace<double>& work) const {
    return joint_wrench(t, joint, work, work.joints.lambda);
  }
  /// Returns the action of a joint for given lambda. lambda: forces (N) of the rows of all joints, or
  /// impulses (N s), for which the result is an impulse too. work: as evaluate_joints() left it.
  Wrench joint_wrench(double t, int joint, const Workspace<double>& work, const VecX<double>& lambda) const;
  /// Returns the derivative of v_dot (n_v entries) at a state in a direction. The modes of joints, the set of
  /// parameters that limits push and the set of strings that pull are constant in this derivative. Throws
  /// std::logic_error if a part deforms locally.
  VecX<double> jvp(const State& state, const StateDirection& along) const;
  /// Returns this derivative of v_dot from an existing evaluation. work: as accelerations(t, q, v, ...) left
  /// it; dual_work: scratch storage, kept from call to call; its contents are ignored.
  VecX<double> jvp(double t, const VecX<double>& q, const VecX<double>& v, const StateDirection& along,
                   const Workspace<double>& work, Workspace<Dual<1>>& dual_work) const;
  /// Computes q_dot from (q, v): theta_dot = 1/2 theta o (0, omega) for each quaternion, where o is the
  /// product of quaternions. The rates of all other coordinates are their velocities.
  void coordinate_rates(const VecX<double>& q, const VecX<double>& v, VecX<double>& q_dot) const;
  /// Computes frames, attachment points, mass matrices and factors of the mass matrices of some parts at time
  /// t (s). parts: numbers of parts that have coordinates.
  void evaluate_masses(double t, const VecX<double>& q, const VecX<double>& v, const std::vector<int>& parts,
                       Workspace<double>& work) const;
  /// Computes frame, attachment points and mass matrix of a part at time t (s), without the factor of the
  /// mass matrix. The part must have coordinates.
  void evaluate_frame(double t, const VecX<double>& q, const VecX<double>& v, int part,
                      Workspace<double>& work) const;
  /// Returns the kinetic and potential energy of some parts, and of all springs and drives that act on one of
  /// these parts, J. parts: numbers of parts that have coordinates. work: scratch storage; its contents are
  /// ignored.
  double energy(double t, const VecX<double>& q, const VecX<double>& v, const std::vector<int>& parts,
                Workspace<double>& work) const;
  /// Returns energies, works and momenta of a state. Ledger::balance is zero; the caller sets it. work
  /// receives an evaluation of the accelerations.
  Ledger ledger(const State& state, Workspace<double>& work) const {
    return ledger(state.time(), state, work);
  }
  /// Returns the ledger of the coordinates and velocities of a state at time t (s).
  Ledger ledger(double t, const State& state, Workspace<double>& work) const;
  /// Returns the values of the sensors of the model. work: as accelerations(t, ...) or ledger(t, ...) left
  /// it.
  VecX<double> sensor_values(double t, const State& state, Workspace<double>& work) const;
  /// Evaluates the accelerations and returns the name of the first term that is not finite, in the order of
  /// the evaluation; an empty text if all terms are finite. If an entry of q or v is not finite, returns the
  /// name of the first of these entries, without an evaluation.
  std::string diagnose(double t, const VecX<double>& q, const VecX<double>& v, const State& modes,
                       Workspace<double>& work) const;

 private:
  /// The stages of one evaluation, see dynamics-inl.h.
  template <class S>
  void evaluate(const Evaluation<S>& e) const;
  /// Adds the energies of an evaluated part, of a spring or of a drive to the ledger.
  void add_energy(double t, const PartModel& part, const PartWorkspace<double>& work, Ledger& ledger) const;
  void add_energy(double t, const SpringModel& spring, const Workspace<double>& work, Ledger& ledger) const;
  void add_energy(const DriveModel& drive, const Evaluation<double>& e, Ledger& ledger) const;
  /// Sets the modes of the joints of an island, and computes frames and attachment points of its parts that
  /// are fixed or have a prescribed motion.
  void place_anchors(double t, const VecX<double>& q, const VecX<double>& v,
                     const std::vector<JointMode>& modes, const Island& island,
                     Workspace<double>& work) const;

  const Model* model_;
  ThreadPool* pool_;
  JointPolicy joint_policy_;
};

}  // namespace pliant
