// The problems on which integration methods are compared, in SI units. Bodies are solid with a density of
// 1000 kg/m^3, and gravity is 9.81 m/s^2 along -z. Exceptions: A, dust, solid and assembly have no gravity,
// balloons are shells of 1 kg/m^2, and each rod of four-bars has a mass of 1 kg.
//
//   A          free ellipsoid with semi-axes 0.3, 0.2, 0.1 m that spins about its unstable axis
//   B          the ellipsoid of A, suspended at the tip of its long axis, with a sideways initial velocity
//   Cn         chain of n ellipsoids of A along x, released at rest; link i is rotated by 0.7 i rad about x
//   Dn         net of n x n touching spheres of radius 0.1 m on a wavy surface, pinned at two corners
//   dust       free spinning ellipsoid without stiffness of its semi-axes: every particle flies straight
//   solid      free tumbling superellipsoid whose semi-axes, taper, twist and bend are elastic
//   four-bars  row of 40 four-bar linkages ("windows") of rods on hinges, which rotate (IFToMM A02)
//   assembly   five ellipsoids with elastic semi-axes, initially apart; Baumgarte's method closes the joints
//   ringing    tumbling balloon of 432 triangles that vibrates while it falls
//   stiff      the balloon of ringing, suspended at its top by a ball joint, 1000 times as stiff, damped
//   bounce     ball that rebounds from a plane with restitution 0.8, in air with drag
//   see-saw    ball that falls onto one end of a board on a pivot and throws up another ball
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "linkage.h"

namespace pliant::bench {

struct Problem {
  std::string name;
  double end;  ///< end time, s
  /// Length of a body, m. Errors are distances of centres divided by this length. If the length is 0, errors
  /// are differences of all coordinates in the norm of ErrorScale.
  double length;
  bool long_running;  ///< whether work_precision measures the problem only with --all or --only
  std::function<void(MultiBody&)> build;
};

inline Problem chain_of(int n, bool long_running = false) {
  return {"C" + std::to_string(n), 2, kLinkLength, long_running, [n](MultiBody& body) {
            Linkage linkage(body);
            chain(linkage, n);
          }};
}
/// end: end time, s. The motion of nets is chaotic, so larger nets have shorter end times.
inline Problem net_of(int n, double end, bool long_running = false) {
  return {"D" + std::to_string(n), end, 2 * kNetRadius, long_running, [n](MultiBody& body) {
            Linkage linkage(body);
            net(linkage, n);
          }};
}

inline void free_ellipsoid(MultiBody& body) {
  body.gravity.setZero();
  Linkage linkage(body);
  linkage.link({-0.3, 0, 0}, Eigen::Quaterniond::Identity()).velocity({0, 0, 0}, {0.01, 5, 0.01});
}

inline void pendulum(MultiBody& body) {
  const Eigen::Quaterniond R(Eigen::AngleAxisd(kPi / 6, Vec3<double>::UnitY()));
  const Vec3<double> omega(0, 0, 3);
  Linkage linkage(body);
  Part& part = linkage.link({0, 0, 0}, R);
  part.velocity(omega.cross(part.c0()), R.conjugate() * omega);
  linkage.connect(world(0, 0, 0), Linkage::near_tip(part));
}

inline void dust(MultiBody& body) {
  body.gravity.setZero();
  Part& part = body.add<Primitive<Ellipsoid>>("dust");
  part.rest({{"a1", 0.3}, {"a2", 0.3}, {"a3", 0.2}}).stiffness({{"a1", 0}, {"a2", 0}, {"a3", 0}});
  part.velocity({0, 0, 0}, {0, 0, 2});
}

inline void tumbling_solid(MultiBody& body) {
  body.gravity.setZero();
  auto& part = body.add<Primitive<Superellipsoid, Chain<Taper, Twist, Bend>>>("solid");
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.5}, {"taper.tx", 0.2}});
  part.stiffness({{"a1", 3e4},
                  {"a2", 3e4},
                  {"a3", 3e4},
                  {"taper.tx", 1e3},
                  {"taper.ty", 1e3},
                  {"twist.angle", 500},
                  {"bend.angle", 500}});
  part.initial({{"a1", 0.32}, {"twist.angle", 0.3}, {"bend.angle", 0.2}}).velocity({1, 2, 3}, {2, 3, 1});
}

