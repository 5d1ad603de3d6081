// Rigid islands: rigid parts on ball joints. A method of integration needs only the accelerations of these
// parts. This file computes them for four parts at a time, without the frames, points and rows of the general
// evaluation.
//
// Let r be the vector from the centre of mass to the point of a joint, and let I^-1 = L L^T be the inverse
// inertia about the centre of mass, body frame. A force f at point j of a part accelerates point i of the
// part by
//   (1/m + B_i B_j^T) f,   B = R [r]x L,
// where m is the mass of the part, and 1/m stands for 1/m times the identity. The blocks of W_c = C_q M^-1
// C_q^T of Eq. (14) are sums of these 3 x 3 matrices with signs; neither C_q nor M is formed.
#pragma once

#include <array>
#include <functional>
#include <utility>
#include <vector>

#include <pliant/math/scalar/pack.h>
#include <pliant/math/types.h>
#include <pliant/part/part.h>
#include <pliant/solve/block_factor.h>

namespace pliant {

class Model;
struct Island;
struct PartModel;
template <class S>
struct Workspace;

/// The quantities of a rigid island at an evaluation.
struct RigidWorkspace {
  /// Four parts, one in each lane of a Pack, a vector of four numbers (math/scalar/pack.h). Lanes without a
  /// part repeat the last part.
  struct Four {
    Mat3<Pack> R;      ///< orientation, body to world
    Vec3<Pack> omega;  ///< angular velocity, rad/s, body frame
    Vec3<Pack> a;      ///< acceleration of the centre of mass, m/s^2, world
    Vec3<Pack> beta;   ///< L^-1 omega_dot
  };
  /// An arm: for each of four parts the point of one of its joints.
  struct Arm {
    Mat3<Pack> B;            ///< R [r]x L
    Vec3<Pack> centripetal;  ///< R (omega x (omega x r)), m/s^2
    Vec3<Pack> x;            ///< position, velocity or acceleration of the point, world
    Vec3<Pack> push;         ///< force of the joint, N, world
  };
  bool used = false;      ///< whether the last evaluation used the rigid island
  bool prepared = false;  ///< whether the workspaces of its parts refer to the constant masses of the parts
  Counters counters;      ///< numbers of quantities that were evaluated (part/counters.h)
  std::vector<Four> fours;
  std::vector<Arm> arms;
  std::vector<Mat3<Pack>> mobility;  ///< 1/m + B_i B_j^T of the pairs i <= j of arms of four parts
  VecX<double> lambda;  ///< C, C_dot or C_ddot of the joints; solve_forces() multiplies it by W_c^-1
  Eigen::Matrix<double, 7, Eigen::Dynamic> q_before;  ///< coordinates before the joints are closed
  Eigen::Matrix<double, 6, Eigen::Dynamic> v_before;  ///< velocities before the joints are closed
};

class RigidIsland {
 public:
  /// Returns whether an island can be evaluated as a rigid island. Its parts must be rigid, with inertia in
  /// all six velocities, without drag, without Part::use_diagonal_mass() and with at most kMaxArms joints
  /// each (rigid_island-inl.h). All its joints must be ball joints between two parts, or between a part and a
  /// fixed point. The joint system must be solved by the blocks of W_c, not by the augmented matrix.
  static bool applies_to(const Model& model, const Island& island);

  RigidIsland(const Model& model, const Island& island);

  /// Number of the island.
  int island() const { return island_; }

  /// Computes v_dot of the parts at (q, v) with all joints closed, and the factor of W_c, as
  /// Dynamics::accelerations() does. gravity: m/s^2, world. work.joints.rank: the rule for dependent rows of
  /// the factor. For a part with loads, work.parts[i].f must contain the generalised forces of the loads on
  /// v_r.
  void accelerate(const Model& model, const VecX<double>& q, const VecX<double>& v,
                  const Vec3<double>& gravity, Workspace<double>& work, RigidWorkspace& now) const;

  /// Returns the sum over the parts of mass times position of the centre of mass, kg m, world. q and
  /// now: of the last call of accelerate().
  Vec3<double> mass_moment(const VecX<double>& q, const RigidWorkspace& now) const;

  /// The gap that a closed joint may have: |C| <= per_length * length + per_size * |c|, and |C_dot| <=
  /// per_length * rate * length + per_size * |v|. length: JointModel::length; |c|, |v|: the largest entries
  /// of c, and of c_dot and of omega times the distance to the joint. per_length and per_size have no unit.
  /// rate (1/s) converts an allowed gap to an allowed rate of the gap.
  struct Rounding {
    double per_length, per_size, rate;
  };
  /// Projects coordinates and velocities onto C = 0 and C_dot = 0. Uses the factor of W_c of the last
  /// evaluation, or a new factor if it saves iterations. Returns false, with q and v unchanged, if the
  /// iteration converges slowly or is not finite.
  bool close(const Island& island, const Rounding& allowed, BlockFactor<double>& W_c, RigidWorkspace& now,
             VecX<double>& q, VecX<double>& v) const;

  /// Adds impulses to v that close the joints at the end of a step of length h (s). The impulses act at the
  /// configuration of the last evaluation and are found with its factor. q_end() returns the coordinates at
  /// the end of the step for the present v. Returns false, with v unchanged, if the iteration converges
  /// slowly or is not finite.
  bool close_ahead(const Rounding& allowed, double h, const BlockFactor<double>& W_c, RigidWorkspace& now,
                   VecX<double>& v, const std::function<const VecX<double>&()>& q_end) const;

