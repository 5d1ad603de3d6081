// Adds a deformation: a wave along the axis, in one struct. Chains accept the wave like other deformations.
#include <cstdio>

#include <pliant/pliant.h>

using namespace pliant;

// T(p, h; b): (x + size h sin(pi waves zeta), y, z), zeta = z / h.
struct Wave {
  static constexpr const char* name = "wave";
  static constexpr const char* formula = "(x + size h sin(pi waves zeta), y, z)";
  static constexpr std::array<ParameterSpec, 2> parameters{
      {ratio("size", 0, {-2, 2}, {-2, 2}, "amplitude of the wave divided by h", Follows::section),
       ratio("waves", 2, {0.1, 20}, {0.1, 20}, "half waves between zeta = 0 and 1", Follows::section)}};
  static constexpr Sections sections = Sections::stay_plane;

  template <class T>
  static Vec3<T> apply(const Vec3<T>& p, const T& h, const Vec<T, 2>& b) {
    return {p[0] + b[0] * h * math::sin(T(b[1] * p[2] / h * kPi)), p[1], p[2]};
  }
  template <class T>
  static Vec3<T> inverse(const Vec3<T>& p, const T& h, const Vec<T, 2>& b) {
    return {p[0] - b[0] * h * math::sin(T(b[1] * p[2] / h * kPi)), p[1], p[2]};
  }
};

int main() {
  MultiBody body;
  auto& eel = body.add<Primitive<Superellipsoid, Chain<Taper, Wave>>>("eel", 1000.0);
  eel.rest({{"a1", 0.05}, {"a2", 0.1}, {"a3", 0.5}, {"taper.tx", -0.5}, {"taper.ty", -0.5}});
  eel.stiffness({{"wave.size", 200}}).initial({{"wave.size", 0.2}});
  Simulation simulation(body, "rk4");
  for (int i = 0; i < 500; ++i) simulation.step(1e-3);
  std::printf("mass %.4f kg, energy balance error %.1e J\n", eel.total_mass(), simulation.ledger().balance);
}
