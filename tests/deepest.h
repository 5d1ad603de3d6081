// The deepest overlap at the current state of a simulation.
#pragma once

#include <algorithm>
#include <vector>

#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/simulate/simulation.h>

namespace pliant::test {

/// Returns the deepest overlap (m) of parts with other parts, planes and obstacles, or 0 if nothing overlaps.
/// Contact must be active in the simulation.
inline double deepest_overlap(const Simulation& simulation) {
  double deep = 0;
  for (const Contact& contact : simulation.contact()->overlaps(simulation.state(), simulation.time()))
    deep = std::max(deep, -contact.gap);
  return deep;
}
/// Returns the deepest overlap (m) of parts that deform locally with planes and with other parts, or 0 if
/// nothing overlaps. Overlaps with obstacles are not included.
inline double deepest(const Simulation& simulation) {
  std::vector<Contact> found;
  MeshFinder(simulation.model()).find(simulation.state(), simulation.time(), found);
  double deep = 0;
  for (const Contact& contact : found) deep = std::max(deep, -contact.gap);
  return deep;
}

}  // namespace pliant::test
