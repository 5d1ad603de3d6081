// Adds a shape: an egg, in one struct. The engine simulates the egg like any other shape.
#include <cstdio>

#include <pliant/pliant.h>

using namespace pliant;

// e(u; r, k) = w r ((1 - k S_u) C_u C_v, (1 - k S_u) C_u S_v, S_u): a ball of radius r, pointed upwards by k.
struct Egg {
  static constexpr const char* name = "egg";
  static constexpr const char* formula = "w r ((1 - k S_u) C_u C_v, (1 - k S_u) C_u S_v, S_u)";
  static constexpr std::array<ParameterSpec, 2> parameters{
      {length("r", 1, "half height"),
       ratio("k", 0.2, {-0.9, 0.9}, {-0.9, 0.9}, "pointedness", Follows::ring)}};
  static constexpr MeshPattern mesh = MeshPattern::ball;

  template <class T, class U>
  static Vec3<T> e(const Material<U>& m, const Vec<T, 2>& a) {
    const T ring = (T(1) - a[1] * m.su.x) * a[0] * U(m.w * m.cu.x);
    return {ring * m.cv.x, ring * m.sv.x, a[0] * U(m.w * m.su.x)};
  }
  template <class T>
  static T half_height(const Vec<T, 2>& a) {
    return a[0];
  }
};

int main() {
  MultiBody body;
  auto& egg = body.add<Primitive<Egg, Chain<Twist>>>("egg", 1000.0);
  egg.rest({{"r", 0.05}}).stiffness({{"k", 0.5}, {"twist.angle", 0.05}}).velocity({0, 0, 3}, {5, 2, 0});
  Simulation simulation(body, "rk4");
  for (int i = 0; i < 500; ++i) simulation.step(1e-3);
  std::printf("mass %.4f kg, energy balance error %.1e J\n", egg.total_mass(), simulation.ledger().balance);
}
