// Impacts of parts with dynamic global parameters, and of pairs that include rigid parts and balloons.
// Velocities and energy after an impact obey the inelastic law: the relative velocity at the contact point
// becomes zero. If the contact slides, only its normal component becomes zero. The parameters receive a share
// of the energy, and pairs conserve their momenta.
#include "catch.h"

#include <cmath>
#include <functional>
#include <string>

#include <Eigen/Cholesky>

#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>

#include "draws.h"
#include "motion.h"
#include "worst.h"

namespace blows_test {

using namespace pliant;
using test::Draws;
using test::Worst;

namespace {

using Build = std::function<void(MultiBody&)>;

/// The first impact of a model. `before` and `ledger_before` are from a run without contact to the time of
/// the impact; `after` and `ledger_after` are just after the impact.
struct Impact {
  State before, after;
  Ledger ledger_before, ledger_after;
  ContactRecord record;
  MatX<double> M;  ///< 1/2 v^T M v is the kinetic energy at the impact
  /// Jc v is the velocity of side a relative to side b at the contact, along the normal and two tangents,
  /// m/s.
  MatX<double> Jc;
};

/// Returns the mass matrix M at the state of a simulation, from the kinetic energies of unit velocities and
/// of sums of two unit velocities.
MatX<double> mass_matrix(const Simulation& simulation) {
  const Dynamics& dynamics = simulation.dynamics();
  State state = simulation.state();
  const Eigen::Index n = state.v.size();
  Workspace<double> work;
  auto twice_kinetic = [&](Eigen::Index i, Eigen::Index j) {
    state.v = VecX<double>::Unit(n, i);
    if (j != i) state.v[j] = 1;
    return 2 * dynamics.ledger(state, work).kinetic;
  };
  MatX<double> M(n, n);
  for (Eigen::Index i = 0; i < n; ++i) M(i, i) = twice_kinetic(i, i);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < i; ++j) M(i, j) = M(j, i) = 0.5 * (twice_kinetic(i, j) - M(i, i) - M(j, j));
  return M;
}

/// Adds sign * dx_dot/dv to L. x_dot: velocity of the contact point on one side, m/s, world. L: 3 rows, one
/// column for each velocity of the model. The columns of the part are (I, -R [p]x, R J), with the point p in
/// the frame of the part and J = dp/dq_s. A side without coordinates adds nothing.
void add_point(const Model& model, const State& state, const ContactSide& side, double sign,
               MatX<double>& L) {
  if (side.part < 0) return;
  const PartModel& m = model.parts()[static_cast<std::size_t>(side.part)];
  if (m.q0 < 0) return;
  std::vector<PointJet<double>> jets;
  Counters counters;
  m.part->points({side.material}, state.q.segment(m.q0 + 7, m.n_s), state.v.segment(m.v0 + 6, m.n_s), jets,
                 counters);
  const Mat3<double> R = model.orientation(state, side.part).toRotationMatrix();
  const Vec3<double>& p = jets[0].p;
  Mat3<double> cross;
  cross << 0, -p[2], p[1], p[2], 0, -p[0], -p[1], p[0], 0;
  L.middleCols<3>(m.v0) += sign * Mat3<double>::Identity();
  L.middleCols<3>(m.v0 + 3) -= sign * R * cross;
  L.middleCols(m.v0 + 6, m.n_s) += sign * R * jets[0].J;
}

/// Builds a model without gravity, runs it to its first impact, and returns the impact. Requires that the
/// impact occurs within 1 s and has a single contact.
Impact first_impact(const Build& build) {
  MultiBody body, other;
  for (MultiBody* each : {&body, &other}) {
    each->gravity.setZero();
    each->contact.active = true;
    build(*each);
  }
  other.contact = ContactSettings();
  Simulation simulation(body, "dop853", 1, 1e-12), free(other, "dop853", 1, 1e-12);
  State from;
  while (simulation.contact()->contacts().empty()) {
    REQUIRE(simulation.time() < 1);
    from = simulation.state();
    simulation.step_up_to(1);
  }
  REQUIRE(simulation.step_counters().impacts == 1);
  free.set_state(from);
  while (free.time() < simulation.time()) free.step_up_to(simulation.time());
  Impact impact{free.state(),
                simulation.state(),
                free.ledger(),
                simulation.ledger(),
                simulation.contact()->record(),
                mass_matrix(simulation),
                {}};
  REQUIRE((impact.after.q - impact.before.q).norm() < 1e-11);
  REQUIRE(impact.record.contacts.size() == 1);
  const Contact& contact = impact.record.contacts[0];
  MatX<double> L = MatX<double>::Zero(3, impact.after.v.size());
  add_point(simulation.model(), impact.after, contact.a, 1, L);
  add_point(simulation.model(), impact.after, contact.b, -1, L);
  const Vec3<double> n = contact.normal, t = n.unitOrthogonal();
  Mat3<double> axes;
  axes << n, t, n.cross(t);
  impact.Jc = axes.transpose() * L;
  return impact;
}

/// Kinds of parts that soft() adds. Each has three dynamic parameters.
const std::vector<std::string> kKinds{"sizes", "bent", "squarish", "twisted"};
Part& soft(MultiBody& body, const std::string& name, const std::string& kind, double density = 1000) {
  if (kind == "sizes") {
    Part& part = test::add(body, name, "ellipsoid", {}, density);
    return part.rest({{"a1", 0.1}, {"a2", 0.15}, {"a3", 0.2}})
        .stiffness({{"a1", 3000}, {"a2", 2000}, {"a3", 1000}})
        .initial_rate({{"a1", 0.1}});
  }
  if (kind == "bent") {
    Part& part = test::add(body, name, "ellipsoid", {"taper", "bend"}, density);
    return part.rest({{"a1", 0.1}, {"a2", 0.15}, {"a3", 0.3}, {"taper.tx", 0.3}, {"bend.angle", 0.5}})
        .stiffness({{"a3", 3000}, {"taper.tx", 20}, {"bend.angle", 10}});
  }
  if (kind == "squarish") {
    Part& part = test::add(body, name, "superellipsoid", {}, density);
    return part.rest({{"a1", 0.1}, {"a2", 0.15}, {"a3", 0.2}, {"eps1", 0.7}, {"eps2", 0.8}})
        .stiffness({{"a1", 1000}, {"a2", 2000}, {"a3", 3000}});
  }
  Part& part = test::add(body, name, "sphere", {"twist", "shear"}, density);
  return part.rest({{"r", 0.15}, {"shear.sx", 0.2}, {"twist.angle", 0.4}})
      .stiffness({{"r", 3000}, {"shear.sx", 50}, {"twist.angle", 20}});
}
Eigen::Quaterniond random_rotation(Draws& draws) {
  const Vec3<double> axis = draws.vector(1);
  return Eigen::Quaterniond(1, axis[0], axis[1], axis[2]).normalized();
}

}  // namespace

