// The scene scenes/two_parts.json in C++: an arm that bends and stretches, and a ball, on two ball joints.
#include <cstdio>

#include <pliant/pliant.h>

using namespace pliant;

int main() {
  MultiBody body;  // its gravity is (0, 0, -9.81) m/s^2

  auto& arm = body.add<Primitive<Superellipsoid, Chain<Taper, Bend>>>("arm", 1000.0);  // kg/m^3
  arm.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.4}, {"eps1", 0.6}, {"eps2", 0.6}});     // m, m, m, 1, 1
  arm.rest({{"taper.tx", 0.4}, {"taper.ty", 0.4}});
  arm.stiffness({{"a3", 5000}, {"bend.angle", 40}});  // N/m, N m; these two become degrees of freedom
  arm.damping(0, 0.01);                               // D = alpha M + beta K: alpha (1/s), beta (s)
  arm.place({0.4, 0, 1.4}, Eigen::Quaterniond(Eigen::AngleAxisd(-kPi / 2, Eigen::Vector3d::UnitY())));

  auto& ball = body.add<Primitive<Ellipsoid>>("ball", 1000.0);  // a rigid part: it has no dynamic parameter
  ball.rest({{"a1", 0.15}, {"a2", 0.15}, {"a3", 0.2}}).place({0.8, 0, 1.2});

  const double top = kPi / 2, bottom = -kPi / 2;  // the latitude u of the two poles of a surface
  body.ball("shoulder", world(0, 0, 1.4), point(arm, top, 0));
  body.ball("wrist", point(arm, bottom, 0), point(ball, top, 0));

  Simulation simulation(body, "rk4");
  for (int i = 0; i < 3000; ++i) simulation.step(1e-3);
  const Ledger ledger = simulation.ledger();
  std::printf("t = %.3f s, energy %.6f J, balance error %.1e J, gap of the wrist %.1e m\n", simulation.time(),
              ledger.energy(), ledger.balance, simulation.model().gap(simulation.state(), 1));
}
