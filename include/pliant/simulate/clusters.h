// Clusters: sets of bodies that may meet within an interval of time, in a simulation with a tolerance. An
// interval is at most ContactSettings::interval long. Each cluster steps alone, as a simulation of its parts,
// with its own step lengths, impact times and sleep (README.md of this folder).
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Geometry>

#include <pliant/body/state.h>
#include <pliant/collision/box_tree.h>
#include <pliant/math/disjoint_sets.h>

namespace pliant {

class Model;
class Simulation;  // simulate/simulation.h

class Clusters {
 public:
  /// whole: the simulation whose state is advanced, with contact and a tolerance. It must outlive the
  /// clusters.
  explicit Clusters(Simulation& whole);
  ~Clusters();

  /// Returns the end of the interval of a time t (s): the first multiple of ContactSettings::interval after
  /// t.
  double end_of_interval(double t) const;
  /// Advances the state from its time to `end`, s. Each cluster takes as many steps as it needs. Throws the
  /// failures of a step; the state is then undefined.
  void advance(double end);

  /// Returns the numbers of the parts of each cluster of the last advance(), increasing. Parts that cannot
  /// move are included if the cluster may reach them.
  std::vector<std::vector<int>> parts() const;

 private:
  struct Cluster {
    std::vector<int> parts;  ///< numbers in the whole model, increasing
    Simulation* simulation = nullptr;
    bool done = false;  ///< whether the cluster has been simulated to the end of the interval
  };
  /// The simulation of a set of parts, kept for later intervals.
  struct Kept {
    std::vector<int> parts;
    std::unique_ptr<Simulation> simulation;
    long last_use = 0;
  };

  void find_anchors();
  void predict_travel(double end);
  void join_parts_that_meet();
  void mark_awake();
  bool join(int i, int j);
  bool can_meet(int i, int j);
  void divide();
  Kept& kept(int first, const std::vector<int>& parts);
  void drop_unused();
  bool simulate(Cluster& cluster, double end);
  bool include_path(const Simulation& of, const State& before, double h);
  void commit(double end);

  Simulation& whole_;
  std::vector<std::vector<Kept>> kept_;  ///< by the number of the first part with coordinates
  const DisjointSets connected_;         ///< parts that joints, springs and torques connect
  std::vector<std::pair<int, int>>
      anchors_;  ///< pairs of a moving part and a part without coordinates that joints or loads connect
  long intervals_ = 0;
  // Of the present interval:
  DisjointSets sets_;                       ///< connected parts, and parts that can meet
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< an estimate of the box of each part's path, m
  /// Of each part: an estimate of the largest distance of its points from their places at the start of the
  /// interval, and the share of this distance by rotation and deformation, m.
  std::vector<double> travel_, turned_;
  /// Pairs of parts whose boxes meet; pairs of a moving part and an immobile part that it can reach.
  std::vector<std::pair<int, int>> pairs_, reached_;
  std::vector<bool> awake_;      ///< of each set, by its first part: whether one of its parts is awake
  std::vector<int> cluster_of_;  ///< number of the cluster of each set, by its first part
  BoxTree tree_;
  std::vector<Cluster> clusters_;
};

}  // namespace pliant
