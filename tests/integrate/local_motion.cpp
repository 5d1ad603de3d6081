// Motion of parts whose nodes deform locally: what a push does, free flight, dust.
#include "catch.h"

#include <pliant/part/local_laws.h>
#include <pliant/part/nodal_deformation.h>
#include <pliant/part/surface.h>

#include "draws.h"
#include "motion.h"
#include "spring_net.h"

namespace local_motion_test {

using namespace pliant;

using test::bump;
using test::net;
using test::rush;

namespace {

/// A tumbling shell whose global parameters move too. order: of the elements, 0 for a shell.
Part& tumbling(MultiBody& body, int resolution, bool soft = true, int order = 0) {
  body.gravity.setZero();
  auto& part = body.add(make_part("shell", "superellipsoid", {"taper", "twist"}, 2));
  if (order == 0) part.make_shell();
  part.rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}, {"taper.tx", 0.2}})
      .place({1, 2, 3}, Eigen::Quaterniond(0.5, 0.5, -0.1, 0.3))
      .move({0.3, -0.2, 0.1}, {1, 0.6, -0.8});
  if (soft)
    part.stiffness({{"a1", 200}, {"a2", 300}, {"a3", 150}, {"taper.tx", 20}, {"twist.angle", 15}})
        .initial({{"a1", 0.52}, {"twist.angle", 0.3}})
        .initial_rate({{"a3", 0.4}, {"taper.tx", 0.3}});
  LocalSettings settings = net(resolution, 20);
  if (order > 0) settings.energies = {local_law("elastic", {200, 0.3})};
  settings.order = std::max(order, 1);
  settings.displacement = bump;
  settings.velocity = rush;
  part.deform_locally(settings);
  return part;
}

/// A force at a point of a part that does not move: the sums of m a and x x m a over the nodes are its own.
void check_push(MultiBody& body, Part& part, const Material<double>& at) {
  const Vec3<double> force(1, -2, 0.5);
  body.force("push", point(part, at), force);
  part.move({0, 0, 0}, {0, 0, 0});
  Simulation simulation(body, "rk4");
  State state = simulation.state();
  state.v.setZero();
  Workspace<double> work;
  simulation.dynamics().accelerations(0, state.q, state.v, state, work);
  const PartWorkspace<double>& w = work.parts[0];
  const NodalDeformation& local = *part.local()->nodal();
  Nodes a = nodes(work.v_dot.tail(local.n_d()), local.n_nodes());
  local.add_frame_velocities(w.a_r, 1, *w.local, a.data(), a.data());
  Vec3<double> sum = Vec3<double>::Zero(), turning = sum;
  for (Eigen::Index i = 0; i < a.rows(); ++i) {
    const Vec3<double> ma = local.mesh().mass[i] * a.row(i).transpose();
    sum += ma;
    turning += nodes(NodalDeformation::of(*w.local).x, local.n_nodes()).row(i).transpose().cross(ma);
  }
  const Vec3<double> f = w.R.transpose() * force;
  CHECK((sum - f).norm() <= 1e-12 * f.norm());
  CHECK((turning - w.ports[0].p.cross(f)).norm() <= 1e-12 * f.norm());
}

/// W^T d of the part, of the scale of its largest term.
double unmet(const Simulation& simulation) {
  const PartModel& m = simulation.model().parts()[0];
  Workspace<double> work;
  simulation.dynamics().evaluate_masses(simulation.state().q, simulation.state().v, {0}, work);
  const LocalWorkspace& w = *work.parts[0].local;
  const NodalDeformation& local = *m.local->nodal();
  const VecMax<double> all = local.frame_share(nodes(w.d, local.n_nodes()), w);
  return all.norm() / (m.part->total_mass() * m.part->size());
}

}  // namespace

