// Coulomb's law at many contacts. A mover is a group of velocities that move together (a part, or parts that
// joints connect). The impulses p_k of the contacts change the velocities x of the movers and the contact
// velocities u_k:
//   x = x_0 + sum_k Y_k p_k,   u_k = c_k + J_k x
// x_0 is x without contact impulses, and c_k is u_k for x = 0. Each pair (p_k, u_k) satisfies the law of
// solve/coulomb.h. J_k consists of sides, each for some velocities of a mover at the contact. Y_k consists of
// pushes, one for each mover that the impulse changes. A cluster is a set of movers that contacts connect;
// each cluster is solved separately. See README.md of this folder.
#pragma once

#include <cstddef>
#include <memory>
#include <optional>
#include <vector>

#include <pliant/math/index.h>
#include <pliant/solve/coulomb.h>

namespace pliant {

/// The accuracy of a solution. Smaller violations of the law are accepted.
struct CoulombTolerance {
  double velocity = 0;  ///< a velocity, in units of u
  /// A share of the approach speed of a cluster, which is the largest -u_n of its contacts without impulses.
  /// At a limit of a parameter, a share of the change of speed by the impulse of the limit. Not given: the
  /// search ends at rounding.
  std::optional<double> share{};
};

/// The quality and the cost of a solution.
struct CoulombResult {
  double residual = 0;  ///< largest violation of the law at a contact, in units of u
  /// The residual and the accepted residual of the cluster for which the ratio of these two is largest.
  /// Without CoulombTolerance::share, a share of 1e-3 is accepted here.
  double worst_residual = 0, worst_accepted = 0;
  int sweeps = 0;  ///< number of sweeps over all contacts of a cluster, summed over the clusters
  /// Number of clusters whose search was repeated with compliant contacts. A search is repeated if it leaves
  /// a residual above the tolerance (see CoulombSystem::solve) and above 1e-6 of the largest contact velocity
  /// without impulses. The fraction is 1e-2 for clusters with more than 100 contacts or with point masses,
  /// because their searches converge more slowly.
  int fallbacks = 0;
};

struct CoulombScratch;

/// The contact problem: first add movers and contacts, then call solve(), possibly several times.
class CoulombSystem {
 public:
  CoulombSystem();
  ~CoulombSystem();

  using Side = Eigen::Map<Eigen::Matrix3Xd>;
  using Push = Eigen::Map<MatX<double>>;

  /// Allocates storage for this number of contacts of rigid bodies.
  void reserve(std::size_t contacts);
  /// Adds a mover with `size` velocities and returns its number. A mover of size 3 is a point mass.
  int add_mover(int size);
  /// Adds a contact with coefficient of friction mu. The contact has three rows: the normal and two tangents.
  void add_contact(double mu);
  /// Adds a single one-sided row. The row is stored as a contact whose two tangential rows are zero.
  void add_row();
  /// Adds a single one-sided row for a limit of a parameter. Its velocity has the unit of the parameter and
  /// is left out of the approach speed of CoulombTolerance.
  void add_limit();
  /// Adds a side of the last contact: J for `size` velocities of a mover, starting at velocity `first` of
  /// that mover. Returns the 3 x size matrix, initially zero. The caller fills it before the next add
  /// function.
  Side add_side(int mover, int first, int size);
  /// Adds a push of the last contact: Y for all velocities of a mover. Returns the size x 3 matrix, initially
  /// zero. The caller fills it before the next add function. The impulse of a contact without pushes is zero.
  Push add_push(int mover);

  /// Removes the pushes of the last contact. No push can be added to this contact afterwards.
  void drop_pushes();

