// The deepest overlap of parts with each other, with planes and with obstacles.
#pragma once

#include <algorithm>
#include <vector>

#include <pliant/collision/mesh/mesh_finder.h>
#include <pliant/contact/contact_stepping.h>
#include <pliant/simulate/simulation.h>

namespace pliant::test {

/// Returns the deepest overlap that the contact search reports, m, or 0 if nothing overlaps. The model of the
/// simulation must have contact.
inline double deepest_overlap(const Simulation& simulation) {
  double deep = 0;
  for (const Contact& contact : simulation.contact()->overlaps(simulation.state(), simulation.time()))
    deep = std::max(deep, -contact.gap);
  return deep;
}
/// Returns the deepest overlap of the surface meshes of parts with local deformation, m, or 0 if nothing
/// overlaps.
inline double deepest(const Simulation& simulation) {
  std::vector<Contact> found;
  MeshFinder(simulation.model()).find(simulation.state(), simulation.time(), found);
  double deep = 0;
  for (const Contact& contact : found) deep = std::max(deep, -contact.gap);
  return deep;
}

}  // namespace pliant::test
