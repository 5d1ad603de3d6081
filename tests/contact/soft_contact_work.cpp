// The energy ledger of soft contact. The work of inelastic contact at nodes of a mesh does not rise, within
// the error of the method. The error of the energy balance falls with the step.
#include "catch.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include <pliant/contact/contact_stepping.h>
#include <pliant/part/local/local_laws.h>

#include "motion.h"

namespace soft_contact_work_test {

using namespace pliant;

namespace {

constexpr double kRadius = 0.1;  // m

/// Adds a ball of radius kRadius that deforms at the nodes of a mesh. kind: "solid", "shell", or "gas" for a
/// shell with a gas.
Part& ball(MultiBody& body, const std::string& name, const std::string& kind, const Vec3<double>& at) {
  auto& part = body.add<Primitive<Sphere>>(name, kind == "solid" ? 300.0 : 1.0);
  part.rest({{"r", kRadius}}).place(at);
  LocalSettings settings;
  settings.resolution = 2;
  if (kind == "solid") {
    settings.energies = {local_law("st_venant_kirchhoff", {2e4, 0.3})};
  } else {
    part.make_shell();
    settings.energies = {local_law("neo_hookean_membrane", {2e4, 0.4, 1e-3})};
    settings.energies.push_back(kind == "gas" ? local_law("gas", {500, 1.4, 480})
                                              : local_law("pressure", {20}));
  }
  part.deform_locally(settings);
  return part;
}

/// Adds balls that meet in inelastic contact with friction. where: "plane", "pair" or "mesh".
void build(MultiBody& body, const std::string& kind, const std::string& where) {
  body.contact.friction = 0.3;
  body.contact.active = true;
  if (where == "pair") {
    body.gravity.setZero();
    ball(body, "left", kind, {-0.11, 0.01, 0}).velocity({0.5, 0, 0}, {0, 3, 0});
    ball(body, "right", kind, {0.11, -0.02, 0.02}).velocity({-0.5, 0, 0}, {0, 0, -5});
    return;
  }
  ball(body, "ball", kind, {0, 0.02, 0.105}).velocity({0.3, 0, -1}, {0, 3, 0});
  if (where == "plane") {
    body.plane("floor", Vec3<double>(0, 0, 0), {0, 0, 1});
    return;
  }
  Eigen::Matrix3Xd x(3, 4);
  x << -1, 1, 1, -1, -1, -1, 1, 1, -0.2, 0.2, 0.2, -0.2;
  Eigen::Matrix3Xi triangles(3, 2);
  triangles << 0, 0, 1, 2, 2, 3;
  body.obstacle("ground", x, triangles);
}

/// Results from the ledger of a run. Energies are relative to the kinetic energy T at the start.
struct Books {
  double contact;   ///< work of contact
  double gain;      ///< largest rise of the work of contact
  double balance;   ///< largest error of the ledger
  double momentum;  ///< change of the linear momentum / sqrt(2 m T), with the mass m of a part
};

Books books_of(const std::string& kind, const std::string& where, const std::string& method, double h) {
  MultiBody body;
  build(body, kind, where);
  Simulation simulation(body, method);
  const Ledger start = simulation.ledger();
  Books books{};
  double lowest = 0;
  Ledger now;
  for (int i = 0; i < std::lround(0.08 / h); ++i) {
    simulation.step(h);
    now = simulation.ledger();
    books.contact = now.work[static_cast<int>(Work::contact)] / start.kinetic;
    lowest = std::min(lowest, books.contact);
    books.gain = std::max(books.gain, books.contact - lowest);
    books.balance = std::max(books.balance, std::abs(now.balance) / start.kinetic);
  }
  books.momentum =
      (now.momentum - start.momentum).norm() / std::sqrt(2 * start.kinetic * body.parts()[0]->total_mass());
  return books;
}

}  // namespace

TEST_CASE(
    "inelastic contact at nodes adds no energy, and the ledger balances, within the error of the method",
    "[contact][implicit][long]") {
  // The bounds `gain` and `balance` are relative to the kinetic energy at the start. They hold for the step
  // kShortest; for longer steps they grow with the power gain_order or balance_order of the step.
  struct Method {
    const char* name;
    double gain;
    int gain_order;
    double balance;
    int balance_order;
    std::vector<std::pair<std::string, std::string>> scenes;  // kind of the balls, and where they meet
  };
  constexpr double kShortest = 1e-4;  // s
  const std::vector<std::pair<std::string, std::string>> all{
      {"solid", "plane"}, {"solid", "pair"}, {"shell", "pair"}, {"gas", "mesh"}};
  const std::vector<Method> methods{
      {"semi_implicit_euler", 1.5e-3, 1, 4e-3, 1, all},
      {"rk4", 1e-4, 2, 1e-6, 2, all},
      {"linearly_implicit", 4e-5, 1, 4e-4, 2, {{"shell", "plane"}, {"shell", "pair"}, {"gas", "mesh"}}}};
  for (const Method& method : methods)
    for (const auto& scene : method.scenes)
      for (const double ratio : {4.0, 2.0, 1.0}) {
        CAPTURE(method.name, scene.first, scene.second, ratio);
        const Books books = books_of(scene.first, scene.second, method.name, ratio * kShortest);
        CHECK(books.contact < -0.01);
        CHECK(books.gain <= std::pow(ratio, method.gain_order) * method.gain);
        CHECK(books.balance <= std::pow(ratio, method.balance_order) * method.balance);
        if (scene.second == "pair") CHECK(books.momentum < 1e-12);
      }
}

}  // namespace soft_contact_work_test