 private:
  struct Arm {
    Mat3<Pack> lever;  ///< [r]x L; 0 in lanes whose part has fewer arms
    Vec3<Pack> r;      ///< from the centre of mass to the point, m, body frame
  };
  struct Four {
    std::array<int, Pack::kLanes> q0, v0;  ///< first entries of the parts in q and v
    int count;                             ///< number of parts
    int first_arm, arms, first_pair;  ///< first arm, number of arms; first pair in RigidWorkspace::mobility
    Pack inverse_mass;
    Mat3<Pack> inertia, L;  ///< inertia about the centre of mass, and L with inertia^-1 = L L^T
    Vec3<Pack> centre;      ///< centre of mass, m, body frame
  };
  /// The end of a joint: its arm and lane, and first entries of its part in q and v; arm -1: a fixed end.
  struct End {
    int arm = -1, lane = 0, q0 = 0, v0 = 0;
  };
  struct BallJoint {
    std::array<End, 2> ends;  ///< C = x_0 - x_1
    Vec3<double> fixed;       ///< contribution of a fixed end to C, m
    int row;                  ///< first row in the island
    double length;            ///< JointModel::length, m
  };
  /// The contribution of two arms of a part to W_c: sign * mobility[pair] of a lane, or its transpose.
  struct Coupling {
    int pair, lane;  ///< entry in RigidWorkspace::mobility, and lane of the part
    bool transposed;
    double sign;
    int target;  ///< offset of the block in the values of the factor of W_c
  };
  /// A part with loads: its number in the model, and its place in the Fours.
  struct Load {
    int part, four, lane;
  };

  void add_four(const Model& model, const Island& island, const std::vector<int>& order, std::size_t first,
                const std::vector<std::vector<int>>& joints_of, std::vector<std::array<End, 2>>& ends);
  void add_joints(const Model& model, const Island& island, const std::vector<std::array<End, 2>>& ends);

  /// Calls act(end, first row, sign in C) for each end that is on a part.
  template <class F>
  void for_each_end(F&& act) const {
    for (const BallJoint& joint : joints_) {
      if (joint.ends[0].arm >= 0) act(joint.ends[0], joint.row, 1.0);
      if (joint.ends[1].arm >= 0) act(joint.ends[1], joint.row, -1.0);
    }
  }
  /// Computes frames, free accelerations, arms and mobilities of four parts.
  void place(const Four& constants, const VecX<double>& q, const VecX<double>& v, const Vec3<Pack>& gravity,
             RigidWorkspace& now, RigidWorkspace::Four& four) const;
  /// Adds the accelerations that loads cause.
  void add_loads(const Workspace<double>& work, RigidWorkspace& now) const;
  /// Computes the mobilities of four parts from their arms.
  static void couple(const Four& constants, RigidWorkspace& now);
  /// Fills in and factors the blocks of W_c.
  void factor(const Island& island, RankRule rank, const RigidWorkspace& now, BlockFactor<double>& W_c) const;
  /// Computes the forces of the joints and adds their accelerations.
  void apply_joints(const BlockFactor<double>& W_c, RigidWorkspace& now) const;
  /// Replaces the rows in now.lambda by W_c^-1 times these rows, and computes the forces in the arms that
  /// cancel the rows.
  void solve_forces(const BlockFactor<double>& W_c, RigidWorkspace& now) const;
  /// Returns the changes of the acceleration of the centre of mass and of beta by the forces in the arms.
  std::pair<Vec3<Pack>, Vec3<Pack>> response(const Four& constants, const RigidWorkspace& now) const;
  /// Returns the largest |C| of the joints, divided by the allowed |C|, and stores C in now.lambda. The arms
  /// must contain the positions of the points of the joints, and x is q. If `positions` is false, the arms
  /// contain velocities, x is v, and C_dot takes the place of C.
  double largest_gap(const Rounding& allowed, bool positions, const VecX<double>& x,
                     RigidWorkspace& now) const;
  /// Computes the positions of the points in the arms at q; with_rotation: R and B too.
  template <bool with_rotation>
  void place_arms(const VecX<double>& q, RigidWorkspace& now) const;
  /// Computes the velocities of the points in the arms.
  void set_arm_velocities(const VecX<double>& v, RigidWorkspace& now) const;
  /// The forces in the arms cause a response, see response(). displace() adds it to the coordinates.
  /// change_velocities() adds `time` times the response to the velocities. Here `time` is a factor: 1 if the
  /// forces cancel rows in m/s, 1/h (1/s) if they cancel rows in m in a step of length h.
  void displace(const RigidWorkspace& now, VecX<double>& q) const;
  void change_velocities(const RigidWorkspace& now, double time, VecX<double>& v) const;
  /// Calls act(k, first entry in q, first entry in v) for each part.
  template <class F>
  void for_each_part(F&& act) const;

  int island_;
  std::vector<Four> fours_;
  std::vector<Arm> arms_;
  std::vector<Load> loads_;
  std::vector<BallJoint> joints_;
  std::vector<Coupling> couplings_;
  int parts_ = 0, pairs_ = 0, rows_ = 0;
};

}  // namespace pliant
