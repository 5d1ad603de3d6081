// Simbody with its error-controlled integrators: ball mobilizers in a tree and ball constraints for loops, or
// free bodies with ball constraints for all joints.
//
//   simbody_peer PROBLEM tree|free INTEGRATOR ACCURACY     PROBLEM: file that native_peer.py writes;
//   ACCURACY: Simbody's error tolerance of a step
#include <cstring>
#include <exception>
#include <memory>

#include <Simbody.h>

#include "problem.h"

using namespace SimTK;

namespace {

Vec3 vec(const peers::Vec3& v) {
  return {v[0], v[1], v[2]};
}
Rotation rotation(const peers::Quat& q) {
  return Rotation(Quaternion(q[0], q[1], q[2], q[3]));
}

std::unique_ptr<Integrator> integrator(const std::string& name, const MultibodySystem& system) {
  if (name == "RungeKuttaMerson") return std::make_unique<RungeKuttaMersonIntegrator>(system);
  if (name == "RungeKuttaFeldberg") return std::make_unique<RungeKuttaFeldbergIntegrator>(system);
  if (name == "CPodesAdams") return std::make_unique<CPodesIntegrator>(system, CPodes::Adams);
  throw std::runtime_error("unknown integrator: " + name);
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 5) throw std::runtime_error("usage: simbody_peer PROBLEM tree|free INTEGRATOR ACCURACY");
  const peers::Problem problem = peers::read_problem(argv[1]);
  const bool tree = std::strcmp(argv[2], "tree") == 0 && !problem.tree.empty();

  MultibodySystem system;
  SimbodyMatterSubsystem matter(system);
  GeneralForceSubsystem forces(system);
  if (vec(problem.gravity).norm() > 0) Force::UniformGravity(forces, matter, vec(problem.gravity));
  std::vector<MobilizedBody> bodies(problem.bodies.size());
  auto solid = [&](int i) {
    const peers::Body& b = problem.bodies[static_cast<std::size_t>(i)];
    return Body::Rigid(MassProperties(b.mass, Vec3(0), Inertia(vec(b.inertia))));
  };
  auto at = [&](int i) -> MobilizedBody& {
    return i < 0 ? static_cast<MobilizedBody&>(matter.updGround()) : bodies[static_cast<std::size_t>(i)];
  };
  auto constrain = [&](const peers::Joint& j) { Constraint::Ball(at(j.a), vec(j.ra), at(j.b), vec(j.rb)); };
  if (tree) {
    for (const peers::Joint& j : problem.tree)
      at(j.b) = MobilizedBody::Ball(at(j.a), Transform(vec(j.ra)), solid(j.b), Transform(vec(j.rb)));
  } else {
    for (int i = 0; i < static_cast<int>(bodies.size()); ++i)
      at(i) = MobilizedBody::Free(matter.updGround(), Transform(), solid(i), Transform());
    for (const peers::Joint& j : problem.tree) constrain(j);
  }
  for (const peers::Joint& j : problem.loops) constrain(j);

  State start = system.realizeTopology();
  system.realizeModel(start);
  auto place = [&](int i, bool by_rotation) {
    const peers::Body& b = problem.bodies[static_cast<std::size_t>(i)];
    const MobilizedBody& body = at(i);
    const Transform X(rotation(b.quat), vec(b.pos));
    const MobilizedBody& parent = body.getParentMobilizedBody();
    system.realize(start, Stage::Position);
    const Transform relative = ~parent.getBodyTransform(start) * X;
    if (by_rotation)
      body.setQToFitRotation(start, relative.R());
    else
      body.setQToFitTransform(start, relative);
    system.realize(start, Stage::Velocity);
    const Vec3 omega = vec(b.omega) - parent.getBodyAngularVelocity(start);
    const Vec3 in_parent = ~parent.getBodyRotation(start) * omega;
    body.setUToFitAngularVelocity(start, in_parent);
    if (!by_rotation) body.setUToFitLinearVelocity(start, vec(b.vel));
  };
  if (tree)
    for (const peers::Joint& j : problem.tree) place(j.b, true);
  else
    for (int i = 0; i < static_cast<int>(bodies.size()); ++i) place(i, false);

  std::unique_ptr<Integrator> method;
  const double seconds = peers::minimum_seconds(
      [&] {
        method = integrator(argv[3], system);
        method->setAccuracy(std::atof(argv[4]));
        method->setFinalTime(problem.end);
        method->setReturnEveryInternalStep(false);
        method->initialize(start);
      },
      [&] {
        while (method->getTime() < problem.end && !method->isSimulationOver()) method->stepTo(problem.end);
      });
  const State& end = method->getState();
  system.realize(end, Stage::Position);
  std::vector<peers::Pose> poses;
  for (const MobilizedBody& body : bodies) {
    const Vec3 c = body.getBodyOriginLocation(end);
    const Quaternion q = body.getBodyRotation(end).convertRotationToQuaternion();
    poses.push_back({{c[0], c[1], c[2]}, {q[0], q[1], q[2], q[3]}});
  }
  peers::print_result(seconds, poses);
  return 0;
} catch (const std::exception& fault) {
  std::fprintf(stderr, "%s\n", fault.what());
  return 1;
}
