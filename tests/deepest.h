// How deep parts are in what they touch.
#pragma once

#include <algorithm>
#include <vector>

#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/simulate/simulation.h>

namespace pliant::test {

/// By what contact tells of overlaps, m.
inline double deepest_overlap(const Simulation& simulation) {
  double deep = 0;
  for (const Contact& contact : simulation.contact()->overlaps(simulation.state(), simulation.time()))
    deep = std::max(deep, -contact.gap);
  return deep;
}
/// The meshes of those that deform locally, m.
inline double deepest(const Simulation& simulation) {
  std::vector<Contact> found;
  MeshFinder(simulation.model()).find(simulation.state(), simulation.time(), found);
  double deep = 0;
  for (const Contact& contact : found) deep = std::max(deep, -contact.gap);
  return deep;
}

}  // namespace pliant::test
