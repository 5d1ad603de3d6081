// Parts with equal descriptions share their constants, so that the search for mass points runs once. Shared
// constants have the same bits as constants of one part alone. Parts with different values of a setting on
// which the constants depend do not share constants.
#include "catch.h"

#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <pliant/part/constants_cache.h>
#include <pliant/part/registry.h>

namespace shared_constants_test {

using namespace pliant;

namespace {

std::unique_ptr<Part> tapered(const std::string& name) {
  std::unique_ptr<Part> part = make_part(name, "superellipsoid", {"taper"}, 800);
  part->rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.4}, {"taper.tx", 0.1}})
      .stiffness({{"a1", 50}, {"taper.tx", 2}});
  return part;
}

struct Setting {
  const char* name;
  std::function<void(Part&)> set;
};

}  // namespace

TEST_CASE("parts with equal descriptions share constants, with the same bits as constants of one part") {
  ConstantsCache cache;
  std::vector<std::unique_ptr<Part>> parts;
  for (int i = 0; i < 5; ++i) {
    parts.push_back(tapered("part" + std::to_string(i)));
    // Settings on which the constants do not depend.
    parts.back()->place({1.0 * i, 0, 0}).velocity({0, 1.0 * i, 0}, {0, 0, 1}).damping(0.1 * i, 0, 0.2);
    parts.back()->initial_rate({{"a1", 0.1 * i}});
    parts.back()->prepare(cache);
    CHECK(parts.back()->prepared());
    CHECK(&parts.back()->constants() == &parts.front()->constants());
  }
  CHECK(cache.computed() == 1);

  const std::unique_ptr<Part> alone = tapered("alone");
  alone->prepare();
  const Part& shared = *parts.back();
  CHECK(&alone->constants() != &shared.constants());
  CHECK(alone->rest_inertia().M == shared.rest_inertia().M);
  CHECK(alone->rest_inertia().moment == shared.rest_inertia().moment);
  CHECK(alone->size() == shared.size());
  CHECK(alone->K_s() == shared.K_s());
  REQUIRE(alone->mass_points().mass.size() == shared.mass_points().mass.size());
  for (std::size_t i = 0; i < shared.mass_points().mass.size(); ++i)
    for (int lane = 0; lane < 4; ++lane)
      CHECK(alone->mass_points().mass[i][lane] == shared.mass_points().mass[i][lane]);
}

TEST_CASE("parts that differ in a setting on which the constants depend do not share constants") {
  const std::vector<Setting> settings{{"rest value",
                                       [](Part& p) {
                                         p.rest({{"a2", std::nextafter(0.2, 1)}});
                                       }},
                                      {"initial value",
                                       [](Part& p) {
                                         p.initial({{"a1", 0.31}});
                                       }},
                                      {"stiffness",
                                       [](Part& p) {
                                         p.stiffness({{"a1", 51}});
                                       }},
                                      {"limits",
                                       [](Part& p) {
                                         p.limits("taper.tx", {-0.2, 0.3});
                                       }},
                                      {"dynamic parameters", [](Part& p) { p.make_dynamic({"a2"}); }},
                                      {"frozen parameters", [](Part& p) { p.freeze({"a1"}); }},
                                      {"fixed",
                                       [](Part& p) {
                                         p.freeze({"a1", "taper.tx"}).fix();
                                       }},
                                      {"rigid",
                                       [](Part& p) {
                                         p.freeze({"a1", "taper.tx"});
                                       }},
                                      {"inertia",
                                       [](Part& p) {
                                         p.freeze({"a1", "taper.tx"}).inertia(2, Mat3<double>::Identity());
                                       }},
                                      {"mass of the inertia",
                                       [](Part& p) {
                                         p.freeze({"a1", "taper.tx"}).inertia(3, Mat3<double>::Identity());
                                       }},
                                      {"mass", [](Part& p) { p.mass(3); }},
                                      {"shell", [](Part& p) { p.make_shell(); }},
                                      {"elasticity",
                                       [](Part& p) {
                                         p.elasticity({"neo_hookean", 1e4, 0.3, 0});
                                       }},
                                      {"modulus",
                                       [](Part& p) {
                                         p.elasticity({"neo_hookean", 2e4, 0.3, 0});
                                       }},
                                      {"law", [](Part& p) {
                                         p.elasticity({"st_venant_kirchhoff", 1e4, 0.3, 0});
                                       }}};
  ConstantsCache cache;
  std::vector<std::unique_ptr<Part>> parts;
  parts.push_back(tapered("plain"));
  parts.back()->prepare(cache);
  std::size_t expected = 1;
  for (const Setting& setting : settings)
    for (int copy = 0; copy < 2; ++copy) {
      INFO(setting.name);
      parts.push_back(tapered(setting.name));
      setting.set(*parts.back());
      parts.back()->prepare(cache);
      expected += copy == 0 ? 1 : 0;
      CHECK(cache.computed() == expected);
    }

  for (const char* shape : {"superellipsoid", "superellipsoid_radial", "supertoroid"})
    for (const std::vector<std::string>& chain : std::vector<std::vector<std::string>>{
             {}, {"taper"}, {"twist"}, {"taper", "twist"}, {"twist", "taper"}}) {
      INFO(shape);
      parts.push_back(make_part("part", shape, chain, 800));
      parts.back()->prepare(cache);
      CHECK(cache.computed() == ++expected);
    }
  parts.push_back(make_part("heavier", "supertoroid", {}, 801));
  parts.back()->prepare(cache);
  CHECK(cache.computed() == ++expected);
}

TEST_CASE("a part that changes gets other constants, and the shared constants do not change") {
  ConstantsCache cache;
  const std::unique_ptr<Part> one = tapered("one"), other = tapered("other");
  one->prepare(cache);
  other->prepare(cache);
  const double mass = one->total_mass();
  other->mass(2 * mass);
  other->prepare(cache);
  CHECK(one->total_mass() == mass);
  CHECK(std::abs(other->total_mass() - 2 * mass) <= 1e-15 * mass);
}

TEST_CASE("a cache of constants removes constants that no part uses any more") {
  ConstantsCache cache;
  const std::unique_ptr<Part> part = make_part("ball", "sphere", {}, 1000);
  for (int i = 1; i <= 200; ++i) {
    part->rest({{"r", 0.01 * i}}).prepare(cache);
    REQUIRE(cache.computed() == static_cast<std::size_t>(i));
    REQUIRE(cache.size() <= 17);
  }
}

}  // namespace shared_constants_test
