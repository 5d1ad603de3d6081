// The systems of contact_bench: solids of every shape, some of them deformed, in several layouts.
#pragma once

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <pliant/pliant.h>

namespace pliant::bench {

/// A kind of solid: its shape, its chain of deformations, and a function that returns the rest values of its
/// parameters. The arguments of the function are three quasi-random numbers in [0, 1), which vary the sizes.
struct Kind {
  const char *name, *shape;
  std::vector<std::string> chain;
  Part::Named (*rest)(double a, double b, double c);
  bool is_soft = false;  ///< whether the parameters a1, a2 and a3 are dynamic
};

inline Part::Named axes(double a, double b, double c) {
  return {{"a1", 0.06 + 0.04 * a}, {"a2", 0.06 + 0.04 * b}, {"a3", 0.06 + 0.04 * c}};
}
inline Part::Named rod(double a, double, double c) {
  return {{"r", 0.04 + 0.02 * a}, {"l", 0.06 + 0.04 * c}};
}
inline Part::Named ring(double a, double, double c) {
  const double tube = 0.02 + 0.01 * a;
  return {{"a1", tube}, {"a2", tube}, {"a3", 0.02 + 0.01 * c}, {"a4", 3}};
}
inline Part::Named ball(double a, double, double) {
  return {{"r", 0.06 + 0.04 * a}};
}
inline Part::Named with(Part::Named rest, const char* name, double value) {
  rest.push_back({name, value});
  return rest;
}
template <int eps1, int eps2>  // exponents in tenths
Part::Named superquadric(double a, double b, double c) {
  return with(with(axes(a, b, c), "eps1", 0.1 * eps1), "eps2", 0.1 * eps2);
}

inline const std::vector<Kind>& kinds() {
  using d = double;
  static const std::vector<Kind> all{
      {"ellipsoid", "ellipsoid", {}, axes},
      {"ellipsoid with 3 parameters", "ellipsoid", {}, axes, true},
      {"ball", "sphere", {}, ball},
      {"box", "box", {}, axes},
      {"cylinder", "cylinder", {}, axes},
      {"cone", "cone", {}, [](d a, d b, d c) { return with(axes(a, b, c), "t", -0.5); }},
      {"capsule", "capsule", {}, rod},
      {"superellipsoid 1", "superellipsoid", {}, superquadric<10, 10>},
      {"superellipsoid 0.5", "superellipsoid", {}, superquadric<5, 5>},
      {"superellipsoid 0.1", "superellipsoid", {}, superquadric<1, 1>},
      {"superellipsoid 1.5", "superellipsoid", {}, superquadric<15, 15>},
      {"radial superellipsoid 0.5", "superellipsoid_radial", {}, superquadric<5, 5>},
      {"superellipsoid 0.5 with 3 parameters", "superellipsoid", {}, superquadric<5, 5>, true},
      {"supertoroid", "supertoroid", {}, ring},
      {"sheared cylinder",
       "cylinder",
       {"shear"},
       [](d a, d b, d c) { return with(axes(a, b, c), "shear.sx", 0.3); }},
      {"tapered ellipsoid",
       "ellipsoid",
       {"taper"},
       [](d a, d b, d c) { return with(axes(a, b, c), "taper.tx", -0.3); }},
      {"tapered ellipsoid with 3 parameters",
       "ellipsoid",
       {"taper"},
       [](d a, d b, d c) { return with(axes(a, b, c), "taper.tx", -0.3); },
       true},
      {"twisted box",
       "box",
       {"twist"},
       [](d a, d b, d c) { return with(axes(a, b, c), "twist.angle", 0.5); }},
      {"bent capsule", "capsule", {"bend"}, [](d a, d b, d c) {
         return with(rod(a, b, c), "bend.angle", 0.5);
       }}};
  return all;
}

/// plane: side by side on a plane; heap: five layers on a plane; pairs: two bodies that a spring pulls
/// together, without gravity; bowl: ten bodies in each hollow of a mesh; towers, pyramids: of ten boxes each.
enum class Layout { plane, heap, pairs, bowl, towers, pyramids };

struct System {
  std::string name;
  Layout layout;
  const Kind* kind = nullptr;  ///< not used for towers and pyramids
};

/// Returns every kind of solid in every layout, and towers and pyramids.
inline std::vector<System> systems() {
  std::vector<System> all{{"towers of ten", Layout::towers}, {"pyramids of ten", Layout::pyramids}};
  const std::pair<const char*, Layout> layouts[] = {
      {"plane", Layout::plane}, {"heap", Layout::heap}, {"pairs", Layout::pairs}, {"bowl", Layout::bowl}};
  for (const auto& [name, layout] : layouts)
    for (const Kind& kind : kinds()) all.push_back({std::string(kind.name) + ", " + name, layout, &kind});
  return all;
}

/// Returns the fractional part of (i + 1) * ratio: a quasi-random number in [0, 1).
inline double spread(int i, double ratio) {
  return std::fmod((i + 1) * ratio, 1.0);
}

/// Returns the number of columns of the smallest square arrangement with room for n bodies.
inline int columns(double n) {
  return static_cast<int>(std::ceil(std::sqrt(n)));
}

/// Adds solid number i in a quasi-random orientation, at most 0.11 m from `place` (world, m).
inline Part& add_solid(MultiBody& body, const Kind& kind, int i, const Vec3<double>& place) {
  const double a = spread(i, 0.6180339887498949), b = spread(i, 0.7548776662466927),
               c = spread(i, 0.5698402909980532);
  Part& part = body.add(make_part("body" + std::to_string(i), kind.shape, kind.chain, 1000));
  part.rest(kind.rest(a, b, c));
  const Vec3<double> axis = Vec3<double>(a - 0.5, b - 0.5, c - 0.4).normalized();
  part.place(place + Vec3<double>(0.02 * a, 0.02 * b, 0.1 * c),
             Eigen::Quaterniond(Eigen::AngleAxisd(6 * a, axis)));
  if (kind.is_soft) part.stiffness({{"a1", 3e4}, {"a2", 3e4}, {"a3", 3e4}}).damping(0, 2e-3);
  return part;
}

/// Adds n solids in layers over a plane. The solids do not touch each other at the start.
inline void add_layers(MultiBody& body, const Kind& kind, int n, int layers) {
  const int across = columns(static_cast<double>(n) / layers);
  // Undeformed ellipsoids need less room than solids with corners, rims or deformations.
  const bool is_round = kind.chain.empty() && std::string(kind.shape) == "ellipsoid";
  const double apart = is_round ? 0.25 : 0.45, above = is_round ? 0.35 : 0.45;
  for (int i = 0; i < n; ++i) {
    const int layer = i / (across * across), place = i % (across * across);
    add_solid(body, kind, i, {apart * (place % across), apart * (place / across), 0.15 + above * layer});
  }
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}

/// Adds n / 2 pairs. A damped spring between the centres presses the bodies of a pair together.
inline void add_pairs(MultiBody& body, const Kind& kind, int n) {
  const int across = columns(n / 2.0);
  body.gravity.setZero();
  for (int i = 0; i + 1 < n; i += 2) {
    const Vec3<double> place(2.0 * (i / 2 % across), 2.0 * (i / 2 / across), 0);
    const Part& a = add_solid(body, kind, i, place);
    const Part& b = add_solid(body, kind, i + 1, place + Vec3<double>(0.45, 0, 0));
    body.spring("spring" + std::to_string(i), point(a, 0, 0, 0), point(b, 0, 0, 0), 100, 5);
  }
  body.contact.active = true;
}

/// Adds a mesh with hollows of 1 m x 1 m that are 0.3 m deep, and n solids, ten of them above each hollow.
inline void add_bowls(MultiBody& body, const Kind& kind, int n) {
  constexpr int cells = 12;  // number of cells of a hollow in x and in y
  const int across = columns(n / 10.0), side = across * cells + 1;
  Eigen::Matrix3Xd x(3, side * side);
  for (int i = 0; i < x.cols(); ++i) {
    const double u = static_cast<double>(i % side) / cells, v = static_cast<double>(i / side) / cells;
    x.col(i) << u, v, 0.075 * (2 + std::cos(2 * kPi * u) + std::cos(2 * kPi * v));
  }
  Eigen::Matrix3Xi triangles(3, 2 * (side - 1) * (side - 1));
  for (int k = 0, column = 0; k < (side - 1) * side; ++k) {
    if (k % side == side - 1) continue;
    triangles.col(column++) << k, k + 1, k + side;
    triangles.col(column++) << k + 1, k + side + 1, k + side;
  }
  body.obstacle("bowl", x, triangles);
  for (int i = 0; i < n; ++i) {
    const int bowl = i / 10, place = i % 10, layer = place / 4;
    add_solid(body, kind, i,
              {bowl % across + 0.28 + 0.44 * (place % 2), bowl / across + 0.28 + 0.44 * (place / 2 % 2),
               0.45 + 0.45 * layer});
  }
}

/// Adds cube number i. centre: in units of half the side of a cube.
inline void add_box(MultiBody& body, int i, const Vec3<double>& centre) {
  constexpr double half = 0.05;
  body.add(make_part("body" + std::to_string(i), "box", {}, 1000))
      .rest({{"a1", half}, {"a2", half}, {"a3", half}})
      .place(half * centre);
}

/// Adds towers of ten boxes.
inline void add_towers(MultiBody& body, int n) {
  const int across = columns(n / 10.0);
  for (int i = 0; i < n; ++i)
    add_box(body, i, Vec3<double>(5.0 * (i / 10 % across), 5.0 * (i / 10 / across), 1 + 2 * (i % 10)));
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}

/// Adds pyramids with rows of 4, 3, 2 and 1 boxes.
inline void add_pyramids(MultiBody& body, int n) {
  for (int first = 0; first < n; first += 10)
    for (int row = 0, i = first; row < 4; ++row)
      for (int k = 0; k < 4 - row; ++k, ++i)
        add_box(body, i, Vec3<double>(2.1 * k + 1.05 * row, 0.5 * first, 1 + 2 * row));
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
}

/// Adds a system of n bodies to a MultiBody. n: a multiple of 10.
inline void build(MultiBody& body, const System& system, int n) {
  switch (system.layout) {
    case Layout::plane:
      return add_layers(body, *system.kind, n, 1);
    case Layout::heap:
      return add_layers(body, *system.kind, n, 5);
    case Layout::pairs:
      return add_pairs(body, *system.kind, n);
    case Layout::bowl:
      return add_bowls(body, *system.kind, n);
    case Layout::towers:
      return add_towers(body, n);
    case Layout::pyramids:
      return add_pyramids(body, n);
  }
}

}  // namespace pliant::bench