TEST_CASE("nodes carry the mass, the centre and the inertia of the part", "[local]") {
  MultiBody body;
  Part& part = tumbling(body, 4);
  const Model model(body);
  const LocalMesh& mesh = part.local()->mesh();
  CHECK(mesh.mass.minCoeff() > 0);
  CHECK(mesh.mass.sum() == Approx(part.total_mass()).epsilon(1e-12));
  Mat3<double> I = Mat3<double>::Zero();
  Vec3<double> moment = Vec3<double>::Zero();
  for (Eigen::Index k = 0; k < mesh.X.rows(); ++k) {
    const Vec3<double> x = mesh.X.row(k).transpose();
    moment += mesh.mass[k] * x;
    I += mesh.mass[k] * (x.squaredNorm() * Mat3<double>::Identity() - x * x.transpose());
  }
  const Inertia<double>& whole = part.rest_inertia();
  CHECK((moment - whole.moment).norm() <= 1e-12 * whole.mass);
  CHECK((I - whole.M.block<3, 3>(3, 3)).norm() <= 1e-12 * I.norm());
}

TEST_CASE("free flight of a shell that rings, tumbles and changes its shape: order 4, and what is conserved",
          "[local][motion][long]") {
  std::vector<double> energy, momentum, turning;
  for (const int steps : {50, 100, 200, 400}) {
    MultiBody body;
    tumbling(body, 3);
    Simulation simulation(body, "rk4");
    const Ledger start = simulation.ledger();
    CHECK(unmet(simulation) <= 1e-12);
    test::run(simulation, 1, steps);
    const Ledger end = simulation.ledger();
    CHECK(unmet(simulation) <= 1e-12);
    energy.push_back(std::abs(end.energy() - start.energy()) / start.energy());
    momentum.push_back((end.momentum - start.momentum).norm() / start.momentum.norm());
    turning.push_back((end.angular_momentum - start.angular_momentum).norm() / start.angular_momentum.norm());
  }
  CHECK(test::observed_order(energy) >= 3.9);
  CHECK(test::observed_order(momentum) >= 3.9);
  CHECK(test::observed_order(turning) >= 3.9);
  CHECK(energy.back() <= 1e-6);
}

TEST_CASE("N09: a force on any node moves the centre of mass by F / m and turns the body by its torque",
          "[local][long]") {
  for (const bool soft : {false, true}) {
    MultiBody body;
    const Surface surface(tumbling(body, 2, soft), 2);
    for (std::size_t k = 0; k < surface.material().size(); k += 7) {
      MultiBody pushed;
      check_push(pushed, tumbling(pushed, 2, soft), surface.material()[k]);
    }
  }
}

TEST_CASE("N09: a force inside an element does so too, of shells and of solids of both orders",
          "[local][long]") {
  test::Draws draw(9);
  for (const bool soft : {false, true})
    for (const int order : {0, 1, 2})  // 0: a shell
      for (int i = 0; i < 6; ++i) {
        CAPTURE(soft, order, i);
        const double u = draw.uniform(-1.4, 1.4), v = draw.uniform(-3, 3), w = draw.uniform(0, 1);
        MultiBody pushed;
        Part& part = tumbling(pushed, 2, soft, order);
        check_push(pushed, part, material_at(u, v, order == 0 ? 1 : w));
        const NodeWeights at = part.local()->weights(part, material_at(u, v, order == 0 ? 1 : w));
        CHECK(at.node.size() >= 3);
      }
}

