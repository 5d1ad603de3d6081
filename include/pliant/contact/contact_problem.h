// The velocity-level problem of simultaneous contacts. Each contact has a relative velocity u of its sides
// and an impulse p that obey Coulomb's law (solve/coulomb_system.h). The joints of each body stay closed, no
// parameter leaves its limits and no taut string grows.
#pragma once

#include <vector>

#include <pliant/collision/contact.h>
#include <pliant/contact/movers.h>
#include <pliant/solve/coulomb_system.h>

namespace pliant {

struct ContactSolution {
  std::vector<Vec3<double>> impulse;   ///< on side a of each contact, N s, world
  std::vector<Vec3<double>> velocity;  ///< of side a relative to side b after the impulse, m/s, world
  double residual = 0;                 ///< residual of Coulomb's law at the worst contact, m/s
  int sweeps = 0;
  int fallbacks = 0;  ///< see CoulombResult
};

class ContactProblem {
 public:
  /// work: evaluated, with masses and factors, for every touched part except those whose nodes move one by
  /// one. state, contacts and work must outlive the problem.
  ContactProblem(const Model& model, const State& state, Workspace<double>& work,
                 const std::vector<Contact>& contacts);

  /// Solves for the impulses of the contacts, with their rebounds, and of limits and strings, whose `since`
  /// is since_of_limits, s.
  ContactSolution solve(double since_of_limits);
  /// Sets the initial impulse of a contact, N s, world, on side a. With impulses near the solution standing
  /// piles need no sweeps; moving heaps need as many as without.
  void warm_start_at(int contact, const Vec3<double>& impulse);
  /// Returns whether a contact may warm-start. Valid after solve().
  bool may_warm_start(int contact) const { return system_.may_warm_start(contact); }
  /// Returns the velocity of side a relative to side b at each contact for the velocities of another state,
  /// m/s, world.
  std::vector<Vec3<double>> velocities(const State& of) const;
  /// Bounds the shifts. Large impulses at different times, as on a light body between heavy ones, may nearly
  /// cancel in velocity but not in position. No mover shifts farther than by its change of velocity in `most`
  /// seconds; otherwise all its impulses count for a time of `since`, s.
  void bound_shifts(double since, double most);
  /// Adds shifts without friction that remove the overlaps that remain, each by at most its `most` (m), down
  /// to `enough` (m).
  void separate_bodies(const std::vector<double>& most, double enough = 0);

  const Movers& movers() const { return movers_; }
  /// Velocities of a mover before and after the impulses, and its shift (Contact::since).
  auto before(const Mover& mover) const { return before_.segment(mover.first, mover.size); }
  auto after(const Mover& mover) const { return after_.segment(mover.first, mover.size); }
  auto shift(const Mover& mover) const { return shift_.segment(mover.first, mover.size); }
  /// Adds the impulses of the joints, N s; C_q^T of them acts on the parts. rows: of all joints.
  void add_joint_impulses(VecX<double>& rows) const;

 private:
  /// Impulses on the joints of an island by unit impulses at a contact.
  struct JointResponse {
    int contact;
    const Island* island;
    MatX<double> lambda;
  };
  /// A taut string: its one-sided row, and its number among the rows of all joints.
  struct String {
    int contact, row;
  };
  /// A side of the contact that is being added.
  struct Side {
    int part, mover, first;  ///< first of its velocities in those of the mover
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxVelocities> J;
    /// Number of local coordinates in the mover.
    struct Local {
      int first;
      Eigen::Matrix3Xd J;
    };
    std::vector<Local> local;
  };
  Side side_of(int part);
  void add_local(const ContactSide& side, const Mat3<double>& D, Side& to) const;
  void add_side(const ContactSide& side, const Contact& contact, double sign);
  void add_limits();
  void add_strings();
  void complete();
  void add_response(const Mover& mover, const Side& side, int rows, CoulombSystem::Push& Y) const;
  void hold_joints(int contact);

  const Model& model_;
  const State& state_;
  Workspace<double>& work_;
  const std::vector<Contact>& contacts_;
  Movers movers_;
  CoulombSystem system_;  // the contacts first, then limits and strings
  std::vector<Side> sides_;
  std::vector<JointResponse> joints_;
  std::vector<String> strings_;
  std::vector<PointJet<double>> jets_;
  VecX<double> before_, after_, shift_;
};

}  // namespace pliant
