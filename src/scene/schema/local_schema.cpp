#include "local_schema.h"

#include <cmath>

#include <pliant/part/continuum.h>
#include <pliant/part/local/local_laws.h>

#include "scene/scene_faults.h"

namespace pliant {

using namespace schema;

namespace {

Record law_record(const LocalLawInfo& info, const char* meaning) {
  Record law{info.name, std::string(info.shell ? "Of a shell: " : "Of a solid: ") + meaning, {}};
  for (const LocalLawInfo::Number& n : info.numbers) {
    schema::Range range = at_most(n.max);
    range.min = n.min;
    range.min_excluded = n.above && std::isfinite(n.min);
    law.fields.push_back(n.fallback ? optional(n.key, number(range, n.unit), n.meaning, brief(*n.fallback))
                                    : required(n.key, number(range, n.unit), n.meaning, "1000"));
  }
  return law;
}

}  // namespace

schema::Type elasticity_type() {
  std::vector<Record> laws;
  for (const ContinuumLawInfo& info : all_continuum_laws())
    laws.push_back(law_record(local_law_info(info.name), info.meaning));
  return tagged("type", std::move(laws)).defined_as("elasticity");
}

schema::Record local_record() {
  std::vector<Record> laws;
  for (const LocalLawInfo& info : all_local_laws()) laws.push_back(law_record(info, info.meaning));
  const Record dent{
      "dent",
      "A displacement of the nodes at time 0 around a place, displacement exp(-(r / radius)^2).",
      {required("at", vector3("m"), "The place, body frame at rest.", "[0, 0, 1]"),
       required("radius", number(above(0), "m"), "How far it reaches.", "0.2"),
       optional("displacement", vector3("m"), "At the place, body frame.", "[0, 0, 0]"),
       optional("velocity", vector3("m/s"), "The same of the velocity.", "[0, 0, 0]")}};
  return {
      "local",
      "Local deformation: of the surface of a shell, of the body of a solid.",
      {optional("basis",
                choice({{"nodes", "those of the nodes of a mesh, with any law"},
                        {"polynomial", "polynomials over the body of a solid, with the law \"elastic\""},
                        {"modes", "the lowest modes of a mesh, with laws that are quadratic in d"}}),
                "What displacements are made of.", "\"nodes\""),
       optional("degree", integer(between(1, 10)), "Of the polynomials.", "4"),
       optional("modes", integer(between(1, 2000)), "How many of the lowest.", "20"),
       optional(
           "resolution", integer(between(1, 64)),
           "Edges along an eighth of a circle: 48 n^2 triangles of a shell (a torus 64 n^2), some 48 n^3 "
           "tetrahedra of a solid. Polynomials are shown by that surface.",
           "8"),
       optional(
           "order", integer(between(1, 2)),
           "Of the elements of a solid: 1 straight with 4 nodes, 2 curved, with 15 nodes (10 for modes).",
           "1"),
       required("laws", array(tagged("type", std::move(laws)), 1), "Its energies, which add up.",
                "[{\"type\": \"membrane\", \"E\": 1e5, \"thickness\": 0.001}]"),
       optional("alpha", number(at_least(0), "1/s"), "Damping of the nodes in proportion to mass.", "0"),
       optional("beta", number(at_least(0), "s"), "Damping of the nodes in proportion to stiffness.", "0"),
       optional("dents", array(record(dent)), "Displacements and velocities at time 0.", "[]")}};
}

}  // namespace pliant
