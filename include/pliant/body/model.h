// Model: a MultiBody that is prepared for a run. A model contains constants only, in flat arrays; the
// functions of the dynamics do not change the model.
#pragma once

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <unordered_map>
#include <utility>
#include <vector>

#include <pliant/body/constraint/rigid_island.h>
#include <pliant/body/ledger.h>
#include <pliant/body/multibody.h>
#include <pliant/body/state.h>
#include <pliant/math/disjoint_sets.h>
#include <pliant/solve/block_pattern.h>
#include <pliant/solve/symmetric_factor.h>

namespace pliant {

/// The constant mass matrix of a rigid part. Parts that share their constants (part/constants_cache.h) also
/// share this object, which then stays in the processor's cache.
struct RigidMass {
  /// constant: M (6 x 6), first moment and mass. floor: see SymmetricFactor. diagonal: whether factor and
  /// inverse are computed from the diagonal of M only (Part::use_diagonal_mass).
  RigidMass(const Inertia<double>& constant, const VecX<double>& floor, bool diagonal);

  Inertia<double> inertia;              ///< M, first moment and mass
  SymmetricFactor<double> factor;       ///< of M
  Eigen::Matrix<double, 6, 6> inverse;  ///< M^-1, with zeros for velocities without inertia
};

/// The entries of a part in the flat vectors q and v, its attachment points, and its constants.
struct PartModel {
  // Fields that every stage reads come first, close together in memory.
  const Part* part;
  int q0, v0;       ///< first entries in q and v; -1 for a part that is fixed or has a prescribed motion
  double size;      ///< Part::size(): largest half extent at rest, m
  int n_s;          ///< number of dynamic global parameters
  int island = -1;  ///< number of the part's island; -1: no joints or no coordinates
  int rigid_island = -1;          ///< number of the part's rigid island (constraint/rigid_island.h); -1: none
  int limit0;                     ///< first entry in State::at_limit
  bool loaded = false;            ///< whether loads act on the part, or read its state
  bool actuated = false;          ///< whether a rest value of a dynamic parameter changes in time
  const LocalDeformation* local;  ///< nullptr for a part without local deformation
  const PrescribedMotion* motion;  ///< nullptr for a part without prescribed motion
  /// For a part that deforms locally: the points at which joints act, each as weights of the nodes. Each
  /// point appears once.
  std::vector<NodeWeights> joint_points;
  std::vector<Material<double>> ports;  ///< attachment points: material points at which forces act
  double drag;                          ///< nu, 1/s
  VecX<double> rest;                    ///< rest values of the dynamic parameters at time 0
  VecX<double> inertia_floor;  ///< `floor` of SymmetricFactor: inertia up to this value is regarded as 0
  std::vector<Range> limits;   ///< limits of each dynamic parameter
  /// For a part without dynamic global parameters: the constant p, J and rates of the ports of the reference
  /// shape s.
  std::vector<PointJet<double>> rigid_ports;
  std::shared_ptr<const RigidMass> rigid_mass;  ///< of a rigid part; nullptr for other parts
  std::vector<NodeWeights> node_weights;        ///< weights of each port, if the part deforms locally
  std::vector<int> port_place;                  ///< number of each port in `joint_points`; -1: none
  Eigen::Matrix3d R0;                           ///< orientation at time 0; constant for a fixed part
  Part::Use use;                                ///< prevents changes of the part while the model exists

