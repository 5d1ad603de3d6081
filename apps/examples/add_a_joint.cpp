// Adds a joint: a bead on a helical wire, in one struct. The solver treats the joint like any other joint.
#include <cstdio>

#include <pliant/pliant.h>

using namespace pliant;

// C = (x - r cos(k z), y - r sin(k z)) for a point (x, y, z) of a part, which stays on the wire. r: radius of
// the helix, m; k: its angle per height, rad/m.
struct Wire {
  static constexpr const char* name = "wire";
  static constexpr const char* formula = "(x - r cos(k z), y - r sin(k z)) = 0";
  // first, second: numbers of points on the first and on the second side
  static constexpr int rows = 2, first = 1, second = 0;
  static constexpr bool one_sided = false;
  double r, k;

  template <class T>
  Vec<T, rows> C(const std::array<Vec3<T>, 1>& x, const T& /*t*/) const {
    const T angle = x[0][2] * T(k);
    return {x[0][0] - math::cos(angle) * T(r), x[0][1] - math::sin(angle) * T(r)};
  }
};

int main() {
  MultiBody body;
  auto& bead = body.add<Primitive<Sphere>>("bead", 1000.0);
  bead.rest({{"r", 0.05}}).place({0.5, 0, 0});
  body.join("wire", Wire{0.5, 8}, {point(bead, 0, 0, 0)});
  Simulation simulation(body, "rk4");
  for (int i = 0; i < 1000; ++i) simulation.step(1e-3);
  std::printf("fell to z = %.4f m, gap %.0e m, energy balance error %.1e J\n", simulation.state().q[2],
              simulation.model().gap(simulation.state(), 0), simulation.ledger().balance);
}
