// The works of drag, damping and dampers while impulses act on a body. The ledger has the works of the motion
// with the impulses, not of the motion without them.
#include "catch.h"

#include <cmath>
#include <string>
#include <vector>

#include <pliant/contact/contact_stepping.h>

#include "motion.h"

namespace damping_work_test {

using namespace pliant;

namespace {

constexpr double kGravity = 9.81, kMass = 1000 * 0.2 * 0.2 * 0.2;  // m/s^2, kg

Part& box_on_floor(MultiBody& body) {
  body.contact.friction = 0.2;
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  return body.add<Primitive<Box>>("box").rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.1}}).place({0, 0, 0.1});
}
Work kinds[] = {Work::damping, Work::drag, Work::spring_damping};

/// Returns the largest work of damping of a box at rest for 0.4 s, J.
double work_at_rest(const std::string& method, void (*build)(MultiBody&), double h) {
  MultiBody body;
  build(body);
  Simulation simulation(body, method);
  const int steps = static_cast<int>(std::lround(0.4 / h));
  for (int i = 0; i < steps; ++i) simulation.step(h);
  const Ledger ledger = simulation.ledger();
  double largest = 0;
  for (const Work kind : kinds) largest = std::max(largest, std::abs(ledger.work[static_cast<int>(kind)]));
  return largest;
}

}  // namespace

TEST_CASE("drag and dampers of a box that rests on a floor do no work") {
  const auto drag = [](MultiBody& body) { box_on_floor(body).damping(0, 0, 5); };
  const auto damper = [](MultiBody& body) {
    Part& part = box_on_floor(body);
    body.spring("damper", point(part, kPi / 2, 0), world(0, 0, 1), 0, 40);
  };
  const auto hinge_with_drive = [](MultiBody& body) {
    // The hinge supports the box at one side, and the floor supports the other side.
    Part& part = box_on_floor(body).damping(0, 0, 5);
    const Joint& hinge = body.hinge("hinge", world(-0.1, 0, 0.1), point(part, 0, kPi), {0, 1, 0});
    body.drive("drive", hinge).damping = 0.5;
  };
  const struct {
    const char* name;
    void (*build)(MultiBody&);
  } cases[] = {{"drag", drag}, {"damper", damper}, {"hinge with drive", hinge_with_drive}};
  for (const char* method :
       {"semi_implicit_euler", "rk4", "implicit_midpoint", "dormand_prince", "dop853", "esdirk"})
    for (const auto& [name, build] : cases) {
      const double coarse = work_at_rest(method, build, 0.01), fine = work_at_rest(method, build, 0.005);
      CAPTURE(method, name, coarse, fine);
      // Without impulses the box would fall from rest in each step of 0.01 s. With a drag of 5/s, the mean
      // power of the drag in such a step would be 5 kMass (kGravity 0.01)^2 / 3, which gives 0.05 J in 0.4 s.
      // implicit_midpoint evaluates the power in the middle of a step only, with a work error of second
      // order.
      const bool midpoint = std::string(method) == "implicit_midpoint";
      CHECK(coarse < (midpoint ? 0.02 : 1e-3));
      CHECK((fine < coarse / (midpoint ? 3.5 : 6) || fine < 1e-9));
    }
}

TEST_CASE("the works of a box that slides against drag are those of the closed form") {
  constexpr double drag = 5, friction = 0.2, speed = 3, end = 0.3;
  const double bound = friction * kGravity / drag;  // v(t) = (speed + bound) exp(-drag t) - bound
  const auto v = [&](double t) { return (speed + bound) * std::exp(-drag * t) - bound; };
  const double way = (speed - v(end)) / drag - bound * end,
               friction_work = -friction * kMass * kGravity * way,
               lost = 0.5 * kMass * (v(end) * v(end) - speed * speed);
  REQUIRE(v(end) > 0);
  double last = 1;
  for (const double tolerance : {1e-4, 1e-6, 1e-8}) {
    MultiBody body;
    box_on_floor(body).damping(0, 0, drag).velocity({speed, 0, 0}, {0, 0, 0});
    Simulation simulation(body, "dop853", 1, tolerance);
    while (simulation.time() < end) simulation.step_up_to(end);
    const Ledger ledger = simulation.ledger();
    const auto work = [&](Work kind) { return ledger.work[static_cast<int>(kind)]; };
    const double error = std::max({std::abs(work(Work::friction) - friction_work),
                                   std::abs(work(Work::drag) - (lost - friction_work)),
                                   std::abs(work(Work::contact)), std::abs(ledger.balance)});
    CAPTURE(tolerance, error, work(Work::friction), friction_work, work(Work::drag), lost - friction_work,
            work(Work::contact), ledger.balance);
    CHECK(error < 100 * tolerance * kMass * speed * speed);
    CHECK(error < last / 10);
    last = error;
  }
}

TEST_CASE("the work of drag of bouncing balls is equal for sequential and simultaneous impacts") {
  std::vector<double> works;
  for (const ImpactOrder order : {ImpactOrder::simultaneous, ImpactOrder::sequential}) {
    MultiBody body;
    body.contact.impacts = order;
    body.contact.restitution = 0.8;
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    // More than eight moving parts: impacts are not located in time.
    for (int i = 0; i < 10; ++i)
      body.add<Primitive<Sphere>>("ball" + std::to_string(i))
          .rest({{"r", 0.1}})
          .damping(0, 0, 0.5)
          .place({0.5 * i, 0, 0.5 + 0.01 * i});
    Simulation simulation(body, "rk4");
    for (int i = 0; i < 1000; ++i) simulation.step(1e-3);
    const Ledger ledger = simulation.ledger();
    works.push_back(ledger.work[static_cast<int>(Work::drag)]);
    CAPTURE(works, ledger.balance);
    CHECK(works.back() < 0);
    CHECK(std::abs(ledger.balance) < 1e-2 * std::abs(works.back()));
  }
  CHECK(works[0] == Approx(works[1]).epsilon(1e-3));
}

}  // namespace damping_work_test