  /// Returns the rest values of the dynamic parameters at time t (s).
  VecMax<double> rest_at(double t) const {
    VecMax<double> values = rest;
    for (int k = 0; k < n_s && actuated; ++k) values[k] = part->parameters().moving(k).rest.value(t);
    return values;
  }
  /// Number of local coordinates.
  int n_d() const { return local == nullptr ? 0 : static_cast<int>(local->n_d()); }
  int n_q() const { return 7 + n_s + n_d(); }  ///< number of coordinates in q
  int n_v() const { return 6 + n_s + n_d(); }  ///< number of velocities in v
  /// Number of velocities of the part in a group (constraint/group.h): v_r, and d_dot at `joint_points`.
  int n_x() const { return 6 + n_s + 3 * static_cast<int>(joint_points.size()); }
};

/// An attachment: a port of a part, or a point of the world.
struct PortRef {
  int part = -1;  ///< -1: the world
  int port = -1;
};

/// A signal of a formula, with its places in the model.
struct SignalModel {
  const Signal* signal;
  int part = -1;   ///< number of the signal's part; -1: none
  PortRef a, b;    ///< attachments of the points of the signal
  int place = -1;  ///< number of the coordinate or sensor that the signal reads; -1: none
};
/// A function of time and state, with its signals.
struct FunctionModel {
  const StateFunction* function = nullptr;
  std::vector<SignalModel> signals;  ///< empty if the function does not read the state
};
struct CoordinateModel {
  const Joint* coordinate;
  std::vector<PortRef> at;  ///< attachment of each point of the coordinate
};
struct DriveModel {
  const Drive* drive;
  SignalModel on;
  FunctionModel target, target_rate, stiffness, damping, force;
};

struct SpringModel {
  const Spring* spring;
  PortRef a, b;
  /// Stiffness, damping and rest length, if one of them is not constant; else empty.
  std::vector<FunctionModel> functions;
};
struct ForceModel {
  const PointForce* force;
  PortRef at;
  std::vector<FunctionModel> components;  ///< components of a force that reads the state; else empty
};
struct TorqueModel {
  const Torque* torque;
  int part;
  int against;                            ///< part with the opposite torque; -1: none
  std::vector<FunctionModel> components;  ///< components of a torque that reads the state; else empty
};

struct DistributedModel {
  const DistributedForce* force;
  int part;
  int first_port;  ///< first port of the force; the numbers of its ports are consecutive
  std::array<FunctionModel, 3> density;  ///< components of DistributedForce::density
  FunctionModel pressure;
  bool has_density = false;    ///< whether the density is not zero
  Eigen::Matrix3Xi triangles;  ///< on a surface: three ports each, counted from first_port
  VecX<double> mass;           ///< in a body: mass at each port, kg
  Eigen::Matrix3Xd X;          ///< place of each port at rest, body frame, m
};

/// A side of a joint on a part with coordinates. A joint with both sides on the same part has one JointSide.
struct JointSide {
  int part;
  int place;   ///< number of the part in its island
  int offset;  ///< start of the side's C_q^T and M^-1 C_q^T, n_x x rows, in the flat arrays of the workspace
};
struct JointModel {
  const Joint* joint;
  int rows;
  int row;                  ///< first row in the rows of all joints
  std::vector<PortRef> at;  ///< attachment of each point of the joint
  std::vector<JointSide> sides;
  int island, node;  ///< number of the island, and place of the joint in Island::joints (-1 for a string)
  int island_row;    ///< first row in the rows of the island; -1 for a string
  double length;     ///< size of the smallest part with coordinates at the joint, m
  bool driven;       ///< whether a point of the joint has a prescribed motion
  /// For a joint between two points of one part: start, in the flat arrays, of C_q^T and M^-1 C_q^T of the
  /// first side of the joint alone; else -1.
  int first_offset = -1;
};

/// A term of a block of W_c = C_q M^-1 C_q^T: for two sides of joints on one part, C_q of the row side times
/// M^-1 C_q^T of the column side.
struct Coupling {
  int part;
  int row_offset, column_offset;  ///< starts of the sides in the flat arrays
  int rows, columns;
  int row_joint, column_joint;
  int target;  ///< offset of the block in the values of the factor

  int later_joint() const { return std::max(row_joint, column_joint); }
};

/// A set of parts that joints connect, and the system of these joints.
struct Island {
  std::vector<int> parts;
  std::vector<int> anchors;  ///< parts without coordinates at the joints of the island
  std::vector<int> joints;   ///< joints that are equations, C = 0
  std::vector<int> strings;  ///< one-sided joints, C >= 0
  bool loaded = false;       ///< whether loads act on any part of the island, or read its state
  std::vector<int> first;    ///< first entry of each part in the vector of the velocities of the island
  int n_v = 0;               ///< length of that vector
  int rows = 0;              ///< number of rows of `joints`
  int rigid = -1;            ///< number of the island among the rigid islands; -1: none
  bool augmented = false;    ///< whether the augmented matrix of Eq. (14) is factored, not the blocks of W_c
  bool uneven = false;       ///< whether masses differ so much that lambda needs iterative refinement
  BlockPattern pattern;      ///< pattern of the blocks of W_c, if these blocks are factored
  std::vector<Coupling> couplings;  ///< sorted by later_joint()
  long factor_values = 0;           ///< number of values in the factor
};

class Model {
 public:
  /// Prepares all parts. Throws std::invalid_argument, naming the part, joint, load or setting at fault.
  /// `body` must outlive the model.
  explicit Model(const MultiBody& body);
  /// Prepares some parts of a body, with their joints and loads. parts: numbers of the parts in the body,
  /// increasing. The model contains the joints and loads that act on at least one of these parts with
  /// coordinates. `parts` must include all parts on which these joints and loads act, and all parts whose
  /// state these loads read.
  Model(const MultiBody& body, std::vector<int> parts);

