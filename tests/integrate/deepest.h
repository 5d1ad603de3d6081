// How deep the meshes of parts that deform locally are in what they touch.
#pragma once

#include <algorithm>
#include <vector>

#include <pliant/contact/mesh_finder.h>
#include <pliant/integrate/simulation.h>

namespace pliant::test {

/// Behind planes and in each other, m.
inline double deepest(const Simulation& simulation) {
  std::vector<Contact> found;
  MeshFinder(simulation.model()).find(simulation.state(), simulation.time(), found);
  double deep = 0;
  for (const Contact& contact : found) deep = std::max(deep, -contact.gap);
  return deep;
}

}  // namespace pliant::test