inline void four_bars(MultiBody& body) {
  constexpr int windows = 40;
  const Vec3<double> x(1, 0, 0), y(0, 1, 0), z(0, 0, 1);
  auto rod = [&](const std::string& name, const Vec3<double>& from, const Vec3<double>& to) -> Part& {
    const Vec3<double> along = (to - from).normalized();
    Mat3<double> R;
    R << y.cross(along), y, along;
    Part& part = body.add<Primitive<Box>>(name);
    part.rest({{"a1", 0.005}, {"a2", 0.005}, {"a3", (to - from).norm() / 2}}).mass(1);
    return part.place((from + to) / 2, Eigen::Quaterniond(R));
  };
  auto hinge = [&](const Point& a, const Point& b) {
    const Vec3<double> axis = b.part == nullptr ? y : Vec3<double>(b.part->R0().conjugate() * y);
    body.hinge("hinge" + std::to_string(body.joints().size()), a, b, axis);
  };
  auto start = [](const Part& part) { return point(part, -kPi / 2, 0); };
  auto end = [](const Part& part) { return point(part, kPi / 2, 0); };
  std::vector<Part*> upright;
  for (int i = 0; i <= windows; ++i) {
    upright.push_back(&rod("upright" + std::to_string(i), i * x, i * x + z));
    upright.back()->velocity(0.5 * x, y);
    hinge(start(*upright.back()), world(i, 0, 0));
  }
  for (int i = 0; i < windows; ++i) {
    const auto k = static_cast<std::size_t>(i);
    Part& bar = rod("bar" + std::to_string(i), i * x + z, (i + 1) * x + z);
    bar.velocity(x, {0, 0, 0});
    hinge(start(bar), end(*upright[k]));
    hinge(end(bar), end(*upright[k + 1]));
  }
}

inline void assembly(MultiBody& body) {
  body.gravity.setZero();
  Linkage linkage(body, true);
  Part& middle = linkage.link({-0.3, 0, 0}, Eigen::Quaterniond::Identity());
  for (int i = 0; i < 4; ++i) {
    const double angle = kPi / 4 + i * kPi / 2;
    const Vec3<double> direction(std::cos(angle), std::sin(angle), 0);
    const Eigen::Quaterniond R(Eigen::AngleAxisd(angle, Vec3<double>::UnitZ()) *
                               Eigen::AngleAxisd(0.5, Vec3<double>::UnitY()));
    const Part& wing = linkage.link(0.6 * direction, R);
    linkage.connect(point(middle, material_towards(direction)), Linkage::near_tip(wing));
  }
}

/// stiffness: Young's modulus, Pa. damping: LocalSettings::beta, s.
inline Part& balloon(MultiBody& body, double stiffness, double damping) {
  Part& part = body.add<Primitive<Sphere>>("balloon", 1.0);
  part.rest({{"r", 0.5}}).make_shell();
  LocalSettings settings;
  settings.resolution = 3;
  settings.energies = {local_law("membrane", {stiffness, 0.3, 0.01})};
  settings.beta = damping;
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return {X[1] * X[2], 0, 0}; };
  part.deform_locally(settings);
  return part;
}

inline void bounce(MultiBody& body) {
  body.add<Primitive<Sphere>>("ball")
      .rest({{"r", 0.1}})
      .damping(0, 0, 0.2)
      .place({0, 0, 1.1})
      .velocity({0.3, 0, 0}, {1, 2, 3});
  body.contact.active = true;
  body.contact.restitution = 0.8;
  body.contact.planes.emplace_back().name = "floor";
}

inline void see_saw(MultiBody& body) {
  Part& board = body.add<Primitive<Box>>("board");
  board.rest({{"a1", 1}, {"a2", 0.2}, {"a3", 0.03}});
  body.hinge("pivot", world(0, 0, 0), point(board, 0, 0, 0), Vec3<double>::UnitY());
  body.add<Primitive<Sphere>>("faller").rest({{"r", 0.1}}).place({0.7, 0, 1});
  body.add<Primitive<Sphere>>("flyer").rest({{"r", 0.1}}).place({-0.7, 0, 0.2});
  body.contact.active = true;
}

/// Returns all problems in order.
inline std::vector<Problem> problems() {
  return {{"A", 10, 0, false, free_ellipsoid},
          {"B", 10, kLinkLength, false, pendulum},
          chain_of(2),
          chain_of(8),
          chain_of(32),
          chain_of(128),
          net_of(4, 1),
          net_of(8, 0.5),
          {"dust", 3, 0, false, dust},
          {"solid", 0.4, 0, false, tumbling_solid},
          {"four-bars", 1, 1, false, four_bars},
          {"assembly", 0.5, 0, false, assembly},
          {"ringing", 1, 0, false,
           [](MultiBody& body) {
             balloon(body, 1e5, 0).velocity({0, 0, 0}, {0.1, 0.2, 0.3});
           }},
          {"stiff", 1, 0, false,
           [](MultiBody& body) {
             Part& part = balloon(body, 1e8, 1e-4);
             part.velocity({0, 0.5, 0}, {0.1, 0.2, 0.3});
             body.ball("string", world(0, 0, 0.5), point(part, kPi / 2, 0));
           }},
          {"bounce", 2, 0.2, false, bounce},
          {"see-saw", 0.8, 0.2, false, see_saw},
          chain_of(512, true),
          net_of(16, 0.25, true)};
}

}  // namespace pliant::bench
