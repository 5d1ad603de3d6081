#include "local_schema.h"

#include <cmath>

#include <pliant/part/continuum.h>
#include <pliant/part/local/local_laws.h>
#include <pliant/scene/time_value.h>

#include "scene/scene_faults.h"

namespace pliant {

using namespace schema;

namespace {

/// Returns the record of an elastic law; its fields are the material numbers of the law. meaning: description
/// of the law.
Record law_record(const LocalLawInfo& info, const char* meaning) {
  Record law{info.name,
             std::string(info.shell ? "For a shell: " : "For a solid: ") + meaning + " " + info.formula + ".",
             {}};
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
      "An initial displacement and velocity of the nodes around a centre: at distance r, the values at the "
      "centre times exp(-(r / radius)^2).",
      {required("at", vector3("m"), "Centre, body frame at rest.", "[0, 0, 1]"),
       required("radius", number(above(0), "m"), "Radius of the dent.", "0.2"),
       optional("displacement", vector3("m"), "Displacement of the centre, body frame.", "[0, 0, 0]"),
       optional("velocity", vector3("m/s"), "Velocity of the centre, body frame.", "[0, 0, 0]")}};
  return {
      "local",
      "Local deformation of the surface of a shell or of the volume of a solid.",
      {optional("basis",
                choice({{"nodes", "displacements of the nodes of a mesh; all laws"},
                        {"polynomial", "polynomials over the volume of a solid; only the law \"elastic\""},
                        {"modes", "the lowest modes of a mesh; laws that are quadratic in d"}}),
                "Basis of the displacement field d.", "\"nodes\""),
       optional("degree", integer(between(1, 10)), "Degree of the polynomials.", "4"),
       optional("modes", integer(between(1, 2000)), "Number of modes, from the lowest frequency up.", "20"),
       optional(
           "resolution", integer(between(1, 64)),
           "Edges n along an eighth of a circle: 48 n^2 triangles for a shell (64 n^2 for a torus), about "
           "48 n^3 tetrahedra for a solid. With polynomials, only the drawn surface depends on it.",
           "8"),
       optional("order", integer(between(1, 2)),
                "Order of the elements of a solid: 1 straight with 4 nodes, 2 curved with 15 nodes (10 for "
                "modes).",
                "1"),
       required("laws", array(tagged("type", std::move(laws)), 1), "Elastic energies; their sum acts.",
                "[{\"type\": \"membrane\", \"E\": 1e5, \"thickness\": 0.001}]"),
       optional("alpha", number(at_least(0), "1/s"), "Damping of the nodes in proportion to mass.", "0"),
       optional("beta", number(at_least(0), "s"), "Damping of the nodes in proportion to stiffness.", "0"),
       optional("stiffness_factor", time_function("1"),
                "Factor of the forces of all laws and of their damping by beta, at least 0. A change of the "
                "factor does work of actuation.",
                "1"),
       optional("dents", array(record(dent)), "Initial displacements and velocities; they add up.", "[]")}};
}

}  // namespace pliant
