// Run time of contact search for two bodies. Pairs of ellipsoids, capsules, cylinders and cones of about 0.1
// m are placed in random poses. The second body then moves a little from pose to pose, as in the steps of a
// simulation. The program bench/peers/native/coal_peer measures the library coal in the same poses.
//
//   pair_bench FOLDER
//
// Writes pair_bench.csv and pair_poses.csv to FOLDER and a table to standard output. A query is a search of
// ContactFinder in a model of two parts: it computes the bounding boxes, the gap and all contact points. The
// time of a query is measured in two orders of the poses:
//   cold  successive queries are at poses of different sequences
//   warm  successive queries are at successive poses of a sequence, which are nearly equal
// Columns of pair_poses.csv: pair, band (interval of gaps), sequence, shape and three sizes (m) of each body,
// centre (m) and quaternion w x y z of each body, gap (m). The sizes of an ellipsoid are its semi-axes. The
// sizes of other bodies are the radius, again the radius, and half the height; for a capsule the height is
// that of its straight side. A sequence contains successive poses.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <exception>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include <pliant/contact/contact_stepping.h>
#include <pliant/pliant.h>

#include "table_file.h"
#include "timing.h"

using namespace pliant;

namespace {

constexpr int kSequences = 100, kPoses = 8;     // sequences of a pair and band, poses of a sequence
constexpr double kTravel = 1e-3, kTurn = 1e-2;  // motion from pose to pose, m and rad
constexpr double kMaxGap = 0.1;                 // m, larger than the gap of every pose
constexpr double kMaxDistance = 1;              // largest distance of the centres, m

struct Solid {
  const char* shape;
  std::array<double, 3> sizes;  ///< as in pair_poses.csv, m
  Part::Named parameters;
};
const std::array<Solid, 4>& solids() {
  static const std::array<Solid, 4> all{
      {{"ellipsoid", {0.1, 0.07, 0.05}, {{"a1", 0.1}, {"a2", 0.07}, {"a3", 0.05}}},
       {"capsule", {0.05, 0.05, 0.06}, {{"r", 0.05}, {"l", 0.12}}},
       {"cylinder", {0.06, 0.06, 0.09}, {{"a1", 0.06}, {"a2", 0.06}, {"a3", 0.09}}},
       // The parameters a1 and a2 of a cone are its radius at half height, which is half the radius of its
       // base.
       {"cone", {0.08, 0.08, 0.08}, {{"a1", 0.04}, {"a2", 0.04}, {"a3", 0.08}, {"t", -1}}}}};
  return all;
}

/// An interval of gaps, m.
struct Band {
  const char* name;
  double least, largest;
};
constexpr Band kBands[] = {{"touching", -2e-3, 2e-3}, {"near", 5e-3, 5e-2}};

class Random {
 public:
  /// Returns a random number in [least, largest).
  double in(double least, double largest) {
    return least + (largest - least) * static_cast<double>(engine_() >> 11) / 9007199254740992.0;
  }
  Vec3<double> direction() {
    for (;;) {
      const Vec3<double> x(in(-1, 1), in(-1, 1), in(-1, 1));
      if (x.norm() > 0.1 && x.norm() < 1) return x.normalized();
    }
  }
  Eigen::Quaterniond orientation() { return Eigen::Quaterniond(Eigen::AngleAxisd(in(0, 6), direction())); }

 private:
  std::mt19937_64 engine_{1};
};

/// Coordinates of both parts: centre and quaternion w x y z of each.
using Pose = Eigen::Matrix<double, 14, 1>;

class Pair {
 public:
  Pair(const Solid& a, const Solid& b) {
    add("a", a, {0, 0, 0});
    add("b", b, {1, 0, 0});
    body_.contact.active = true;
    simulation_ = std::make_unique<Simulation>(body_, "rk4");
    state_ = simulation_->state();
  }
  /// Returns the gap of the two bodies, m; kMaxGap if they are farther apart.
  double gap(const Pose& pose) {
    state_.q = pose;
    double least = kMaxGap;
    for (const Contact& contact : simulation_->contact()->finder().find(state_, 0, kMaxGap))
      least = std::min(least, contact.gap);
    return least;
  }

 private:
  void add(const char* name, const Solid& solid, const Vec3<double>& centre) {
    body_.add(make_part(name, solid.shape, {}, 1000)).rest(solid.parameters).place(centre);
  }

