// Counters of the evaluations of parts. run.json reports them. Tests use them to check that evaluations which
// a scene does not need are skipped.
#pragma once

namespace pliant {

struct Counters {
  long jacobian_points = 0;  ///< mass points whose J was evaluated
  long rate_points = 0;      ///< mass points whose Jdot q_s_dot was evaluated
  long mass_matrices = 0;    ///< mass matrices summed
  long inertial_forces = 0;  ///< inertial forces g_q evaluated
  long point_jets = 0;       ///< material points evaluated for forces, joints and contact
  long surfaces = 0;         ///< surfaces evaluated for output
  long strain_points = 0;    ///< points of the body whose strain was evaluated

  Counters& operator+=(const Counters& o) {
    jacobian_points += o.jacobian_points;
    rate_points += o.rate_points;
    mass_matrices += o.mass_matrices;
    inertial_forces += o.inertial_forces;
    point_jets += o.point_jets;
    surfaces += o.surfaces;
    strain_points += o.strain_points;
    return *this;
  }
};

}  // namespace pliant
