// The search for the impulses of one cluster of contacts: sweeps that solve one contact at a time, with
// extrapolation, and Newton's method for all contacts together.
#pragma once

#include <utility>
#include <vector>

#include <pliant/solve/coulomb_system.h>
#include <pliant/solve/mover_system.h>

namespace pliant {

namespace detail {

/// A cluster with more contacts than this is large.
inline constexpr int kManyContacts = 100;
/// Residual that is acceptable, in units of the largest contact velocity without impulses. A search that
/// stalls ends if its residual is at most this value. A search that leaves a larger residual is repeated with
/// compliant contacts; for this decision, large clusters and clusters with point masses use
/// kAcceptableOfManyContacts.
inline constexpr double kAcceptableResidual = 1e-6;
/// Without CoulombTolerance::share, residuals up to this share of the approach speed are accepted in
/// CoulombResult::worst_accepted.
inline constexpr double kReportedShare = 1e-3;

}  // namespace detail

/// The law of a contact, linearised about its velocity u and its impulse p: F + T du + D dp = 0
/// (coulomb_newton-inl.h). F is the violation of the law; T and D are the derivatives of F by u and p.
/// solve_linear() replaces F and T by D^-1 F and D^-1 T.
struct LinearContactLaw {
  int contact = 0;
  Vec3<double> u = Vec3<double>::Zero(), F = u, dp = u;  ///< dp: the solution, the change of p
  Mat3<double> T = Mat3<double>::Zero(), D = T;
};

/// The linear systems of Newton's method, and the positions of the contacts' pushes and sides in these
/// systems.
struct MoverCoupling {
  std::vector<MoverSystem> clusters;       ///< the system of each cluster
  std::vector<int> numbers;                ///< number of each mover in its system; -1 if no contact pushes it
  std::vector<int> push_rows, side_rows;   ///< first row of each push and side; -1 for a mover without number
  std::vector<std::size_t> first_block;    ///< first block of each contact
  std::vector<MoverSystem::Block> blocks;  ///< the block of each pair of a side and a push of a contact
};

/// Workspace of the search, reused for all clusters.
struct CoulombScratch {
  /// For accelerated_sweeps(): the impulses before (now) and after (next) a pair of sweeps, and after the
  /// previous pair (last); the residuals r = weight (next - now) of both pairs; the scale (weight) of
  /// impulses to velocities. The columns of dr and dp are the differences of successive r and next.
  struct Sweeps {
    VecX<double> now, next, last, r, last_r, weight;
    MatX<double> dr, dp;
  } sweeps;
  struct Linear {
    std::vector<LinearContactLaw> open;              ///< contacts with a normal impulse
    std::vector<std::pair<int, Vec3<double>>> drop;  ///< impulses that become zero: contact, and change of p
  } linear;
  MoverCoupling coupling;
  VecX<double> best;    ///< the best impulses found so far
  Eigen::Matrix3Xd TS;  ///< T times a side
};

/// One cluster of a contact problem.
class CoulombCluster {
 public:
  /// number: index of the cluster. The velocities of the system must include the present impulses. tolerance:
  /// see CoulombSystem::solve.
  CoulombCluster(CoulombSystem& system, int number, const CoulombTolerance& tolerance,
                 CoulombScratch& scratch);
  /// Finds the impulses and stores them in the system. Updates the largest residual in result and adds the
  /// number of sweeps; adds a fallback if the search was repeated with compliant contacts.
  void solve(CoulombResult& result);

 private:
  using Contact = CoulombSystem::Contact;
  Contact& contact(int i) { return system_.contacts_[at(contacts_[i])]; }
  const Contact& contact(int i) const { return system_.contacts_[at(contacts_[i])]; }
  Vec3<double>& p(int i) { return system_.p_[at(contacts_[i])]; }
  const Vec3<double>& p(int i) const { return system_.p_[at(contacts_[i])]; }
  bool is_fixed(int i) const { return contact(i).first_push == contact(i).last_push; }
  void set_scale();
  void set_compliance(double compliance);
  Vec3<double> velocity(int i) const;
  Vec3<double> law_impulse(int i, const Vec3<double>& u) const;
  void add_impulse(int i, const Vec3<double>& dp);
  double exact_level(bool to_rounding = false) const;
  void record(double residual, CoulombResult& result) const;
  double sweep(bool forward);
  double residual() const { return residual(tolerance_.share.value_or(0), exact_); }
  double residual(double share, double accepted) const;
  double weight_of(int i, double p, double share, double accepted) const;
  void copy_impulses(VecX<double>& impulses) const;
  void clear_impulses();
  void set_impulses(const VecX<double>& impulses);
  bool accelerated_sweeps(int max_sweeps, int history, int& sweeps);
  void linearise(double proximal);
  MoverSystem* couple_movers();
  void solve_linear(MoverSystem& movers);
  bool newton(bool near);
  bool try_warm_start(const VecX<double>& initial);
  bool may_warm_start() const;
  bool search(int& sweeps);

  CoulombSystem& system_;
  int number_;
  const int* contacts_;
  int size_;
  CoulombTolerance tolerance_;
  CoulombScratch& scratch_;
  bool has_point_masses_ = false;  // whether the cluster contains point masses (CoulombSystem::add_mover)
  bool has_limits_ = false;        // whether the cluster contains limits of parameters
  double scale_ = 0;               // the largest contact velocity without impulses
  double approach_ = 0;            // the approach speed (CoulombTolerance)
  double rounding_ = 0;    // residuals up to this are rounding errors, or within CoulombTolerance::velocity
  double exact_ = 0;       // residuals up to this velocity are within the tolerance
  double acceptable_ = 0;  // residuals up to this velocity are acceptable
  double compliance_ = 0;  // compliance of all contacts, as a fraction of the diagonal of W
};

}  // namespace pliant
