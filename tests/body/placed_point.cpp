// A PlacedPoint, which is evaluated at many states, agrees with a direct evaluation.
#include <pliant/body/placed_point.h>

#include <pliant/part/local/local_laws.h>
#include <pliant/part/registry.h>
#include <pliant/simulate/simulation.h>

#include "catch.h"

namespace placed_point_test {

using namespace pliant;

TEST_CASE(
    "placed points agree with Model::world_point, with and without local deformation, and follow a "
    "prescribed path") {
  MultiBody body;
  Part& soft = body.add(make_part("soft", "ellipsoid", {"twist"}, 1000));
  soft.stiffness({{"twist.angle", 100}}).place({0, 1, 0}).velocity({1, 0, 0}, {1, 2, 3});
  LocalSettings settings;
  settings.resolution = 2;
  settings.energies = {local_law("elastic", {1e5, 0.3})};
  settings.velocity = [](const Vec3<double>& X) { return Vec3<double>(X[2] * X[2], 0, X[0] * X[1]); };
  soft.deform_locally(std::move(settings));
  Part& plain = body.add(make_part("plain", "box", {"taper"}, 1000));
  plain.initial({{"taper.tx", 0.2}}).stiffness({{"taper.tx", 500}});
  Simulation simulation(body, "rk4");
  const Model& model = simulation.model();
  const Point moving = world(TimeVector(TimeFunction::formula("3 * t"), 0, 1));
  const PlacedPoint in_soft(model, point(soft, 0.3, 0.4, 0.7)), on_plain(model, point(plain, 1, 2)),
      in_world(model, moving);
  for (int i = 0; i < 20; ++i) {
    simulation.step(1e-3);
    const State& state = simulation.state();
    CHECK(in_soft.at(state) == model.world_point(state, 0, in_soft.point().material));
    CHECK(on_plain.at(state) == model.world_point(state, 1, on_plain.point().material));
    CHECK(in_world.at(state) == Vec3<double>(3 * state.time(), 0, 1));
  }
  // The nodes have moved, so that the point differs from the point of the reference shape s.
  const NodeWeights weights = Model::node_weights(in_soft.point());
  CHECK_FALSE(weights.node.empty());
  CHECK((model.world_point(simulation.state(), 0, in_soft.point().material, {}) -
         in_soft.at(simulation.state()))
            .norm() > 1e-6);
  CHECK(Model::node_weights(on_plain.point()).node.empty());
}

}  // namespace placed_point_test
