// The search for the impulses of one cluster of contacts: sweeps, one contact at a time, that are
// extrapolated, and Newton's method on all of them at once.
#pragma once

#include <utility>
#include <vector>

#include <pliant/solve/coulomb_system.h>

#include "mover_system.h"

namespace pliant {

/// More contacts than this are many.
inline constexpr int kMany = 100;
/// What is left in a cluster, relative to what there is to stop, that calls for contacts that yield; of less
/// a search that stalls is content.
inline constexpr double kLeft = 1e-6;

/// The law of a contact, linear about its impulse: F + T du + D dp = 0.
struct LinearContactLaw {
  int contact = 0;
  Vec3<double> u = Vec3<double>::Zero(), F = u, dp = u;  ///< u: where it is linear
  Mat3<double> T = Mat3<double>::Zero(), D = T;
};

/// What Newton's method solves for each cluster, and where what contacts push and their sides are
/// in it.
struct Coupling {
  std::vector<MoverSystem> clusters;
  std::vector<int> numbers;                ///< of movers in theirs; -1 of those that no contact pushes
  std::vector<int> push_rows, side_rows;   ///< of each push and side; -1 of those of no mover there
  std::vector<std::size_t> first_block;    ///< of each contact
  std::vector<MoverSystem::Block> blocks;  ///< of each side in a mover and each push
};

/// What a search works with, kept from cluster to cluster.
struct CoulombScratch {
  struct Sweeps {
    VecX<double> now, next, last, r, last_r, weight;
    MatX<double> dr, dp;
  } sweeps;
  struct Linear {
    std::vector<LinearContactLaw> open;
    std::vector<std::pair<int, Vec3<double>>> drop;  ///< contacts and changes of their impulses
  } linear;
  Coupling coupling;
  VecX<double> best;  ///< impulses
  Eigen::Matrix3Xd TS;
};

class CoulombCluster {
 public:
  /// Of a number. system: its velocities are those by its impulses; enough: see there.
  CoulombCluster(CoulombSystem& system, int number, double enough, CoulombScratch& scratch);
  /// Leaves the impulses in the system.
  void solve(CoulombResult& result);

 private:
  using Point = CoulombSystem::Point;
  Point& point(int i) { return system_.contacts_[at(contacts_[i])]; }
  const Point& point(int i) const { return system_.contacts_[at(contacts_[i])]; }
  Vec3<double>& p(int i) { return system_.p_[at(contacts_[i])]; }
  const Vec3<double>& p(int i) const { return system_.p_[at(contacts_[i])]; }
  bool is_fixed(int i) const { return point(i).first_push == point(i).last_push; }
  void set_scale();
  void yield(double softness);
  Vec3<double> velocity(int i) const;
  Vec3<double> met(int i, const Vec3<double>& u) const;
  void push(int i, const Vec3<double>& dp);
  double exact_now() const;
  double sweep(bool forward);
  double residual() const;
  void take(VecX<double>& impulses) const;
  void reset();
  void set(const VecX<double>& impulses);
  bool relax(int most, int history, int& sweeps);
  void linearise(double proximal);
  MoverSystem* couple_movers();
  void solve_linear(MoverSystem& movers);
  bool newton(bool near);
  bool follow(const VecX<double>& begun);
  bool may_warm_start() const;
  bool search(int& sweeps);

  CoulombSystem& system_;
  int number_;
  const int* contacts_;
  int size_;
  double enough_;
  CoulombScratch& scratch_;
  bool points_ = false;  // whether points are among the movers
  double scale_ = 0;     // of the velocities that there are to stop
  double exact_ = 0;     // velocities below this are rounding
  double allowed_ = 0;   // and what may be left
  double softness_ = 0;  // of all contacts, as a share of their W
};

}  // namespace pliant
