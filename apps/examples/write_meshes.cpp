// Two parts hang on springs, one below the other. The program writes the surface of the upper part as meshes.
#include <cstdio>
#include <filesystem>

#include <pliant/io/format/obj.h>
#include <pliant/pliant.h>

using namespace pliant;

int main(int argc, char** argv) {
  const std::filesystem::path folder = argc > 1 ? argv[1] : "out/meshes";

  MultiBody body;
  body.gravity = {0, 0, -9.81};

  auto& upper = body.add<Primitive<Superellipsoid, Chain<Taper, Bend>>>("upper", 1000.0);  // kg/m^3
  upper.place({0, 0, -0.5});
  upper.rest({{"a1", 0.15}, {"a2", 0.15}, {"a3", 0.5}, {"taper.tx", 0.2}});
  upper.stiffness(
      {{"a1", 4e5}, {"a2", 4e5}, {"a3", 4e5}, {"taper.tx", 2e3}, {"taper.ty", 2e3}, {"bend.angle", 2e3}});
  upper.damping(0, 1e-3);

  auto& lower = body.add<Primitive<Ellipsoid>>("lower", 1000.0);  // no dynamic parameter: rigid
  lower.place({0, 0, -1.4});
  lower.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.4}});

  const double top = kPi / 2, bottom = -kPi / 2;  // latitude u of the poles
  body.spring("hook", world(0, 0, 0), point(upper, top, 0), 1e5, 100);
  body.spring("link", point(upper, bottom, 0), point(lower, top, 0), 1e5, 100);
  body.force("push", point(lower, 0, 0), {TimeFunction::formula("50 * sin(2 * pi * t)"), 0, 0});

  Simulation simulation(body, "rk4");
  const Surface surface(upper, 8);
  for (int k = 0; k < 1000; ++k) {
    simulation.step(1e-3);
    if (k % 100 == 99) write_obj(folder / frame_name("upper", k / 100, "obj"), simulation, upper, surface);
  }
  const Ledger ledger = simulation.ledger();
  std::printf("t = %.3f s, energy %.3f J, balance error %.1e J\n", simulation.time(), ledger.energy(),
              ledger.balance);
}