  int movers() const { return static_cast<int>(movers_.size()) - 1; }  ///< number of movers
  int size() const { return static_cast<int>(contacts_.size()); }      ///< number of contacts and single rows
  /// Number of rows (3, or 1 for a single row), of sides and of pushes of contact k.
  int rows(int k) const { return contacts_[at(k)].rows; }
  int sides(int k) const { return contacts_[at(k)].last_side - contacts_[at(k)].first_side; }
  int pushes(int k) const { return contacts_[at(k)].last_push - contacts_[at(k)].first_push; }
  /// Returns push number i of contact k. Not valid after solve().
  Push push(int k, int i);
  /// Returns the mover of push number i of contact k.
  int pushed(int k, int i) const { return pushes_[at(contacts_[at(k)].first_push + i)].mover; }
  /// Returns c (constant) and p (impulse) of contact k. The value of p before solve() is the warm start.
  Vec3<double>& constant(int k) { return contacts_[at(k)].c; }
  const Vec3<double>& constant(int k) const { return contacts_[at(k)].c; }
  Vec3<double>& impulse(int k) { return p_[at(k)]; }
  const Vec3<double>& impulse(int k) const { return p_[at(k)]; }
  void set_friction(int k, double mu) { contacts_[at(k)].mu = mu; }

  /// Returns the index of the first velocity of a mover in x.
  int first(int mover) const { return movers_[at(mover)]; }
  int mover_size(int mover) const { return movers_[at(mover) + 1] - movers_[at(mover)]; }
  int n_x() const { return movers_.back(); }
  /// Returns J_i Y_j. Column r is the change of the velocity at contact i by a unit impulse along row r of
  /// contact j.
  Mat3<double> effect(int i, int j) const;
  /// Returns u_k for the velocities x of all movers.
  Vec3<double> velocity(int k, const VecX<double>& x) const;
  /// Computes x += factor Y_k p_k.
  void add_change(int k, double factor, VecX<double>& x) const;

  /// Returns whether solve() can use the impulse of contact k as a warm start. Valid after solve(). The
  /// result is false if the contact is the only one of its cluster, if the cluster contains point masses, or
  /// if the contact has no side.
  bool may_warm_start(int k) const { return contacts_[at(k)].warm_start; }
  /// Finds the impulses. x: velocities of all movers, without contact impulses on input and with them on
  /// output. No contact or mover can be added afterwards.
  CoulombResult solve(VecX<double>& x, const CoulombTolerance& tolerance = {});

 private:
  friend class CoulombCluster;
  /// A side (3 x size) or a push (size x 3): it refers to the velocities x[first] ... x[first + size - 1] of
  /// a mover. numbers: the index of its first entry in numbers_.
  struct Term {
    int mover, first, size;
    std::size_t numbers;
  };
  /// A contact.
  struct Contact {
    int rows = 3, first_side = 0, last_side = 0, first_push = 0, last_push = 0;
    double mu = 0;
    Vec3<double> c = Vec3<double>::Zero();
    Mat3<double> W = Mat3<double>::Zero();
    CoulombLaw law;
    bool warm_start = false, is_limit = false;
  };
  void begin_contact(int rows, double mu);
  Term term(int mover, int first, int size);
  void complete();
  void select_used();
  void find_clusters();
  Vec3<double> velocity_at(int k, const std::vector<Term>& terms, const VecX<double>& x) const;
  void add_change_to(int k, const Vec3<double>& p, const std::vector<Term>& terms, VecX<double>& x) const;

  std::vector<int> movers_{0};  // index in x of the first velocity of each mover, and n_x()
  std::vector<Contact> contacts_;
  std::vector<Term> sides_, pushes_;
  std::vector<double> numbers_;  // the entries of all terms
  std::vector<Vec3<double>> p_;
  // The search uses only the velocities that a side depends on. A large mover (a deformable part, or parts
  // with many joints) has many more velocities than its contacts need.
  std::vector<int> used_;         // indices of these velocities in x
  std::vector<int> used_movers_;  // first used velocity of each mover, and the end
  std::vector<Term> used_sides_, used_pushes_;
  VecX<double> x0_, x_;  // values of the used velocities: without impulses, with the present impulses
  std::vector<int> order_, clusters_;  // contacts sorted by cluster; start of each cluster, and the end
  bool complete_ = false;
  std::unique_ptr<CoulombScratch> scratch_;
};

}  // namespace pliant
