// Coulomb's law at many contacts at once (design 1.6). What moves as one, a mover, has velocities x of its
// own; impulses p of the contacts change them, and with them the velocities u at all contacts,
//   x = x_0 + sum_k Y_k p_k,   u_k = c_k + J_k x,
// and each p_k meets its law at u_k (solve/coulomb.h). Movers that contacts tie together, and nothing else,
// are a cluster, which is solved by itself.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include <pliant/math/index.h>
#include <pliant/solve/coulomb.h>

namespace pliant {

struct CoulombResult {
  double residual = 0;  ///< what the law misses at the worst contact, in units of u
  int sweeps = 0;       ///< over all contacts of a cluster
  /// Clusters that were left with more than 1e-6 of their fastest velocity of it; of many contacts, or of
  /// points, which are left with more as a rule, with more than 1e-2.
  int fallbacks = 0;
};

struct CoulombScratch;

class CoulombSystem {
 public:
  CoulombSystem();
  ~CoulombSystem();

  using Side = Eigen::Map<Eigen::Matrix3Xd>;
  using Push = Eigen::Map<MatX<double>>;

  /// Adds a mover of so many velocities, which are zero; returns its number. One of three is a point.
  int add_mover(int size);
  /// Adds a contact of friction mu, its rows the normal and the tangents, or a lone one-sided row, whose
  /// other two are zero.
  void add_contact(double mu);
  void add_row();
  /// J of the contact added last, for so many velocities of a mover from `first` on: to be filled in, before
  /// anything else is added.
  Side add_side(int mover, int first, int size);
  /// Y of the contact added last, for all velocities of a mover: likewise; zero. A contact without any
  /// cannot be stopped.
  Push add_push(int mover);

  /// The contact added last cannot be stopped after all.
  void drop_pushes();

  int movers() const { return static_cast<int>(movers_.size()) - 1; }
  int size() const { return static_cast<int>(contacts_.size()); }
  int rows(int k) const { return contacts_[at(k)].rows; }
  int sides(int k) const { return contacts_[at(k)].last_side - contacts_[at(k)].first_side; }
  int pushes(int k) const { return contacts_[at(k)].last_push - contacts_[at(k)].first_push; }
  /// Y of a contact that was added, and the mover it is of. Not once solve() was called.
  Push push(int k, int i);
  int pushed(int k, int i) const { return pushes_[at(contacts_[at(k)].first_push + i)].mover; }
  /// c and p of a contact. Before solve(), p is where the search begins, if it is near the solution.
  Vec3<double>& constant(int k) { return contacts_[at(k)].c; }
  const Vec3<double>& constant(int k) const { return contacts_[at(k)].c; }
  Vec3<double>& impulse(int k) { return p_[at(k)]; }
  const Vec3<double>& impulse(int k) const { return p_[at(k)]; }
  void set_friction(int k, double mu) { contacts_[at(k)].mu = mu; }

  /// Where the velocities of a mover begin among those of all, and how many there are.
  int first(int mover) const { return movers_[at(mover)]; }
  int mover_size(int mover) const { return movers_[at(mover) + 1] - movers_[at(mover)]; }
  int n_x() const { return movers_.back(); }
  /// What unit impulses of contact j change the velocity at contact i by.
  Mat3<double> effect(int i, int j) const;
  /// u of a contact at given velocities of all movers.
  Vec3<double> velocity(int k, const VecX<double>& x) const;
  /// Adds the changes of x by the impulse of contact k, `factor` times.
  void add_change(int k, double factor, VecX<double>& x) const;

  /// Whether a search may begin at the impulse of a contact. Once solve() was called: not where it is the
  /// only one of its cluster, nor where points are among what is pushed.
  bool may_warm_start(int k) const { return contacts_[at(k)].begins; }
  /// Finds the impulses; x: velocities of all movers, before them and after. enough: what the law may miss
  /// anyhow. Once this is called, no more is added.
  CoulombResult solve(VecX<double>& x, double enough = 0);

 private:
  friend class CoulombCluster;
  /// 3 by size or size by 3 numbers for x from `first` on, which is of a mover.
  struct Term {
    int mover, first, size;
    std::size_t numbers;
  };
  struct Point {
    int rows = 3, first_side = 0, last_side = 0, first_push = 0, last_push = 0;
    double mu = 0;
    Vec3<double> c = Vec3<double>::Zero();
    Mat3<double> W = Mat3<double>::Zero();
    CoulombLaw law;
    bool begins = false;
  };
  void begin_contact(int rows, double mu);
  Term term(int mover, int first, int size);
  void complete();
  void keep_seen();
  void find_clusters();
  Vec3<double> velocity_at(int k, const std::vector<Term>& of, const VecX<double>& x) const;
  void add_change_to(int k, double factor, const std::vector<Term>& by, VecX<double>& x) const;

  std::vector<int> movers_{0};  // where each begins in x
  std::vector<Point> contacts_;
  std::vector<Term> sides_, pushes_;
  std::vector<double> numbers_;  // of all terms
  std::vector<Vec3<double>> p_;
  // Searches know of those velocities alone that some side depends on: what is large, as a part that deforms
  // or one with many joints, moves far more than its contacts see.
  std::vector<int> seen_;         // their numbers in x
  std::vector<int> seen_movers_;  // where those of each mover begin among them
  std::vector<Term> seen_sides_, seen_pushes_;
  VecX<double> x0_, x_;                // they: before the impulses, and by the present ones
  std::vector<int> order_, clusters_;  // contacts, cluster after cluster; where each begins in it
  bool complete_ = false;
  std::unique_ptr<CoulombScratch> scratch_;
};

}  // namespace pliant