TEST_CASE("an impact changes parts with dynamic parameters by the inelastic law", "[contact][long]") {
  Worst velocity_error, loss_error, coulomb_error;
  for (const std::string& kind : kKinds)
    for (const bool pair : {false, true})
      for (const double mu : {0.0, 0.03, 1e3}) {  // no contact slides with the largest coefficient
        CAPTURE(kind, pair, mu);
        const Impact impact = first_impact([&](MultiBody& body) {
          body.contact.friction = mu;
          soft(body, "a", kind)
              .place({0, 0, 0.5}, Eigen::Quaterniond(0.8, 0.3, -0.5, 0.2).normalized())
              .velocity({0.5, 0.3, -2}, {2, -1, 3});
          if (pair)
            soft(body, "b", "bent", 500).place({0.1, 0.15, -0.2}).velocity({0, 0, 1}, {1, 0.5, -1});
          else
            body.plane("wall", Vec3<double>(0, 0, 0), {0.1, -0.2, 1});
        });
        const MatX<double> Jc = mu == 0 ? impact.Jc.topRows(1) : impact.Jc,
                           Y = impact.M.ldlt().solve(Jc.transpose()), Nc = Jc * Y;
        const VecX<double> u = Jc * impact.before.v, u_after = Jc * impact.after.v;
        REQUIRE(u[0] < -1);
        // p is the impulse that stops the relative motion. With mu = 0.03 the contact slides, and p is the
        // recorded impulse instead.
        VecX<double> p = -Nc.ldlt().solve(u);
        if (mu == 0.03) {
          const Contact& contact = impact.record.contacts[0];
          const Vec3<double> n = contact.normal, t = n.unitOrthogonal(), impulse = impact.record.impulses[0];
          p = Vec3<double>(n.dot(impulse), t.dot(impulse), n.cross(t).dot(impulse));
          REQUIRE(u_after.tail(2).norm() > 0.1);
          coulomb_error.note(std::abs(u_after[0] / u[0]));
          coulomb_error.note((p.tail(2) / p[0] + mu * u_after.tail(2).normalized()).norm());
        }
        const VecX<double> change = Y * p;
        const double loss = mu == 0.03 ? -0.5 * p.dot(u + u_after) : 0.5 * u.dot(Nc.ldlt().solve(u)),
                     measured_loss = impact.ledger_before.energy() - impact.ledger_after.energy();
        velocity_error.note((impact.after.v - impact.before.v - change).norm() / change.norm());
        loss_error.note(std::abs(measured_loss / loss - 1));
        loss_error.note(
            std::abs(impact.ledger_after.work.sum() - impact.ledger_before.work.sum() + measured_loss) /
            loss);
        // The impact changes the three parameter rates of part a. The kinetic energy of this change exceeds a
        // tenth of the lost energy.
        VecX<double> rates = VecX<double>::Zero(impact.after.v.size());
        rates.segment<3>(6) = change.segment<3>(6);
        CHECK(0.5 * rates.dot(impact.M * rates) > 0.1 * loss);
      }
  CHECK(velocity_error < 1e-11);
  CHECK(loss_error < 1e-13);
  CHECK(coulomb_error < 1e-11);
}

