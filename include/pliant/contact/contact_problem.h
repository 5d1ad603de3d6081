// The problem of simultaneous contacts at velocity level. The relative velocity u of the sides of each
// contact and its impulse p satisfy Coulomb's law (solve/coulomb_system.h). Closed joints stay closed,
// parameters stay within their limits, and taut strings do not become longer.
#pragma once

#include <vector>

#include <pliant/collision/contact.h>
#include <pliant/contact/movers.h>
#include <pliant/solve/coulomb_system.h>

namespace pliant {

struct ContactSolution {
  /// Impulse of each contact on side a, including the predicted impulse, N s, world.
  std::vector<Vec3<double>> impulse;
  std::vector<Vec3<double>> velocity;  ///< of side a relative to side b after the impulses, m/s, world
  double residual = 0;                 ///< largest violation of Coulomb's law, m/s
  double worst_residual = 0, worst_accepted = 0;  ///< see CoulombResult, m/s
  int sweeps = 0;                                 ///< see CoulombResult
  int fallbacks = 0;                              ///< see CoulombResult
};

/// Returns whether parameter k of a part is at its lower limit (-1), at its upper limit (1), or at none (0).
/// Within 1e-6 sizes of a limit, as a displacement, the parameter is at the limit.
int near_limit(const PartModel& m, int k, const State& state);

class ContactProblem {
 public:
  /// work: evaluated by evaluate_touched() for these contacts. state, contacts and work must outlive this
  /// object. start: if not nullptr, the state at the start of the motion. A parameter that is at a limit in
  /// this state, or within 1e-6 sizes of the limit, is treated as being at the limit: it has left the limit
  /// in the motion only because the contacts did not act.
  ContactProblem(const Model& model, const State& state, Workspace<double>& work,
                 const std::vector<Contact>& contacts, const State* start = nullptr);

  /// Computes the impulses of contacts, limits and strings. Each contact rebounds with Contact::rebound. The
  /// impulses replace the predicted ones (Contact::predicted): velocities change by the differences.
  /// limit_time: the time since the impulses on limits and strings acted, s, like Contact::since of a
  /// contact.
  ContactSolution solve(double limit_time);
  /// Sets the start value of the impulse of a contact, N s, on side a, world. A value near the solution, as
  /// in a pile at rest, saves all sweeps (iterations of the solver). A value far from it saves none.
  void warm_start_at(int contact, const Vec3<double>& impulse);
  /// Returns whether the impulse of a contact can be a start value. Valid after solve().
  bool may_warm_start(int contact) const { return system_.may_warm_start(contact); }
  /// Returns the velocity of side a relative to side b at each contact, m/s, world, with the velocities of
  /// another state.
  std::vector<Vec3<double>> velocities(const State& state) const;
  /// Limits the displacements of movers (movers.h) that the impulses cause. Large impulses with different
  /// times Contact::since (on a light part between heavy ones) may nearly cancel in velocity, but not in
  /// displacement. If a displacement exceeds max_time (s) times the change of velocity, it becomes limit_time
  /// (s) times this change. Then subtracts the displacements that predicted impulses have caused in a motion
  /// of max_time seconds.
  void bound_shifts(double limit_time, double max_time);
  /// Adds displacements along the normals that close the gaps and remove the overlaps of contacts with
  /// predicted impulses, to first order. If the bodies of a contact have n of these contacts, its
  /// displacement closes 1/n of its gap. Returns an impulse times a time for each contact, kg m: the normal
  /// impulse that would cause its displacement in one second.
  std::vector<double> close_gaps();
  /// Returns the normal velocity that the predicted impulse of a contact alone causes at this contact, m/s.
  double own_speed(int contact) const;
  /// Adds the predicted impulses to the velocities.
  void apply_predicted() { after_ = before_ + predicted_; }
  /// Subtracts the predicted impulses from the velocities, and subtracts the displacements that they have
  /// caused in a motion of h seconds.
  void take_back_predicted(double h) {
    after_ = before_ - predicted_;
    shift_ = -h * predicted_;
  }
  bool has_predicted() const { return predicted_.size() > 0; }
  /// Adds displacements, without friction, that remove the remaining overlaps: each contact opens by at most
  /// its max_separation (m), and overlaps up to `tolerance` (m) may remain.
  void separate_bodies(const std::vector<double>& max_separation, double tolerance = 0);

  const Model& model() const { return model_; }
  const Movers& movers() const { return movers_; }
  /// Return the velocities of a mover (movers.h) before and after the impulses, and its displacement by the
  /// impulses. Each result has mover.size numbers.
  auto before(const Mover& mover) const { return before_.segment(mover.first, mover.size); }
  auto after(const Mover& mover) const { return after_.segment(mover.first, mover.size); }
  auto shift(const Mover& mover) const { return shift_.segment(mover.first, mover.size); }
  /// Adds lambda, N s, to `rows`: the reactions of joints and taut strings to the contact impulses. rows: one
  /// entry for each row of all joints. C_q^T lambda acts on the parts.
  void add_joint_impulses(VecX<double>& rows) const;

 private:
  /// Reactions of the joints of an island to unit impulses at a contact: one column of lambda for each row of
  /// the contact.
  struct JointResponse {
    int contact;
    const Island* island;
    MatX<double> lambda;
  };
  /// A taut string: its number among the contacts of the system, and its row among the rows of all joints.
  struct String {
    int contact, row;
  };
  /// A side of the contact that is being added. J maps the velocities of its part or node to the velocity of
  /// the side in the axes of the contact, with a minus sign for side b.
  struct Side {
    int part, mover, first;  ///< first: index of the velocities of the part in the velocities of the mover
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxVelocities> J;
    /// Columns of J for some local coordinates; first: index of their rates in the velocities of the mover.
    struct Local {
      int first;
      Eigen::Matrix3Xd J;
    };
    std::vector<Local> local;
  };
  Side make_side(int part);
  void add_local(const ContactSide& side, const Mat3<double>& D, Side& to) const;
  void add_side(const ContactSide& side, const Vec3<double>& x, const Mat3<double>& to_contact);
  void add_limits(const State* start);
  void add_strings();
  void complete();
  void add_predicted();
  void add_response(const Mover& mover, const Side& side, int rows, CoulombSystem::Push& Y);
  void add_joint_responses(int contact);

  const Model& model_;
  const State& state_;
  Workspace<double>& work_;
  const std::vector<Contact>& contacts_;
  std::vector<Mat3<double>> axes_;  // normal and two tangents of each contact as columns, unit vectors, world
  Movers movers_;
  CoulombSystem system_;  // the contacts first, then limits and strings
  std::vector<Side> sides_;
  std::vector<JointResponse> joints_;
  std::vector<String> strings_;
  std::vector<PointJet<double>> jets_;  // buffer of add_side()
  VecX<double> force_;                  // buffer of add_response()
  VecX<double> before_, after_, shift_;
  VecX<double> predicted_;  // changes of velocity by the predicted impulses; empty: there are none
};

}  // namespace pliant