  const MultiBody& body() const { return *body_; }
  /// Whether the model contains all parts of the body.
  bool is_whole() const { return part_numbers_.size() == body_->parts().size(); }
  /// Numbers of the parts, and of the joints, in the body; increasing.
  const std::vector<int>& part_numbers() const { return part_numbers_; }
  const std::vector<int>& joint_numbers() const { return joint_numbers_; }
  const std::vector<PartModel>& parts() const { return parts_; }
  const std::vector<SpringModel>& springs() const { return springs_; }
  const std::vector<ForceModel>& forces() const { return forces_; }
  const std::vector<TorqueModel>& torques() const { return torques_; }
  const std::vector<DistributedModel>& distributed_forces() const { return distributed_forces_; }
  const std::vector<DriveModel>& drives() const { return drives_; }
  const std::vector<CoordinateModel>& coordinates() const { return coordinates_; }
  /// The sensors, and the number of each in the body. A model of some parts has only the sensors whose
  /// signals are all in this model.
  const std::vector<FunctionModel>& sensors() const { return sensors_; }
  const std::vector<int>& sensor_numbers() const { return sensor_numbers_; }
  /// Pairs of parts that a load connects: the load acts on both parts, or acts on one part and reads the
  /// state of the other part.
  const std::vector<std::pair<int, int>>& load_connections() const { return load_connections_; }
  /// Appends the numbers of the parts whose state a function or signal reads, also through sensors and
  /// coordinates. The numbers may be repeated; -1 stands for the world.
  void append_parts(const FunctionModel& function, std::vector<int>& parts) const;
  void append_parts(const SignalModel& signal, std::vector<int>& parts) const;
  /// Numbers of the parts that loads (springs, forces, torques, distributed forces, drives) act on or read.
  const std::vector<int>& loaded_parts() const { return loaded_parts_; }
  const std::vector<JointModel>& joints() const { return joints_; }
  const std::vector<Island>& islands() const { return islands_; }
  /// The islands of rigid parts on ball joints.
  const std::vector<RigidIsland>& rigid_islands() const { return rigid_islands_; }
  /// Numbers of the parts that are in no island.
  const std::vector<int>& lone_parts() const { return lone_parts_; }
  /// Times after 0 at which joints, planes and obstacles switch on or off, sorted, s.
  const std::vector<double>& switch_times() const { return switch_times_; }
  /// Numbers of the joints with an end whose motion is prescribed.
  const std::vector<int>& driven_joints() const { return driven_joints_; }
  /// Whether next_kink() can find a kink.
  bool may_have_kinks() const;
  /// Returns the first kink later than `after` and no later than `until` (s). At a kink a position, its rate
  /// or a force jumps. Kinks are the kinks of the prescribed motion of the ends of joints and springs while
  /// these act, the times at which springs are switched on or off, and the multiples of 1 /
  /// MultiBody::stop_rate. If there is no kink, the time of the result is infinite.
  Kink next_kink(double after, double until) const;
  /// Returns the first kink of one joint, or of one spring.
  Kink next_kink(const JointModel& joint, double after, double until) const;
  Kink next_kink(const SpringModel& spring, double after, double until) const;
  /// Returns the energy of a spring in a state, J, as if the spring acted at the time of the state.
  double energy(const SpringModel& spring, const State& state) const;
  int n_rows() const { return n_rows_; }          ///< number of rows of all joints
  int n_side_values() const { return n_sides_; }  ///< number of values in C_q^T of all joints
  int n_q() const { return n_q_; }
  int n_v() const { return n_v_; }
  int n_limits() const { return n_limits_; }
  /// Size of State::at_rest: the number of parts if parts may sleep, else 0.
  std::size_t n_resting() const { return body_->contact.active && body_->contact.sleep ? parts_.size() : 0; }

  /// Whether at most eight parts can move. In such a model, the times of impacts within a step are located.
  bool has_few_moving_parts() const { return n_moving_ <= 8; }
  /// Whether the parts can step in clusters (simulate/clusters.h): contact is active, more than eight parts
  /// can move, no part deforms locally, and joints and loads do not connect all parts that can move.
  bool forms_clusters() const;
  /// Returns the sets of parts with coordinates that joints and loads connect (load_connections()).
  DisjointSets connected_parts() const;