TEST_CASE("a ball with a dynamic height rebounds from an inelastic impact by the closed form", "[contact]") {
  // c: height of the centre; m: mass of the ball; m / 5: inertia of a3. The impact stops the lower pole,
  // whose velocity is u = c_dot - a3_dot. An impulse p changes u by (1 / m + 1 / (m / 5)) p, so that a sixth
  // of the energy is lost. Then c = a3 oscillates with the mass m + m / 5 for half a period, and the ball
  // leaves with 5/6 of its initial speed.
  const double speed = 1, radius = 0.1, stiffness = 2000, height = 0.0203;
  for (const std::string method : {"semi_implicit_euler", "rk4", "implicit_midpoint", "esdirk",
                                   "linearly_implicit", "dormand_prince", "dop853"}) {
    CAPTURE(method);
    MultiBody body;
    body.gravity.setZero();
    Part& ball = test::add(body, "ball", "ellipsoid", {}, 1000);
    ball.rest({{"a1", radius}, {"a2", radius}, {"a3", radius}}).stiffness({{"a3", stiffness}});
    ball.place({0, 0, radius + height}).velocity({0, 0, -speed}, {0, 0, 0});
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    const double h = 1e-3;
    Simulation simulation(body, method);
    const double mass = ball.total_mass(), start = simulation.ledger().energy(),
                 rebound = height / speed + kPi * std::sqrt(1.2 * mass / stiffness);
    double energy_after = 0, last = 0;
    while (simulation.time() < rebound + 0.02) {
      simulation.step(h);
      if (simulation.contact()->contacts().empty()) continue;
      if (energy_after == 0) energy_after = simulation.ledger().energy();
      last = simulation.time();
    }
    const Ledger end = simulation.ledger();
    const bool first_order = method == "semi_implicit_euler";
    CHECK(energy_after / start == Approx(5.0 / 6).margin(first_order ? 5e-4 : 1e-7));
    CHECK(std::abs(last - rebound) < h);
    CHECK(end.momentum[2] / (mass * speed) == Approx(5.0 / 6).margin(3e-5));
    CHECK(end.energy() / start == Approx(5.0 / 6).margin(first_order ? 1e-2 : 3e-5));
  }
}