  MultiBody body_;
  std::unique_ptr<Simulation> simulation_;
  State state_;
};

/// Returns the pose with the centre of body a at the origin. a, b: orientations; c: centre of body b, m.
Pose pose_of(const Eigen::Quaterniond& a, const Vec3<double>& c, const Eigen::Quaterniond& b) {
  Pose pose;
  pose << 0, 0, 0, a.w(), a.x(), a.y(), a.z(), c, b.w(), b.x(), b.y(), b.z();
  return pose;
}

/// Returns the poses of all sequences, one sequence after the other. The first pose of each sequence has a
/// gap in the band.
std::vector<Pose> random_poses(Pair& pair, const Band& band, Random& random) {
  std::vector<Pose> poses;
  for (int sequence = 0; sequence < kSequences; ++sequence) {
    const Eigen::Quaterniond a = random.orientation();
    Eigen::Quaterniond b = random.orientation();
    const Vec3<double> away = random.direction(), travel = kTravel * random.direction();
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(kTurn, random.direction()));
    const double wanted = random.in(band.least, band.largest);
    double nearer = 0, farther = kMaxDistance;
    for (int halving = 0; halving < 40; ++halving) {
      const double middle = (nearer + farther) / 2;
      (pair.gap(pose_of(a, middle * away, b)) < wanted ? nearer : farther) = middle;
    }
    Vec3<double> c = nearer * away;
    for (int k = 0; k < kPoses; ++k, c += travel, b = turn * b) poses.push_back(pose_of(a, c, b));
  }
  return poses;
}

/// Returns the time of a query in nanoseconds. Poses are visited in the order of `order`.
double time_of_query(Pair& pair, const std::vector<Pose>& poses, const std::vector<std::size_t>& order) {
  volatile double sink = 0;
  const double seconds = bench::seconds_per_call<bench::ProcessorClock>(
      [&] {
        for (const std::size_t i : order) sink = sink + pair.gap(poses[i]);
      },
      0.01, 10);
  return 1e9 * seconds / static_cast<double>(order.size());
}

std::string text(double number) {
  char digits[32];
  std::snprintf(digits, sizeof digits, "%.17g", number);
  return digits;
}

void measure(const Solid& a, const Solid& b, const Band& band, bench::TableFile& costs,
             bench::TableFile& places) {
  Pair pair(a, b);
  Random random;
  const std::vector<Pose> poses = random_poses(pair, band, random);
  const std::string name = std::string(a.shape) + "-" + b.shape;
  std::vector<std::size_t> warm, cold;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    warm.push_back(i);
    cold.push_back(i % kSequences * kPoses + i / kSequences);
    std::vector<std::string> row{name, band.name, std::to_string(i / kPoses)};
    for (const Solid* solid : {&a, &b}) {
      row.push_back(solid->shape);
      for (const double size : solid->sizes) row.push_back(text(size));
    }
    for (const double number : poses[i]) row.push_back(text(number));
    row.push_back(text(pair.gap(poses[i])));
    places.row(row);
  }
  const double cold_ns = time_of_query(pair, poses, cold), warm_ns = time_of_query(pair, poses, warm);
  std::printf("%-20s %-9s %8.0f %8.0f\n", name.c_str(), band.name, cold_ns, warm_ns);
  costs.row("%s,%s,%.1f,%.1f\n", name.c_str(), band.name, cold_ns, warm_ns);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 2) {
    std::fprintf(stderr, "usage: pair_bench FOLDER\n");
    return 2;
  }
  const std::string folder = std::string(argv[1]) + "/";
  bench::TableFile costs(folder + "pair_bench.csv", "pair,band,cold_ns,warm_ns\n");
  bench::TableFile places(folder + "pair_poses.csv",
                          "pair,band,sequence,shape_a,a1,a2,a3,shape_b,b1,b2,b3,ax,ay,az,aqw,aqx,aqy,aqz,"
                          "bx,by,bz,bqw,bqx,bqy,bqz,gap\n");
  std::printf("nanoseconds per query\n%-20s %-9s %8s %8s\n", "pair", "gaps", "cold", "warm");
  for (std::size_t i = 0; i < solids().size(); ++i)
    for (std::size_t j = i; j < solids().size(); ++j)
      for (const Band& band : kBands) measure(solids()[i], solids()[j], band, costs, places);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
