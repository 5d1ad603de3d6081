// pliant info: prints the parts, joints, degrees of freedom and largest stable step of a scene without
// simulating it.
#include <cmath>
#include <iostream>
#include <memory>

#include <pliant/body/placed_point.h>
#include <pliant/collision/mesh/obstacle_mesh.h>
#include <pliant/io/format/number_text.h>
#include <pliant/io/run/joint_notes.h>
#include <pliant/io/run/run.h>
#include <pliant/io/run/skipped.h>
#include <pliant/simulate/stable_step.h>

#include "command.h"
#include "exit_codes.h"
#include "scene_options.h"

namespace pliant_cli {
namespace {

using pliant::Vec3;

// Returns 0 if |x| is at most 1e-12 scale, the size of rounding errors; otherwise returns x.
double rounded(double x, double scale) {
  return std::abs(x) <= 1e-12 * scale ? 0 : x;
}

void print_vector(const Vec3<double>& x, double scale = 0) {
  std::cout << "(" << rounded(x[0], scale) << ", " << rounded(x[1], scale) << ", " << rounded(x[2], scale)
            << ")";
}

void print_parameters(const pliant::Part& part) {
  const pliant::Parameters& parameters = part.parameters();
  for (int i = 0; i < parameters.size(); ++i) {
    const pliant::Parameter& p = parameters[i];
    std::cout << (i == 0 ? "  parameters: " : ", ") << p.name << " = " << p.rest_value();
    if (p.dynamic) std::cout << " (dynamic, initial value " << p.initial << ")";
  }
  if (parameters.size() > 0) std::cout << "\n";
}

void print_part(const pliant::PartModel& model) {
  const pliant::Part& part = *model.part;
  std::cout << "part " << part.name() << ": " << part.shape().name();
  for (const pliant::LinkInfo& link : part.parameters().all_links()) std::cout << " > " << link.type;
  std::cout << (part.shell() ? ", shell" : "") << "\n";
  print_parameters(part);
  const int frozen = part.parameters().size() - part.parameters().n_dynamic();
  if (part.motion() != nullptr)
    std::cout << "  prescribed motion: no degrees of freedom\n";
  else if (part.fixed())
    std::cout << "  fixed: no degrees of freedom\n";
  else
    std::cout << "  degrees of freedom: " << part.n_v() << " (6 of the frame, "
              << pliant::count_text(part.n_s(), "dynamic parameter")
              << (part.local() != nullptr ? "; " + part.local()->description() : "") << "), "
              << pliant::count_text(frozen, "parameter") << " frozen\n";
  const pliant::Inertia<double>& inertia = part.rest_inertia();
  const Vec3<double> centre =
      inertia.mass > 0 ? Vec3<double>(inertia.moment / inertia.mass) : Vec3<double>(0, 0, 0);
  std::cout << "  mass " << inertia.mass << " kg, centre of mass ";
  print_vector(centre, part.size());
  std::cout << " m in its frame, size " << part.size() << " m\n";
  if (inertia.M.rows() >= 6) {
    // About the centre of mass r: I_c = I_o - m (|r|^2 1 - r r^T), with I_o about the origin of the frame.
    const pliant::Mat3<double> about_origin = inertia.M.block<3, 3>(3, 3);
    const pliant::Mat3<double> about_centre =
        about_origin - inertia.mass * (centre.squaredNorm() * pliant::Mat3<double>::Identity() -
                                       centre * centre.transpose());
    const double scale = about_centre.diagonal().maxCoeff();
    std::cout << "  inertia about the centre of mass (kg m^2): xx " << about_centre(0, 0) << ", yy "
              << about_centre(1, 1) << ", zz " << about_centre(2, 2) << ", xy "
              << rounded(about_centre(0, 1), scale) << ", xz " << rounded(about_centre(0, 2), scale)
              << ", yz " << rounded(about_centre(1, 2), scale) << "\n";
  }
  if (part.continuum() != nullptr) {
    const pliant::ContinuumSettings& law = part.continuum()->settings();
    const pliant::StrainPoints& strained = part.continuum()->points();
    std::cout << "  elasticity: " << law.law << ", E " << law.E << " Pa, nu " << law.nu_P
              << "; strain points: " << strained.n_points << ", rule \"" << strained.rule << "\"";
    if (strained.relative_error > 0)
      std::cout << " with a relative error of about " << pliant::rounded_text(strained.relative_error);
    std::cout << "\n";
  }
  const pliant::MassPoints& points = part.mass_points();
  if (!points.rule.empty())
    std::cout << "  mass points: " << points.n_points << ", rule \"" << points.rule << "\" of level "
              << points.level
              << (points.relative_error > 0
                      ? " with a relative error of about " + pliant::rounded_text(points.relative_error)
                      : "")
              << "\n";
}

void print_obstacles(const pliant::MultiBody& body) {
  for (const pliant::ContactObstacle& obstacle : body.contact.obstacles) {
    const pliant::ObstacleMesh mesh(obstacle.vertices, obstacle.triangles);
    std::cout << "obstacle " << obstacle.name << ": "
              << pliant::count_text(mesh.triangles().cols(), "triangle")
              << (mesh.closed() ? ", closed" : ", open: bodies pass through it from behind") << ", from ";
    print_vector(mesh.box().min());
    std::cout << " to ";
    print_vector(mesh.box().max());
    std::cout << " m\n";
  }
}

void print_point(const pliant::Simulation& simulation, const pliant::Point& point) {
  if (point.part == nullptr) {
    std::cout << "world ";
    print_vector(point.world.value(0));
    return;
  }
  const pliant::MaterialAngles at = pliant::angles(point.material);
  std::cout << point.part->name() << " {u: " << at.u << ", v: " << at.v << ", w: " << at.w << "} at ";
  print_vector(pliant::PlacedPoint(simulation.model(), point).at(simulation.state()), point.part->size());
  if (point.patch > 0)
    std::cout << ", weighted mean over a patch of " << pliant::Model::node_weights(point).node.size()
              << " nodes";
}

void print_forces(const pliant::Scene& scene, const pliant::Simulation& simulation) {
  for (const auto& spring : scene.body.springs()) {
    std::cout << "spring " << spring->name << ": ";
    print_point(simulation, spring->a);
    std::cout << " to ";
    print_point(simulation, spring->b);
    if (spring->is_constant())
      std::cout << ", " << spring->stiffness.constant() << " N/m, " << spring->damping.constant()
                << " N s/m\n";
    else
      std::cout << ", a muscle\n";
  }
  for (const auto& force : scene.body.forces()) {
    std::cout << "force " << force->name << ": ";
    print_point(simulation, force->at);
    std::cout << "\n";
  }
  for (const auto& force : scene.body.distributed_forces())
    std::cout << (force->domain == pliant::DistributedForce::Domain::body ? "body" : "surface") << " force "
              << force->name << ": " << force->part->name() << "\n";
  for (const auto& torque : scene.body.torques())
    std::cout << "torque " << torque->name << ": " << torque->part->name()
              << (torque->against == nullptr ? "" : " against " + torque->against->name()) << "\n";
  for (const pliant::Track& track : scene.tracks) {
    std::cout << "track " << track.name << ": ";
    print_point(simulation, track.point);
    std::cout << "\n";
  }
}

void print_joints(const pliant::Simulation& simulation) {
  const pliant::Model& model = simulation.model();
  if (model.joints().empty()) return;
  const pliant::State& state = simulation.state();
  pliant::Workspace<double> work;
  simulation.dynamics().accelerations(state.time(), state.q, state.v, state, work);
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const pliant::JointModel& joint = model.joints()[j];
    std::cout << joint.joint->type() << " " << joint.joint->name() << ": ";
    const auto& points = joint.joint->points();
    print_point(simulation, points.front());
    if (joint.joint->n_points() > joint.joint->n_first()) {
      std::cout << " to ";
      print_point(simulation, points[static_cast<std::size_t>(joint.joint->n_first())]);
    }
    const pliant::JointMode mode = state.joints[j];
    const double gap = model.gap(state, static_cast<int>(j));
    if (mode == pliant::JointMode::closing)
      std::cout << ", open by " << pliant::rounded_text(gap) << " m";
    else if (mode == pliant::JointMode::slack)
      std::cout << ", slack";
    if (std::isfinite(joint.joint->on())) std::cout << ", active from " << joint.joint->on() << " s";
    if (std::isfinite(joint.joint->off())) std::cout << ", active until " << joint.joint->off() << " s";
    std::cout << "\n";
  }
  const std::vector<int> redundant = pliant::redundant_rows(model, work.joints);
  int rows = 0, dependent = 0;
  for (std::size_t j = 0; j < model.joints().size(); ++j) {
    const pliant::JointModel& joint = model.joints()[j];
    if (joint.joint->one_sided() || !pliant::acts(state.joints[j])) continue;
    rows += joint.rows;
    dependent += redundant[j];
  }
  std::int64_t numbers = 0, augmented = 0;
  for (const pliant::Island& island : model.islands()) {
    numbers += island.factor_values;
    augmented += island.augmented ? 1 : 0;
  }
  const auto islands = static_cast<std::int64_t>(model.islands().size());
  std::cout << "constraints: " << pliant::count_text(rows, "row") << " of rank " << rows - dependent << ", "
            << pliant::count_text(islands, "island");
  if (islands > augmented) std::cout << ", " << islands - augmented << " solved by blocks of C_q M^-1 C_q^T";
  if (augmented > 0) std::cout << ", " << augmented << " solved with the augmented matrix";
  std::cout << ", " << pliant::count_text(numbers, "number")
            << (islands == 1 ? " in the factor\n" : " in the factors of all islands\n");
  for (const std::string& note : pliant::redundancy_notes(simulation)) std::cout << "  " << note << "\n";
}

int info(const SceneOptions& options) {
  const std::unique_ptr<pliant::Scene> scene = read(options);
  const pliant::Simulation simulation(scene->body, scene->integrator, 1, scene->tolerance);
  const pliant::Model& model = simulation.model();
  std::cout << scene->name << (scene->description.empty() ? "" : ": " + scene->description) << "\n";
  int frozen = 0;
  double mass = 0;
  for (const pliant::PartModel& part : model.parts()) {
    frozen += part.part->parameters().size() - part.n_s;
    if (part.q0 >= 0) mass += part.part->total_mass();
  }
  std::cout << pliant::count_text(static_cast<std::int64_t>(model.parts().size()), "part") << ", "
            << model.n_v() << " degrees of freedom ("
            << pliant::count_text(model.n_limits(), "dynamic parameter") << "), "
            << pliant::count_text(frozen, "parameter") << " frozen, " << mass
            << " kg in parts with degrees of freedom\n";
  for (const pliant::PartModel& part : model.parts()) print_part(part);
  print_obstacles(scene->body);
  print_joints(simulation);
  print_forces(*scene, simulation);
  std::cout << "skipped:\n";
  for (const std::string& what : pliant::skipped_work(model)) std::cout << "  " << what << "\n";
  const pliant::FrameSchedule schedule = pliant::schedule_of(*scene);
  std::cout << "run: until " << schedule.end() << " s, ";
  if (scene->tolerance > 0)
    std::cout << "adaptive steps with a tolerance of " << simulation.tolerance();
  else
    std::cout << schedule.steps() << " steps of " << schedule.step() << " s";
  std::cout << ", method " << simulation.integrator().name() << ", "
            << pliant::count_text(schedule.frames(), "frame") << "\n";
  if (!simulation.choice().why.empty()) std::cout << "  chosen: " << simulation.choice().why << "\n";
  const pliant::StableStep stable = pliant::stable_step(simulation);
  if (std::isfinite(stable.step))
    std::cout << "largest stable step: about " << pliant::rounded_text(stable.step)
              << " s at the start, limited by " << stable.limit << "\n";
  else
    std::cout << "largest stable step: unlimited, because the method integrates no stiff force explicitly\n";
  if (!stable.uncounted.empty()) std::cout << "  " << stable.uncounted << "\n";
  if (scene->tolerance == 0 && schedule.step() > stable.step)
    std::cout
        << "warning: the step of " << schedule.step()
        << " s is larger than the largest stable step; the run will probably fail; choose a smaller --step\n";
  return kDone;
}

}  // namespace

void add_info(CLI::App& app, Action& action) {
  const auto options = std::make_shared<SceneOptions>();
  CLI::App* command = app.add_subcommand(
      "info", "Describe a scene: parts, degrees of freedom, mass, skipped computations, largest stable step");
  add_scene_options(*command, *options);
  command->footer("Example:\n  pliant info scenes/pull.json --set /time/step=0.01");
  command->callback([options, &action] { action = [options] { return info(*options); }; });
}

}  // namespace pliant_cli
