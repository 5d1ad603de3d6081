// The contacts of bodies that push on each other at once, at velocity level (design 1.6): each contact has a
// velocity u of its sides against each other and an impulse p that meets Coulomb's law (solve/coulomb.h),
// while the joints of each body hold and no parameter leaves its limits. What moves as one, a part alone or
// the parts that joints tie together, is a mover; its velocities x stand as in body/group.h. Parts that
// deform at the nodes of a mesh have lumped masses: what pushes a node moves that node alone, and every node
// is a mover of its own, with its velocity in the world.
#pragma once

#include <limits>
#include <utility>
#include <vector>

#include <pliant/body/dynamics.h>
#include <pliant/contact/contact.h>
#include <pliant/solve/coulomb.h>

namespace pliant {

struct Mover {
  int part = -1;                   ///< a part alone
  int node = -1;                   ///< or this node of it
  const Island* island = nullptr;  ///< or this
  VecX<double> before, x;          ///< velocities before and after the impulses
  VecX<double> shift;              ///< how far they moved it, see Contact::since
};

struct ContactSolution {
  std::vector<Vec3<double>> impulse;   ///< of each contact, N s, world, on side a
  std::vector<Vec3<double>> velocity;  ///< after it, of side a against side b, m/s, world
  double residual = 0;                 ///< what Coulomb's law misses at the worst contact, m/s
  int sweeps = 0;
  int fallbacks = 0;  ///< groups of contacts that were left with more than rounding of it
};

class ContactProblem {
 public:
  /// work: evaluated with masses and factors for every part that the contacts touch, but for those that
  /// deform at nodes. state, contacts, work: must outlive it.
  ContactProblem(const Model& model, const State& state, Workspace<double>& work,
                 const std::vector<Contact>& contacts);

  /// Impulses that the search begins with, N s, world, one for each contact: the nearer to the solution, the
  /// shorter it is.
  void begin_with(std::vector<Vec3<double>> impulse) { begin_ = std::move(impulse); }
  /// Impulses of the contacts, with the rebound that each of them asks for, and of limits, whose `since` is
  /// that of all.
  ContactSolution solve(double since_of_limits);
  /// Velocities of side a against side b at each contact, m/s, world, were the parts to move as they do in
  /// another state.
  std::vector<Vec3<double>> velocities(const State& of) const;
  /// Adds to the shifts, without friction: what takes the gaps that these leave to zero where they are
  /// negative, by at most `most` m.
  void part_bodies(double most);

  const std::vector<Mover>& movers() const { return movers_; }
  /// Adds what the joints take up of the impulses: on the parts act C_q^T of it, N s. rows: of all joints.
  void add_joint_impulses(VecX<double>& rows) const;

 private:
  struct Side {
    std::size_t mover;
    int first;  ///< of its part in x
    Eigen::Matrix3Xd J;
  };
  struct Response {
    std::size_t mover;
    MatX<double> Y;       ///< change of x by unit impulses
    MatX<double> lambda;  ///< impulses of the joints of an island with it
  };
  /// A contact, or one row of a limit, whose other two are zero.
  struct Block {
    int rows = 3;
    double mu = 0;
    std::vector<Side> sides;
    std::vector<Response> responses;
    Mat3<double> W = Mat3<double>::Zero();
    Mat3<double> axes = Mat3<double>::Identity();  ///< normal and tangents, columns, world
    Vec3<double> constant = Vec3<double>::Zero();  ///< added to u
    Vec3<double> p = Vec3<double>::Zero();
    CoulombLaw law;
  };
  /// Some of a list of numbers.
  struct Numbers {
    const std::size_t *first, *last;
    const std::size_t* begin() const { return first; }
    const std::size_t* end() const { return last; }
    std::size_t size() const { return static_cast<std::size_t>(last - first); }
    std::size_t operator[](std::size_t i) const { return first[i]; }
  };
  /// Blocks and movers that push on each other and on nothing else.
  struct Cluster {
    Numbers blocks, movers;
    bool nodes = false;  ///< whether nodes are among the movers
    double exact = 0;    ///< velocities below this are rounding, m/s
    double allowed = 0;  ///< and what may be left
  };
  /// Impulses and velocities of a cluster.
  struct Iterate {
    VecX<double> p, x;
    double residual = std::numeric_limits<double>::infinity();
  };

  std::size_t mover_of(int part);
  std::size_t mover_of_node(int part, int node);
  int first_in(const Mover& mover, int part) const;
  void add_side(Block& block, const ContactSide& side, const Vec3<double>& x, double sign);
  void add_limits(const State& state);
  void complete(Block& block);
  VecX<double> velocities_of(const Mover& mover, const State& state) const;
  Vec3<double> velocity(const Block& block) const;
  Vec3<double> met(const Block& block, const Vec3<double>& u) const;
  void push(const Block& block, const Vec3<double>& impulse);
  std::vector<Cluster> clusters();
  void set_scale(Cluster& cluster) const;
  double sweep(const Cluster& cluster, bool forward);
  double residual(const Cluster& cluster) const;
  void take(const Cluster& cluster, Iterate& iterate) const;
  void set(const Cluster& cluster, const Iterate& iterate);
  bool newton(const Cluster& cluster);
  bool relax(const Cluster& cluster, int most, int history, int& sweeps);
  bool iterate(const Cluster& cluster, int& sweeps);
  void yield(const Cluster& cluster, double softness);
  void iterate(ContactSolution& solution);

  const Model& model_;
  const State& state_;
  Workspace<double>& work_;
  const std::vector<Contact>& contacts_;
  std::vector<Mover> movers_;
  std::vector<int> mover_number_;           // of each part; -1: not there yet
  std::vector<std::vector<int>> of_nodes_;  // the same of the nodes of each part that deforms at them
  std::vector<Block> blocks_;               // the contacts first
  std::vector<std::size_t> clustered_;      // the blocks of each cluster, then the movers of each
  std::vector<Vec3<double>> begin_;
  double softness_ = 0;  // of all contacts, as a share of their W
};

}  // namespace pliant
