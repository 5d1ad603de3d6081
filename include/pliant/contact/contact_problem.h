// The contacts of bodies that push on each other at once, at velocity level (design 1.6): each contact has a
// velocity u of its sides against each other and an impulse p that meets Coulomb's law
// (solve/coulomb_system.h), while the joints of each body hold, no parameter leaves its limits and no taut
// string grows.
#pragma once

#include <vector>

#include <pliant/collision/contact.h>
#include <pliant/contact/movers.h>
#include <pliant/solve/coulomb_system.h>

namespace pliant {

struct ContactSolution {
  std::vector<Vec3<double>> impulse;   ///< of each contact, N s, world, on side a
  std::vector<Vec3<double>> velocity;  ///< after it, of side a against side b, m/s, world
  double residual = 0;                 ///< what Coulomb's law misses at the worst contact, m/s
  int sweeps = 0;
  int fallbacks = 0;  ///< see CoulombResult
};

class ContactProblem {
 public:
  /// work: evaluated with masses and factors for every part that the contacts touch, but for those that they
  /// move by nodes. state, contacts, work: must outlive it.
  ContactProblem(const Model& model, const State& state, Workspace<double>& work,
                 const std::vector<Contact>& contacts);

  /// Impulses of the contacts, with the rebound that each of them asks for, and of limits and strings, whose
  /// `since` is that of all.
  ContactSolution solve(double since_of_limits);
  /// Where the search for the impulse of a contact begins, if that is near what is found: piles that stand
  /// then take no sweeps, heaps that move as long as without. N s, world, on side a.
  void warm_start_at(int contact, const Vec3<double>& impulse);
  /// Whether it may begin at the impulse of a contact. Once solve() was called.
  bool may_warm_start(int contact) const { return system_.may_warm_start(contact); }
  /// Velocities of side a against side b at each contact, m/s, world, were the parts to move as they do in
  /// another state.
  std::vector<Vec3<double>> velocities(const State& of) const;
  /// Great impulses at other times each, as on something light between heavy things, may nearly cancel in
  /// velocity and not at all in place: no mover goes farther by them than by its change of velocity in `most`
  /// seconds, or it counts as moved for a time of `since` by all.
  void bound_shifts(double since, double most);
  /// Adds to the shifts, without friction: what takes the gaps that these leave to zero where they are
  /// negative, each by at most its `most` m, and but for `enough` m.
  void separate_bodies(const std::vector<double>& most, double enough = 0);

  const Movers& movers() const { return movers_; }
  /// Velocities of a mover before the impulses and after them, and how far they moved it, see Contact::since.
  auto before(const Mover& mover) const { return before_.segment(mover.first, mover.size); }
  auto after(const Mover& mover) const { return after_.segment(mover.first, mover.size); }
  auto shift(const Mover& mover) const { return shift_.segment(mover.first, mover.size); }
  /// Adds what the joints take up of the impulses: on the parts act C_q^T of it, N s. rows: of all joints.
  void add_joint_impulses(VecX<double>& rows) const;

 private:
  /// Impulses of the joints of an island by unit impulses of a contact.
  struct JointResponse {
    int contact;
    const Island* island;
    MatX<double> lambda;
  };
  /// A taut string: the lone row that it is, and its number among those of all joints.
  struct String {
    int contact, row;
  };
  /// A side of the contact that is added now.
  struct Side {
    int part, mover, first;  ///< of its velocities in those of the mover
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxVelocities> J;
    /// J of so many local coordinates, likewise.
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
