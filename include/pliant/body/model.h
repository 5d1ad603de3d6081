// Model: a MultiBody made ready to run: constants only, in flat arrays. Every function of the dynamics takes
// it const.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include <pliant/body/constraint/rigid_island.h>
#include <pliant/body/ledger.h>
#include <pliant/body/multibody.h>
#include <pliant/body/state.h>
#include <pliant/solve/block_pattern.h>
#include <pliant/solve/symmetric_factor.h>

namespace pliant {

/// A part's place in the flat vectors, its attachment points, its constants.
struct PartModel {
  // What every stage reads comes first, and lies close together.
  const Part* part;
  int q0, v0;  ///< first entries in q and v; -1 for a part that is fixed or moves as prescribed
  int n_s;
  int island = -1;                            ///< of the parts that joints tie together; -1 for a part alone
  int rigid_island = -1;                      ///< likewise of those that are rigid_island.h's; -1: none
  int limit0;                                 ///< first entry in State::at_limit
  bool loaded = false;                        ///< whether springs, forces or torques act on it
  bool actuated = false;                      ///< whether a rest value of a dynamic parameter changes in time
  const LocalDeformation* local;              ///< nullptr of a part that has none
  const PrescribedMotion* motion;             ///< likewise
  std::vector<NodeWeights> shared;            ///< of one that deforms locally: its joints' points, each once
  std::vector<Material<double>> ports;        ///< material points that forces act on
  double drag;                                ///< nu, 1/s
  VecX<double> rest;                          ///< rest values of the dynamic parameters, at time 0
  VecX<double> inertia_floor;                 ///< see SymmetricFactor
  std::vector<Range> limits;                  ///< of each dynamic parameter
  std::vector<PointJet<double>> rigid_ports;  ///< constants of the ports of a rigid part
  Eigen::Matrix<double, 6, 6> rigid_inverse;  ///< M^-1 of a rigid part
  SymmetricFactor<double> rigid_factor;       ///< likewise
  std::vector<NodeWeights> node_weights;      ///< of each port of a part that deforms locally
  std::vector<int> port_place;                ///< of each of them among `shared`; -1: no joint is there
  Eigen::Matrix3d R0;                         ///< of a fixed part
  Part::Use use;                              ///< keeps the part from being changed

  /// Rest values of the dynamic parameters at time t (s).
  VecMax<double> rest_at(double t) const {
    VecMax<double> values = rest;
    for (int k = 0; k < n_s && actuated; ++k) values[k] = part->parameters().moving(k).rest.value(t);
    return values;
  }
  int n_d() const { return local == nullptr ? 0 : static_cast<int>(local->n_d()); }
  int n_q() const { return 7 + n_s + n_d(); }  ///< coordinates in q
  int n_v() const { return 6 + n_s + n_d(); }  ///< velocities in v
  /// Velocities by which other parts know it (group.h): v_r, and the local ones at its joints.
  int n_x() const { return 6 + n_s + 3 * static_cast<int>(shared.size()); }
};

/// Where an attachment is: a port of a part, or the world.
struct PortRef {
  int part = -1;  ///< -1: the world
  int port = -1;
};

struct SpringModel {
  const Spring* spring;
  PortRef a, b;
};
struct ForceModel {
  const PointForce* force;
  PortRef at;
};
struct TorqueModel {
  const Torque* torque;
  int part;
  int against;  ///< -1: nothing
};

/// A side of a joint that is on a moving part. A joint whose sides are on the same part has one.
struct JointSide {
  int part;
  int place;   ///< of the part in its island
  int offset;  ///< of its C_q^T and M^-1 C_q^T, n_v x rows, in the flat arrays of the workspace
};
struct JointModel {
  const Joint* joint;
  int rows;
  int row;                  ///< first of its rows among those of all joints
  std::vector<PortRef> at;  ///< of each of its points
  std::vector<JointSide> sides;
  int island, node;  ///< its node in the system of its island
  int island_row;    ///< first of its rows there
  double length;     ///< size of the smaller of its parts, m
  bool driven;       ///< whether a point of it moves as prescribed
  /// Of a joint between points of one part: where C_q^T and M^-1 C_q^T of its first side alone are; else -1.
  int first_offset = -1;
};

/// What two sides of joints that share a part add to W_c = C_q M^-1 C_q^T: the block of (row side, column
/// side).
struct Coupling {
  int part;
  int row_offset, column_offset;  ///< of the sides in the flat arrays
  int rows, columns;
  int row_joint, column_joint;
  int target;  ///< offset of the block

  int later_joint() const { return std::max(row_joint, column_joint); }
};

/// Parts that joints tie together, and the system of their joints.
struct Island {
  std::vector<int> parts;
  std::vector<int> anchors;  ///< parts without coordinates that its joints hold on to
  std::vector<int> joints;   ///< those that are equations
  std::vector<int> strings;  ///< those that are one-sided
  bool loaded = false;       ///< whether springs, forces or torques act on any of its parts
  std::vector<int> first;    ///< where each part begins in the vector of the island's velocities
  int n_v = 0;               ///< length of that vector
  int rows = 0;              ///< of joints
  int rigid = -1;            ///< its number among the rigid islands; -1: it is none
  bool augmented = false;    ///< solved as the augmented matrix, not by blocks
  bool uneven = false;   ///< parts so light among heavy ones that what is left of forces on them is refined
  BlockPattern pattern;  ///< of the blocks of W_c, when they are used
  std::vector<Coupling> couplings;  ///< in the order of their later joints
  long numbers = 0;                 ///< in the factor
};

class Model {
 public:
  /// Prepares all parts. Throws std::invalid_argument naming what is wrong. The body must outlive the model.
  explicit Model(MultiBody& body);

