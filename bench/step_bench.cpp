// Time of a step of semi-implicit Euler and of an evaluation of the accelerations, divided by the number of
// parts. All parts of a run are of one kind, and their number is 1, 10 or 1000. Writes CSV to standard
// output. The last column is the number of multiply-adds that this machine could perform at its measured peak
// in the time of an evaluation per part.
#include <cstdio>
#include <memory>
#include <string>

#include <pliant/pliant.h>

#include "timing.h"

using namespace pliant;

namespace {

using Soft = Superellipsoid;

void rigid(MultiBody& body, const std::string& name) {
  auto& part = body.add<Primitive<Ellipsoid>>(name);
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).velocity({0, 0, 0}, {1, 2, 3});
}
/// Adds a rigid part with a frozen deformation that is the identity. It must not cost more than the part of
/// rigid().
void rigid_null(MultiBody& body, const std::string& name) {
  auto& part = body.add<Primitive<Ellipsoid, Chain<Twist>>>(name);
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}, {"twist.angle", 0}}).velocity({0, 0, 0}, {1, 2, 3});
}
void three(MultiBody& body, const std::string& name) {
  auto& part = body.add<Primitive<Ellipsoid>>(name);
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).velocity({0, 0, 0}, {1, 2, 3});
  part.stiffness({{"a1", 1e4}, {"a2", 1e4}, {"a3", 1e4}}).initial_rate({{"a1", 0.1}, {"a2", 0}, {"a3", 0}});
}
/// Adds a part with three parameters and frozen deformations that are the identity. It must cost at most 5 %
/// more than the part of three().
void three_null(MultiBody& body, const std::string& name) {
  auto& part = body.add<Primitive<Ellipsoid, Chain<Taper, Bend>>>(name);
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}, {"bend.direction", 0.3}}).velocity({0, 0, 0}, {1, 2, 3});
  part.stiffness({{"a1", 1e4}, {"a2", 1e4}, {"a3", 1e4}}).initial_rate({{"a1", 0.1}, {"a2", 0}, {"a3", 0}});
}
void eleven(MultiBody& body, const std::string& name) {
  auto& part = body.add<Primitive<Soft, Chain<Taper, Twist, Shear, BendOffset, Bend>>>(name);
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.5}, {"bend.direction", 0.3}}).velocity({0, 0, 0}, {1, 2, 3});
  part.stiffness({{"a1", 1e5},
                  {"a2", 1e5},
                  {"a3", 1e5},
                  {"taper.tx", 1e3},
                  {"taper.ty", 1e3},
                  {"twist.angle", 1e3},
                  {"shear.sx", 1e4},
                  {"shear.sy", 1e4},
                  {"bend.angle", 1e3},
                  {"bend.direction", 1e2},
                  {"bend_offset.b1", 1e5}});
  part.initial({{"bend.angle", 0.2}, {"twist.angle", 0.1}});
}

/// Adds a part whose exponents are dynamic over their whole ranges. The exponents change the shape of every
/// curve u = const on the surface, so the mass points are those of the full quadrature rule.
void exponents(MultiBody& body, const std::string& name) {
  auto& part = body.add<Primitive<Soft>>(name);
  part.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.5}}).velocity({0, 0, 0}, {1, 2, 3});
  part.stiffness({{"a1", 1e5}, {"eps1", 1e3}, {"eps2", 1e3}});
}

void measure(const char* kind, void (*add)(MultiBody&, const std::string&), int parts, double peak) {
  MultiBody body;
  for (int i = 0; i < parts; ++i) add(body, "part" + std::to_string(i));
  Simulation simulation(body, "semi_implicit_euler");
  const State start = simulation.state();
  for (int i = 0; i < 20; ++i) simulation.step(1e-4);
  const double step = bench::seconds_per_call([&] { simulation.step(1e-9); }) / parts;
  Workspace<double> work;
  const double evaluation = bench::seconds_per_call([&] {
                              simulation.dynamics().accelerations(0, start.q, start.v, start, work);
                            }) /
                            parts;
  const Part& first = *body.parts()[0];
  std::printf("%s,%d,%d,%s,%d,%.4f,%.4f,%.0f\n", kind, first.n_s(), parts, first.mass_points().rule.c_str(),
              first.mass_points().n_points, step * 1e6, evaluation * 1e6, evaluation * peak);
  std::fflush(stdout);
}

}  // namespace

int main() {
  const double peak = bench::multiply_add_peak();
  std::printf("# multiply-adds per second %.3g, triad %.3g bytes/s\n", peak, bench::triad_bandwidth());
  std::printf(
      "part,n_s,parts,rule,points,step_us_per_part,evaluation_us_per_part,evaluation_multiply_adds\n");
  for (const int parts : {1, 10, 1000}) {
    measure("rigid", rigid, parts, peak);
    measure("rigid with a null twist", rigid_null, parts, peak);
    measure("3 parameters", three, parts, peak);
    measure("3 parameters with a null taper and bend", three_null, parts, peak);
    measure("11 parameters", eleven, parts, peak);
  }
  measure("3 parameters, exponents among them", exponents, 1, peak);
}
