// Impulses of many simultaneous contacts: Coulomb's law at each contact, checked with the resulting
// velocities.
// N55 in the name of a test is a row of the table in tests/README.md.
#include "catch.h"

#include <cmath>

#include <pliant/collision/find_contacts.h>
#include <pliant/contact/contact_problem.h>
#include <pliant/part/registry.h>

#include "draws.h"

namespace contact_problem_test {

using namespace pliant;
using test::Draws;

namespace {

/// Adds `high` layers of across x across balls in a cubic lattice. Each ball touches its neighbours. corner:
/// point below the first ball, m.
void lattice(MultiBody& body, int across, int high, const Vec3<double>& corner = Vec3<double>::Zero()) {
  const std::size_t others = body.parts().size();
  for (int k = 0; k < high; ++k)
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i)
        body.add(make_part("ball" + std::to_string(others +
                                                   static_cast<std::size_t>((k * across + j) * across + i)),
                           "sphere", {}, 1000))
            .rest({{"r", 0.5}})
            .place(corner + Vec3<double>(i, j, k + 0.5));
}

/// Contacts and their impulses.
struct Solved {
  std::vector<Contact> contacts;
  ContactSolution solution;
};

/// Returns the contacts of a model, and their impulses if the parts have random velocities. speed: bound of
/// the components of these velocities, m/s and rad/s. All parts also move downwards with this speed.
Solved solve(MultiBody& body, double speed) {
  const Model model(body);
  const Dynamics dynamics(model);
  State state = model.initial_state();
  Draws draws(21);
  for (const PartModel& m : model.parts())
    if (m.q0 >= 0) {
      state.v.segment<3>(m.v0) = draws.vector(speed) - Vec3<double>(0, 0, speed);
      state.v.segment<3>(m.v0 + 3) = draws.vector(speed);
    }
  Workspace<double> work;
  dynamics.accelerations(0, state.q, state.v, state, work);
  std::vector<int> all;
  for (std::size_t i = 0; i < model.parts().size(); ++i) all.push_back(static_cast<int>(i));
  dynamics.evaluate_masses(state.time(), state.q, state.v, all, work);
  Solved solved;
  solved.contacts = ContactFinder(model).find(state, 0, 1e-9);
  ContactProblem problem(model, state, work, solved.contacts);
  solved.solution = problem.solve(0);
  return solved;
}

/// Returns the largest violation of the velocity conditions of all contacts, m/s. Requires that the impulses
/// are in their friction cones.
double max_violation(const Solved& solved) {
  double worst = 0;
  for (std::size_t k = 0; k < solved.contacts.size(); ++k) {
    const Contact& contact = solved.contacts[k];
    const Vec3<double>&p = solved.solution.impulse[k], &u = solved.solution.velocity[k];
    const double p_n = p.dot(contact.normal), u_n = u.dot(contact.normal);
    const Vec3<double> p_t = p - p_n * contact.normal, u_t = u - u_n * contact.normal;
    REQUIRE(p_n >= -1e-9);
    REQUIRE(p_t.norm() <= contact.friction * p_n * (1 + 1e-9) + 1e-6);
    worst = std::max(worst, -u_n);
    if (p_n > 1e-6) worst = std::max(worst, u_n);
    if (p_t.norm() < (1 - 1e-6) * contact.friction * p_n - 1e-6) worst = std::max(worst, u_t.norm());
  }
  return worst;
}

}  // namespace

TEST_CASE("impulses of heaps obey Coulomb's law at every contact", "[contact]") {
  for (const double friction : {0.0, 0.3, 1.0})
    for (const int across : {1, 2, 3}) {
      MultiBody body;
      body.contact.friction = friction;
      lattice(body, across, 3);
      body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
      const Solved solved = solve(body, 1);
      REQUIRE(solved.contacts.size() ==
              static_cast<std::size_t>(3 * across * across + 6 * across * (across - 1)));
      CHECK(solved.solution.residual < 1e-11);
      CHECK(solved.solution.fallbacks == 0);
      CHECK(max_violation(solved) < 1e-9);
    }
}

TEST_CASE("N55: the impulses of five thousand contacts in eighty heaps have a small residual", "[contact]") {
  MultiBody body;
  for (int heap = 0; heap < 80; ++heap) lattice(body, 3, 3, {10.0 * (heap % 9), 10.0 * (heap / 9), 0});
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  const Solved solved = solve(body, 1);
  CHECK(solved.contacts.size() == 80 * 63);
  CHECK(solved.solution.residual < 1e-10);
  CHECK(solved.solution.fallbacks == 0);
  CHECK(max_violation(solved) < 1e-8);
}

TEST_CASE("the residual of a large heap is small, and is reported", "[contact]") {
  MultiBody body;
  lattice(body, 8, 5);
  body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
  const Solved solved = solve(body, 1);
  CHECK(solved.contacts.size() > 800);
  CHECK(solved.solution.residual < 1e-2);
  CHECK(max_violation(solved) < 3 * solved.solution.residual + 1e-9);
}

TEST_CASE("a motion that no impulse can stop is reported, and stays bounded", "[contact]") {
  // Two planes approach a ball from opposite sides.
  MultiBody body;
  body.contact.friction = 0.5;
  body.add(make_part("ball", "sphere", {}, 1000)).rest({{"r", 0.5}}).place({0, 0, 0});
  body.plane("below", TimeVector(0, 0, -0.5), {0, 0, 1});
  body.plane("above", TimeVector(0, 0, 0.5), {0, 0, -1});
  const Model model(body);
  State state = model.initial_state();
  const Dynamics dynamics(model);
  Workspace<double> work;
  dynamics.evaluate_masses(state.time(), state.q, state.v, {0}, work);
  std::vector<Contact> contacts = ContactFinder(model).find(state, 0, 1e-9);
  REQUIRE(contacts.size() == 2);
  for (Contact& contact : contacts) contact.prescribed_velocity = 0.1 * contact.normal;
  ContactProblem problem(model, state, work, contacts);
  const ContactSolution solution = problem.solve(0);
  CHECK(solution.fallbacks == 1);
  CHECK(solution.residual >= 0.0999);  // the smallest possible value, half the approach speed of the planes
  CHECK(solution.residual < 0.21);
  for (const Vec3<double>& p : solution.impulse) CHECK(p.norm() < 1e9);
  CHECK(problem.after(problem.movers()[0]).norm() < 0.2);
}

}  // namespace contact_problem_test