  const MultiBody& body() const { return *body_; }
  const std::vector<PartModel>& parts() const { return parts_; }
  const std::vector<SpringModel>& springs() const { return springs_; }
  const std::vector<ForceModel>& forces() const { return forces_; }
  const std::vector<TorqueModel>& torques() const { return torques_; }
  /// Parts that springs, forces or torques act on.
  const std::vector<int>& loaded_parts() const { return loaded_parts_; }
  const std::vector<JointModel>& joints() const { return joints_; }
  const std::vector<Island>& islands() const { return islands_; }
  /// Of the islands that are rigid parts on ball joints.
  const std::vector<RigidIsland>& rigid_islands() const { return rigid_islands_; }
  /// Parts that are in no island.
  const std::vector<int>& lone_parts() const { return lone_parts_; }
  /// Times after 0 at which joints, planes and obstacles begin or cease to act, in order, s.
  const std::vector<double>& switch_times() const { return switch_times_; }
  /// Joints that have an end that is moved as prescribed.
  const std::vector<int>& driven_joints() const { return driven_joints_; }
  /// The first time, later than one and no later than another (s), at which the rate at which an end of a
  /// joint is moved jumps while the joint acts; of all joints, or of one.
  Kink next_kink(double after, double until) const;
  Kink next_kink(const JointModel& joint, double after, double until) const;
  int n_rows() const { return n_rows_; }          ///< of all joints
  int n_side_values() const { return n_sides_; }  ///< numbers in C_q^T of all joints
  int n_q() const { return n_q_; }
  int n_v() const { return n_v_; }
  int n_limits() const { return n_limits_; }
  /// Parts whose rest is told in a state (State::at_rest): all where bodies may sleep, else none.
  std::size_t n_resting() const { return body_->contact.active && body_->contact.sleep ? parts_.size() : 0; }

  /// The state at time 0.
  State initial_state() const;
  /// Parameters are at their limits, or not, as their values say.
  void note_limits(State& state) const;
  /// All parameters of a part in a state.
  ParameterValues<double> values(const State& state, int part) const;
  Vec3<double> position(const State& state, int part) const { return position(state, part, state.time()); }
  Eigen::Quaterniond orientation(const State& state, int part) const {
    return orientation(state, part, state.time());
  }
  /// The same with the coordinates of the state taken at time t (s).
  Vec3<double> position(const State& state, int part, double t) const;
  Eigen::Quaterniond orientation(const State& state, int part, double t) const;
  /// A point of a part in the world. Asked for again and again it is found faster by its weights among the
  /// nodes, or as a PlacedPoint.
  Vec3<double> world_point(const State& state, int part, const Material<double>& m) const;
  Vec3<double> world_point(const State& state, int part, const Material<double>& m,
                           const NodeWeights& at) const;
  /// Where a point is among the nodes of its part, with its patch; none of a part that does not deform
  /// locally.
  static NodeWeights node_weights(const Point& point);
  /// Positions of the nodes of the mesh of a part that deforms locally, body frame, m.
  Nodes node_positions(const State& state, int part) const;
  /// Whether a part neither moves nor is moved: it is fixed, or sleeps.
  bool lies_still(const State& state, int part) const {
    const PartModel& m = parts_[static_cast<std::size_t>(part)];
    return m.q0 < 0 ? m.motion == nullptr : sleeps(state, part);
  }
  /// How far a joint is open in a state, m: |C|, of a one-sided one the part below zero.
  double gap(const State& state, int joint) const;
  /// "upper.c.x", "upper.bend.angle": the name of an entry of v (or of q, where they differ).
  std::string velocity_name(int i) const;
  std::string coordinate_name(int i) const;

 private:
  /// what: the spring or force that acts there, for messages.
  PortRef attach(const Point& point, const std::string& what);
  void add_joint(const Joint& joint);
  void lay_sides();
  void make_islands();
  void note_loaded_parts();
  void make_rigid_islands();
  /// A joint and which of its sides is on a part.
  using SidesOfParts = std::vector<std::vector<std::pair<int, int>>>;
  void choose_solver(Island& island, const SidesOfParts& sides_of);
  void lay_couplings(Island& island, const SidesOfParts& sides_of);

  const MultiBody* body_;
  std::vector<PartModel> parts_;
  std::vector<SpringModel> springs_;
  std::vector<ForceModel> forces_;
  std::vector<TorqueModel> torques_;
  std::vector<int> loaded_parts_, lone_parts_, driven_joints_;
  std::vector<JointModel> joints_;
  std::vector<Island> islands_;
  std::vector<double> switch_times_;
  std::vector<RigidIsland> rigid_islands_;
  int n_q_ = 0, n_v_ = 0, n_limits_ = 0, n_rows_ = 0, n_sides_ = 0;
};

}  // namespace pliant