TEST_CASE("dust with nodes: every node of a spinning shell without elasticity moves straight", "[local]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Ellipsoid>>("dust", 1);
  part.make_shell().rest({{"a1", 0.5}, {"a2", 0.4}, {"a3", 0.6}}).move({0.1, 0, 0}, {0.5, 0.3, 1});
  part.make_dynamic({"a1", "a2", "a3"});
  LocalSettings settings;
  settings.resolution = 3;
  settings.velocity = rush;
  part.deform_locally(settings);
  std::vector<double> errors;
  for (const int steps : {50, 100, 200}) {
    Simulation simulation(body, "rk4");
    auto places = [&] {
      Workspace<double> work;
      const State& s = simulation.state();
      simulation.dynamics().evaluate_masses(s.q, s.v, {0}, work);
      const PartWorkspace<double>& w = work.parts[0];
      const NodalDeformation& local = *part.local()->nodal();
      const Eigen::Index n = local.n_nodes();
      Nodes v = nodes(w.local->d_dot, local.n_nodes());
      local.add_frame_velocities(w.v_r, 1, *w.local, v.data(), v.data());
      v *= w.R.transpose();
      const Nodes x =
          (nodes(NodalDeformation::of(*w.local).x, n) * w.R.transpose()).rowwise() + w.c.transpose();
      return std::make_pair(x, v);
    };
    const auto [x0, v0] = places();
    test::run(simulation, 1, steps);
    errors.push_back((places().first - x0 - v0).norm() / x0.norm());
  }
  CHECK(test::observed_order(errors) >= 3.9);
  CHECK(errors.back() <= 1e-7);
}

TEST_CASE(
    "a shell twists through 2.5 rad per half length, and its conditions still tell its coordinates apart",
    "[local][long]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add(make_part("tube", "cylinder", {"twist"}, 2));
  part.make_shell()
      .rest({{"a1", 0.2}, {"a2", 0.2}, {"a3", 0.6}})
      .stiffness({{"twist.angle", 2}})
      .initial({{"twist.angle", 2.5}});
  LocalSettings settings = net(3, 20);
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return 0.3 * rush(X); };
  part.deform_locally(settings);
  Simulation simulation(body, "rk4");
  const double start = simulation.ledger().energy();
  double least = 3, most = -3;
  for (int i = 0; i < 1500; ++i) {
    simulation.step(1e-3);
    least = std::min(least, simulation.state().q[7]);
    most = std::max(most, simulation.state().q[7]);
  }
  CHECK(most >= 2.4);
  CHECK(least <= -1.5);
  CHECK(simulation.ledger().energy() == Approx(start).epsilon(1e-6));
}

TEST_CASE("N66: a soft shell has the same bits on any number of threads", "[local]") {
  std::vector<std::uint64_t> bits;
  for (const int threads : {1, 2, 3}) {
    MultiBody body;
    // Enough triangles for several ranges of elements.
    auto& part = body.add<Primitive<Sphere>>("ball", 1);
    part.make_shell().rest({{"r", 0.5}}).move({0, 0, 0}, {0.5, 0.3, 1});
    LocalSettings settings;
    settings.resolution = 12;
    settings.velocity = rush;
    settings.energies = {local_law("membrane", {1e3, 0.3, 0.01}), local_law("pressure", {2})};
    part.deform_locally(settings);
    Simulation simulation(body, "rk4", threads);
    test::run(simulation, 0.01, 10);
    bits.push_back(hash(simulation.state()));
  }
  CHECK(bits[0] == bits[1]);
  CHECK(bits[0] == bits[2]);
}

TEST_CASE("N20: the largest stable step of a soft shell is on the safe side, and not far from the edge",
          "[local]") {
  MultiBody body;
  body.gravity.setZero();
  auto& part = body.add<Primitive<Sphere>>("ball", 1);
  part.make_shell().rest({{"r", 0.5}});
  LocalSettings settings = net(2, 20);
  settings.velocity = [](const Vec3<double>& X) -> Vec3<double> { return 1e-3 * rush(X); };
  part.deform_locally(settings);
  for (const char* method : {"rk4", "semi_implicit_euler"}) {
    const double step = largest_stable_step(Simulation(body, method));
    auto grows = [&](double h) {
      Simulation simulation(body, method);
      const double start = simulation.ledger().energy();
      try {
        for (int i = 0; i < 2000; ++i) {
          simulation.step(h);
          if (!(simulation.ledger().energy() < 100 * start)) return true;
        }
      } catch (const NumericalFailure&) {
        return true;
      }
      return false;
    };
    CHECK_FALSE(grows(0.98 * step));
    CHECK(grows(3 * step));
  }
}

}  // namespace local_motion_test
