// Rigid parts, free or on ball joints, as the stages of a method need them: their accelerations without the
// frames, points and rows that others read, and four parts at a time.
//
// With r from the centre of mass to a point that a joint holds, and I^-1 = L L^T about that centre in the
// body frame, a force f at point j of a part accelerates point i of it by
//   (1/m + B_i B_j^T) f,   B = R [r]x L,
// so that these 3 x 3 blocks make W_c = C_q M^-1 C_q^T of Eq. (14), and neither C_q nor M is formed.
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

/// What an evaluation leaves of a rigid island.
struct RigidWorkspace {
  /// Of four parts. Lanes without a part repeat the last one's.
  struct Four {
    Mat3<Pack> R;
    Vec3<Pack> omega;  ///< body frame
    Vec3<Pack> a;      ///< acceleration of the centre of mass, world
    Vec3<Pack> beta;   ///< L^-1 omega_dot
  };
  /// Of a point of each of four parts at which a joint holds.
  struct Arm {
    Mat3<Pack> B;
    Vec3<Pack> swing;  ///< R omega x (omega x r)
    Vec3<Pack> x;      ///< position, velocity or acceleration of the point, world
    Vec3<Pack> push;   ///< force of the joint, world
  };
  bool used = false;      ///< whether the last evaluation was by it
  bool prepared = false;  ///< whether what is constant of its parts is in their workspaces
  Counters counters;
  std::vector<Four> fours;
  std::vector<Arm> arms;
  std::vector<Mat3<Pack>> mobility;  ///< 1/m + B_i B_j^T, of the pairs i <= j of arms of four parts
  VecX<double> lambda;               ///< rows, then forces of the joints
  Eigen::Matrix<double, 7, Eigen::Dynamic> q_before;  ///< of the parts, before their joints are closed
  Eigen::Matrix<double, 6, Eigen::Dynamic> v_before;
};

class RigidIsland {
 public:
  /// Whether an island is that: parts that are rigid and without drag, on balls whose other ends move freely
  /// or stay where they are, solved by blocks.
  static bool takes(const Model& model, const Island& island);

  RigidIsland(const Model& model, const Island& island);

  /// The number of the island.
  int island() const { return island_; }

  /// v_dot of its parts at (q, v), with all its joints closed; the factor of W_c is left as
  /// Dynamics::accelerations leaves it. work: of its loaded parts f holds the loads, on v_r.
  void accelerate(const Model& model, const VecX<double>& q, const VecX<double>& v,
                  const Vec3<double>& gravity, RankRule rank, Workspace<double>& work,
                  RigidWorkspace& now) const;

  /// How wide a closed joint may be: |C| <= of_length (its length) + of_size |c|, |C_dot| the same with rate
  /// (its length) and |v|.
  struct Rounding {
    double of_length, of_size, rate;
  };
  /// Coordinates and velocities onto C = 0 and C_dot = 0, by the factor of W_c that the last evaluation left,
  /// or a new one where that takes fewer iterations. False, with both as they were, where neither takes them
  /// there fast.
  bool close(const Island& island, const Rounding& most, BlockFactor<double>& W_c, RigidWorkspace& now,
             VecX<double>& q, VecX<double>& v) const;

  /// Impulses at the place of the last evaluation, by the factor it left, that close the joints at the end of
  /// a step of h (s). q_end(): the coordinates there, with the velocities v as they are. False, with v as it
  /// was, where these do not close them fast.
  bool close_ahead(const Rounding& most, double h, const BlockFactor<double>& W_c, RigidWorkspace& now,
                   VecX<double>& v, const std::function<const VecX<double>&()>& q_end) const;

 private:
  struct Arm {
    Mat3<Pack> lever;  ///< [r]x L; 0 in lanes whose part has fewer arms
    Vec3<Pack> r;
  };
  struct Four {
    std::array<int, Pack::kLanes> q0, v0;  ///< of the parts, in q and v
    int count;                             ///< parts
    int first_arm, arms, first_pair;
    Pack inverse_mass;
    Mat3<Pack> inertia, L;  ///< about the centre of mass
    Vec3<Pack> centre;      ///< of mass
  };
  /// Where an arm of a part is, and its part in q and v; arm -1: not on a moving part.
  struct End {
    int arm = -1, lane = 0, q0 = 0, v0 = 0;
  };
  struct Tie {
    std::array<End, 2> ends;  ///< C = x_0 - x_1
    Vec3<double> fixed;       ///< what an end that is not on a moving part adds to C, m
    int row;
    double length;  ///< of the joint, m
  };
  /// What two arms of a part add to W_c.
  struct Coupling {
    int pair, lane;
    bool transposed;
    double sign;
    int target;  ///< offset of the block
  };
  struct Load {
    int part, four, lane;
  };

  void add_four(const Model& model, const Island& island, const std::vector<int>& order, std::size_t first,
                const std::vector<std::vector<int>>& joints_of, std::vector<std::array<End, 2>>& ends);
  void add_joints(const Model& model, const Island& island, const std::vector<std::array<End, 2>>& ends);

  /// act(end, its row, its sign in C) for each end on a part.
  template <class F>
  void for_each_end(F&& act) const {
    for (const Tie& tie : ties_) {
      if (tie.ends[0].arm >= 0) act(tie.ends[0], tie.row, 1.0);
      if (tie.ends[1].arm >= 0) act(tie.ends[1], tie.row, -1.0);
    }
  }
  void place(const Four& of, const VecX<double>& q, const VecX<double>& v, const Vec3<Pack>& gravity,
             RigidWorkspace& now, RigidWorkspace::Four& four) const;
  void add_loads(const Workspace<double>& work, RigidWorkspace& now) const;
  /// What forces at the arms of a part do to each other, from their levers.
  static void couple(const Four& of, RigidWorkspace& now);
  void factor(const Island& island, RankRule rank, const RigidWorkspace& now, BlockFactor<double>& W_c) const;
  /// The forces of the joints, and what they add to the accelerations.
  void hold(const BlockFactor<double>& W_c, RigidWorkspace& now) const;
  /// Forces into the arms that take the rows in now.lambda away.
  void take_forces(const BlockFactor<double>& W_c, RigidWorkspace& now) const;
  /// What these add to the acceleration of the centre of mass and to beta.
  std::pair<Vec3<Pack>, Vec3<Pack>> response(const Four& of, const RigidWorkspace& now) const;
  /// How wide the joints are, in what they may be, by positions of their points in the arms, of coordinates
  /// q, or by velocities, of v. Leaves the rows in now.lambda.
  double widest(const Rounding& most, bool positions, const VecX<double>& x, RigidWorkspace& now) const;
  /// Positions of the points in the arms, at q. turned: R and the levers too.
  template <bool turned>
  void place_arms(const VecX<double>& q, RigidWorkspace& now) const;
  /// Velocities of the points in the arms.
  void move_arms(const VecX<double>& v, RigidWorkspace& now) const;
  /// The responses to the forces in the arms, for a time (s), onto coordinates or velocities.
  void shift(const RigidWorkspace& now, VecX<double>& q) const;
  void push(const RigidWorkspace& now, double time, VecX<double>& v) const;
  /// act(k, where its coordinates begin in q, and its velocities in v) of each part.
  template <class F>
  void for_each_part(F&& act) const;

  int island_;
  std::vector<Four> fours_;
  std::vector<Arm> arms_;
  std::vector<Load> loads_;
  std::vector<Tie> ties_;
  std::vector<Coupling> couplings_;
  int parts_ = 0, pairs_ = 0, rows_ = 0;
};

}  // namespace pliant