namespace {

/// Adds a smooth part of random size and density. kind: index of the shape, 0 to 6. Kinds 0 to 3 are rigid;
/// kinds 4 to 6 have dynamic parameters, and kind 6 also has a taper and a bend.
Part& random_part(MultiBody& body, const std::string& name, int kind, Draws& draws) {
  const std::vector<std::string> shapes{"sphere",    "ellipsoid",      "superellipsoid", "capsule",
                                        "ellipsoid", "superellipsoid", "ellipsoid"};
  const std::string& shape = shapes[static_cast<std::size_t>(kind)];
  const bool chain = kind == 6;
  Part& part = test::add(body, name, shape,
                         chain ? std::vector<std::string>{"taper", "bend"} : std::vector<std::string>{},
                         draws.uniform(200, 2000));
  for (const char* length : {"a1", "a2", "a3", "r", "l"})
    if (part.parameters().find(length) >= 0) part.rest({{length, draws.uniform(0.1, 0.2)}});
  if (shape == "superellipsoid")
    part.rest({{"eps1", draws.uniform(0.6, 1.3)}, {"eps2", draws.uniform(0.6, 1.3)}});
  if (chain)
    part.rest({{"taper.tx", 0.2}, {"bend.angle", 0.4}})
        .stiffness({{"a3", 5000}, {"taper.tx", 50}, {"bend.angle", 40}});
  else if (kind >= 4)
    part.stiffness({{"a1", 3000}, {"a2", 4000}, {"a3", 5000}});
  return part;
}

/// Adds two parts of random_part() that spin and collide off centre. kind, other: their kinds. mu:
/// coefficient of friction.
void random_pair(MultiBody& body, int kind, int other, double mu, Draws& draws) {
  body.contact.friction = mu;
  const Vec3<double> aside = draws.vector(0.05);
  random_part(body, "a", kind, draws)
      .place({0, 0, 0}, random_rotation(draws))
      .velocity(Vec3<double>(2, 0, 0) + draws.vector(0.3), draws.vector(3));
  random_part(body, "b", other, draws)
      .place(Vec3<double>(0.8, 0, 0) + aside, random_rotation(draws))
      .velocity(Vec3<double>(-1, 0, 0) + draws.vector(0.3), draws.vector(3));
}

}  // namespace

TEST_CASE("pairs of smooth parts conserve their momenta in an impact", "[contact][long]") {
  Worst linear, angular;
  int seed = 0;
  for (int kind = 0; kind < 7; ++kind)
    for (int other = 0; other <= kind; ++other) {
      CAPTURE(kind, other);
      ++seed;
      const Impact impact = first_impact([&](MultiBody& body) {
        Draws draws(static_cast<std::uint64_t>(seed));
        random_pair(body, kind, other, seed % 2 == 0 ? 0 : 0.4, draws);
      });
      const double impulse = impact.record.impulses[0].norm();
      CHECK(impulse > 1);
      linear.note((impact.ledger_after.momentum - impact.ledger_before.momentum).norm() / impulse);
      angular.note((impact.ledger_after.angular_momentum - impact.ledger_before.angular_momentum).norm() /
                   (0.2 * impulse));
    }
  CHECK(linear < 1e-13);
  CHECK(angular < 1e-13);
}

