// Model: a MultiBody made ready to run: constants only, in flat arrays. Every function of the dynamics takes
// it const.
#pragma once

#include <string>
#include <vector>

#include <pliant/body/ledger.h>
#include <pliant/body/multibody.h>
#include <pliant/body/state.h>
#include <pliant/solve/symmetric_factor.h>

namespace pliant {

/// A part's place in the flat vectors, its attachment points, its constants.
struct PartModel {
  const Part* part;
  int q0, v0;  ///< first entries in q and v; -1 for a fixed part
  int n_s;
  int limit0;                                 ///< first entry in State::at_limit
  std::vector<Material<double>> ports;        ///< material points that forces act on
  std::vector<PointJet<double>> rigid_ports;  ///< their constants, of a rigid part
  VecMax<double> inertia_floor;               ///< see SymmetricFactor
  SymmetricFactor<double> rigid_factor;       ///< of a rigid part
  Eigen::Matrix3d R0;                         ///< of a fixed part
  Part::Use use;                              ///< keeps the part from being changed
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
  int n_q() const { return n_q_; }
  int n_v() const { return n_v_; }
  int n_limits() const { return n_limits_; }

  /// The state at time 0.
  State initial_state() const;
  /// All parameters of a part in a state.
  ParameterValues<double> values(const State& state, int part) const;
  Vec3<double> position(const State& state, int part) const;
  Eigen::Quaterniond orientation(const State& state, int part) const;
  /// A point of a part in the world.
  Vec3<double> world_point(const State& state, int part, const Material<double>& m) const;
  /// "upper.c.x", "upper.bend.angle": the name of an entry of v (or of q, where they differ).
  std::string velocity_name(int i) const;
  std::string coordinate_name(int i) const;

 private:
  /// what: the spring or force that acts there, for messages.
  PortRef attach(const Point& point, const std::string& what);

  const MultiBody* body_;
  std::vector<PartModel> parts_;
  std::vector<SpringModel> springs_;
  std::vector<ForceModel> forces_;
  std::vector<TorqueModel> torques_;
  int n_q_ = 0, n_v_ = 0, n_limits_ = 0;
};

}  // namespace pliant