  /// Returns the state at time 0.
  State initial_state() const;
  /// Sets State::at_limit of all parameters from their values.
  void record_limits(State& state) const;
  /// Returns the values and rates of all parameters of a part in a state. For a part without coordinates,
  /// returns its rest values at time 0 and zero rates.
  ParameterValues<double> values(const State& state, int part) const;
  /// Returns the position of the frame of a part (m, world) and its orientation (body to world) in a state.
  Vec3<double> position(const State& state, int part) const { return position(state, part, state.time()); }
  Eigen::Quaterniond orientation(const State& state, int part) const {
    return orientation(state, part, state.time());
  }
  /// Return position and orientation at time t (s) in place of state.time(). For a part without prescribed
  /// motion, the result does not depend on t.
  Vec3<double> position(const State& state, int part, double t) const;
  Eigen::Quaterniond orientation(const State& state, int part, double t) const;
  /// Returns the position of a material point of a part, m, world. at: the weights of the nodes at the point
  /// (node_weights()); repeated calls with these weights are faster. PlacedPoint (placed_point.h) keeps the
  /// weights.
  Vec3<double> world_point(const State& state, int part, const Material<double>& m) const;
  Vec3<double> world_point(const State& state, int part, const Material<double>& m,
                           const NodeWeights& at) const;
  /// Returns the weights of the nodes of a part at a point, with the patch of the point (Point::patch); empty
  /// for a part without local deformation.
  static NodeWeights node_weights(const Point& point);
  /// Returns the positions of the nodes of a part that deforms locally, body frame, m, one row per node.
  Nodes node_positions(const State& state, int part) const;
  /// Whether a part is motionless: it is fixed without prescribed motion, or it sleeps.
  bool is_motionless(const State& state, int part) const {
    const PartModel& m = parts_[static_cast<std::size_t>(part)];
    return m.q0 < 0 ? m.motion == nullptr : sleeps(state, part);
  }
  /// Returns the gap of a joint in a state, m: |C|, or max(0, -C) for a one-sided joint.
  double gap(const State& state, int joint) const;
  /// Returns the name of an entry of v, for instance "upper.c_dot.x". Throws std::out_of_range.
  std::string velocity_name(int i) const;
  /// Returns the name of an entry of q, for instance "upper.bend.angle". Throws std::out_of_range.
  std::string coordinate_name(int i) const;

 private:
  /// For each part: the joints on the part, each with the number of the side on the part.
  using SidesOfParts = std::vector<std::vector<std::pair<int, int>>>;

  /// Returns the number of a part of the body in this model; -1 if this model does not contain the part.
  int number_of(const Part& part) const;
  /// Whether `part` is a part of this model that has coordinates.
  bool moves(const Part* part) const { return part != nullptr && !part->fixed() && number_of(*part) >= 0; }
  /// The masses of the rigid parts that have been added; the keys are the constants of the parts.
  using RigidMasses = std::unordered_map<const PartConstants*, std::shared_ptr<const RigidMass>>;
  void add_part(Part& part, RigidMasses& known);
  void add_springs();
  void add_forces_and_torques();
  void add_distributed_forces();
  void resolve_distributed_forces();
  void add_joint(const Joint& joint);
  /// Adds coordinates, sensors and drives, and resolves the functions of all loads.
  void add_actuation();
  void add_coordinates();
  void add_sensors();
  void add_drives();
  FunctionModel resolve(const StateFunction& function, const std::string& what);
  SignalModel resolve(const Signal& signal, const std::string& what);
  /// Calls act(parts) for each load. parts: numbers of the parts on which the load acts or whose state it
  /// reads.
  template <class Act>
  void for_each_load(Act&& act) const;
  /// Adds a port for a point and returns its attachment. what: the load or joint of the point, for messages.
  PortRef attach(const Point& point, const std::string& what);
  void note_switch_times();
  /// Fills in PartModel::joint_points and port_place of parts that deform locally.
  void share_joint_points();
  /// Places C_q^T of all sides in the flat arrays of the workspace.
  void assign_side_offsets();
  void make_islands();
  /// Numbers the joints of all islands; returns the sides on each part.
  SidesOfParts number_joints();
  /// Numbers the parts of all islands.
  void number_parts(const SidesOfParts& sides_of);
  void choose_solver(Island& island, const SidesOfParts& sides_of);
  void add_couplings(Island& island, const SidesOfParts& sides_of);
  void evaluate_rigid_ports();
  void mark_loaded_parts();
  void make_rigid_islands();

  const MultiBody* body_;
  std::vector<int> part_numbers_, joint_numbers_;
  std::vector<PartModel> parts_;
  std::vector<SpringModel> springs_;
  std::vector<ForceModel> forces_;
  std::vector<TorqueModel> torques_;
  std::vector<DistributedModel> distributed_forces_;
  std::vector<DriveModel> drives_;
  std::vector<CoordinateModel> coordinates_;
  std::vector<FunctionModel> sensors_;
  std::vector<int> sensor_numbers_;
  std::vector<std::pair<int, int>> load_connections_;
  std::vector<int> loaded_parts_, lone_parts_, driven_joints_;
  std::vector<JointModel> joints_;
  std::vector<Island> islands_;
  std::vector<double> switch_times_;
  std::vector<RigidIsland> rigid_islands_;
  int n_moving_ = 0, n_q_ = 0, n_v_ = 0, n_limits_ = 0, n_rows_ = 0, n_sides_ = 0;
};

}  // namespace pliant