TEST_CASE(
    "pairs in lasting contact conserve momenta to first order, and linear momentum to rounding if untapered",
    "[contact][long]") {
  for (const bool tapered : {false, true}) {
    std::vector<double> linear, angular;
    for (const int steps : {100, 200}) {
      MultiBody body;
      body.gravity.setZero();
      body.contact.active = true;
      for (const double side : {-1.0, 1.0}) {
        Part& part =
            test::add(body, side < 0 ? "a" : "b", "ellipsoid",
                      tapered ? std::vector<std::string>{"taper"} : std::vector<std::string>{}, 1000);
        part.rest({{"a1", 0.1}, {"a2", 0.15}, {"a3", 0.2}});
        part.stiffness({{"a1", 3000}, {"a2", 4000}, {"a3", 5000}});
        if (tapered) part.rest({{"taper.tx", 0.3}}).stiffness({{"taper.tx", 50}});
        part.place({0.3 * side, 0.02 * side, 0}, Eigen::Quaterniond(0.8, 0.3 * side, -0.5, 0.2).normalized());
        part.velocity({-1.5 * side, 0, 0.1 * side}, {2, -side, 1});
      }
      Simulation simulation(body, "rk4");
      const Ledger before = simulation.ledger();
      const double scale = 2 * body.parts()[0]->total_mass();
      int touching = 0;
      for (int i = 0; i < steps; ++i) {
        simulation.step(0.2 / steps);
        touching += simulation.contact()->contacts().empty() ? 0 : 1;
      }
      REQUIRE(touching > steps / 10);
      const Ledger after = simulation.ledger();
      linear.push_back((after.momentum - before.momentum).norm() / scale);
      angular.push_back((after.angular_momentum - before.angular_momentum).norm() / (0.2 * scale));
    }
    CAPTURE(tapered, linear, angular);
    if (tapered)
      CHECK(test::observed_order(linear) > 0.8);
    else
      CHECK(linear.back() < 1e-13);
    CHECK(test::observed_order(angular) > 0.8);
    CHECK(linear.back() < 2e-3);
    CHECK(angular.back() < 2e-3);
  }
}

TEST_CASE(
    "balloons in frictional contact with each other or a rigid part conserve linear momentum to rounding",
    "[contact][long]") {
  for (const char* method : {"semi_implicit_euler", "linearly_implicit"})
    for (const bool rigid : {false, true}) {
      std::vector<double> angular;
      for (const double h : {4e-4, 2e-4}) {
        MultiBody body;
        body.gravity.setZero();
        body.contact.active = true;
        for (const char* name : {"left", "right"}) {
          Part& part = test::add(body, name, "ellipsoid", {}, 1);
          part.make_shell().rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}});
          const bool left = std::string(name) == "left";
          part.place(left ? Vec3<double>(-0.12, 0.01, 0) : Vec3<double>(0.12, -0.02, 0.02));
          part.velocity({left ? 0.5 : -0.5, 0, 0}, left ? Vec3<double>(0, 3, 0) : Vec3<double>(0, 0, -5));
          if (rigid && !left) continue;
          LocalSettings settings;
          settings.resolution = 2;
          settings.energies = {local_law("neo_hookean_membrane", {2e4, 0.4, 1e-3}),
                               local_law("pressure", {20})};
          part.deform_locally(settings);
        }
        Simulation simulation(body, method);
        const Ledger before = simulation.ledger();
        const double scale = body.parts()[0]->total_mass() * 0.5;
        bool met = false;
        while (simulation.time() < 0.2) {
          simulation.step(h);
          met = met || !simulation.contact()->contacts().empty();
        }
        REQUIRE(met);
        const Ledger after = simulation.ledger();
        CHECK((after.momentum - before.momentum).norm() < 1e-13 * scale);
        angular.push_back((after.angular_momentum - before.angular_momentum).norm() / (0.1 * scale));
      }
      CAPTURE(method, rigid, angular);
      // Steps of linearly_implicit are extrapolated: their errors are small, and have no order at these
      // steps.
      const bool is_extrapolated = std::string(method) == "linearly_implicit";
      if (!is_extrapolated) CHECK(test::observed_order(angular) > 0.8);
      CHECK(angular.back() < (is_extrapolated ? 1e-4 : 2e-3));
    }
}

}  // namespace blows_test
