// Reads a problem from the file that native_peer.py writes for a compiled peer, times the peer and prints its
// result. SI units.
#pragma once

#include <algorithm>
#include <array>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace peers {

using Vec3 = std::array<double, 3>;
using Quat = std::array<double, 4>;  ///< w x y z, body to world

struct Body {
  double mass;
  Vec3 inertia, pos;  ///< principal moments, body axes; centre of mass
  Quat quat;
  Vec3 vel, omega;  ///< world axes
};
/// Ball joint: point ra of body a coincides with point rb of body b, both in body frames; the world is body
/// -1.
struct Joint {
  int a;
  Vec3 ra;
  int b;
  Vec3 rb;
};
struct Pose {
  Vec3 pos;
  Quat quat;
};

struct Problem {
  double end;
  Vec3 gravity;
  std::vector<Body> bodies;
  std::vector<Joint> tree;  ///< a is the parent; joints of parents precede those of children
  std::vector<Joint> loops;
};

inline Problem read_problem(const std::string& path) {
  std::ifstream in(path);
  Problem p;
  auto numbers = [&](auto& list) {
    for (double& x : list) in >> x;
  };
  auto joints = [&](std::vector<Joint>& list) {
    for (Joint& j : list) {
      in >> j.a;
      numbers(j.ra);
      in >> j.b;
      numbers(j.rb);
    }
  };
  std::size_t bodies = 0, tree = 0, loops = 0;
  in >> p.end;
  numbers(p.gravity);
  in >> bodies >> tree >> loops;
  p.bodies.resize(bodies);
  p.tree.resize(tree);
  p.loops.resize(loops);
  for (Body& b : p.bodies) {
    in >> b.mass;
    numbers(b.inertia);
    numbers(b.pos);
    numbers(b.quat);
    numbers(b.vel);
    numbers(b.omega);
  }
  joints(p.tree);
  joints(p.loops);
  if (!in) throw std::runtime_error("cannot read " + path);
  return p;
}

/// Calls prepare() and loop() until the loops have taken 0.2 s in total, at most 50 times. Returns the CPU
/// time of the fastest loop, s. prepare() is not timed.
template <class Prepare, class Loop>
double minimum_seconds(const Prepare& prepare, const Loop& loop) {
  double minimum = std::numeric_limits<double>::infinity(), spent = 0;
  for (int repeat = 0; repeat < 50 && spent < 0.2; ++repeat) {
    prepare();
    const std::clock_t start = std::clock();
    loop();
    const double seconds = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
    minimum = std::min(minimum, seconds);
    spent += seconds;
  }
  return minimum;
}

/// Prints the seconds, and a line with the pose of each body at the end.
inline void print_result(double seconds, const std::vector<Pose>& poses) {
  std::printf("%.9g\n", seconds);
  for (const Pose& p : poses)
    std::printf("%.17g %.17g %.17g %.17g %.17g %.17g %.17g\n", p.pos[0], p.pos[1], p.pos[2], p.quat[0],
                p.quat[1], p.quat[2], p.quat[3]);
}

}  // namespace peers
