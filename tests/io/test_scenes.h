// Scenes for tests of recordings and pictures, built without a scene file.
#pragma once

#include <memory>

#include <pliant/body/joints/string.h>
#include <pliant/part/registry.h>
#include <pliant/scene/scene.h>

/// Returns a scene with four parts. "blob" stretches, twists, and tapers up to its limits; a spring with a
/// moving end, a force and a rest value that depends on time drive its motion. "rider" is rigid, and springs
/// connect it to "blob" and "wall". "wall" is fixed. "bob" is rigid and hangs from "rider" by a ball joint; a
/// string connects "bob" to the world.
inline std::unique_ptr<pliant::Scene> pulled_scene() {
  using namespace pliant;
  auto scene = std::make_unique<Scene>();
  scene->name = "pulled";
  scene->end = 0.2;
  scene->step = 1e-3;
  scene->frame_rate = 50;
  scene->integrator = "rk4";
  Part& blob = scene->body.add(make_part("blob", "superellipsoid", {"taper", "twist"}, 1000));
  blob.place({0, 0, 1}).velocity({0.1, 0, 0}, {1, 2, 3});
  blob.rest({{"a1", 0.2}, {"a2", 0.25}, {"a3", 0.3}, {"eps1", 0.7}, {"eps2", 0.8}});
  blob.stiffness({{"a1", 2e4}, {"taper.tx", 300}, {"twist.angle", 200}});
  blob.rest("a1", TimeFunction::formula("0.2 + 0.02 * sin(20 * t)"));
  blob.limits("taper.tx", {-0.02, 0.02});
  blob.damping(0.1, 1e-3, 0.05);
  Part& rider = scene->body.add(make_part("rider, \"heavy\"", "cone", {}, 800));
  rider.place({0.6, 0, 1});
  rider.rest({{"a1", 0.1}, {"a2", 0.1}, {"a3", 0.2}, {"t", -0.5}});
  Part& wall = scene->body.add(make_part("wall", "box", {}, 1000));
  wall.place({0, 1, 1}).fix();
  scene->body.spring("pull", point(blob, 0, 0),
                     world(TimeVector(TimeFunction::formula("0.4 + 0.2 * sin(9 * t)"), 0, 1)), 800, 2);
  scene->body.spring("link", point(blob, 0.5, 1), point(rider, -1, 2), 500, 1, 0.1);
  scene->body.spring("hold", point(rider, 0, 0), point(wall, 0, 0), 300, 1);
  scene->body.force("push", point(blob, 0.3, 0.2),
                    TimeVector(0, TimeFunction::formula("5 * cos(30 * t)"), 0));
  Part& bob = scene->body.add(make_part("bob", "sphere", {}, 1500));
  bob.place({0.6, 0, 0.5}).rest({{"r", 0.1}});
  scene->body.ball("hang", point(rider, -kPi / 2, 0), point(bob, kPi / 2, 0));
  scene->body.join("leash", String{0.9}, {world(0.6, 0.6, 0.5), point(bob, 0, 0)});
  scene->appearance.resize(4);
  for (Appearance& look : scene->appearance) look.resolution = 2;
  scene->tracks.push_back({"grip", point(blob, 0, 0), {}});
  scene->hash = 42;
  return scene;
}

/// Returns a scene with one free rigid part that rotates.
inline std::unique_ptr<pliant::Scene> free_top() {
  using namespace pliant;
  auto scene = std::make_unique<Scene>();
  scene->name = "top";
  scene->end = 1;
  scene->step = 0.01;
  scene->frame_rate = 10;
  scene->integrator = "rk4";
  scene->body.gravity.setZero();
  Part& top = scene->body.add(make_part("top", "ellipsoid", {}, 1000));
  top.rest({{"a1", 0.3}, {"a2", 0.2}, {"a3", 0.1}}).velocity({0.5, 0, 0}, {1, 0.1, 2});
  scene->appearance.resize(1);
  scene->hash = 7;
  return scene;
}
