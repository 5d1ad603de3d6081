// Counters of computations of the kernels of parts: points, matrices and forces that were evaluated. Tests
// and the file run.json show with these counters which evaluations were skipped.
#pragma once

namespace pliant {

struct Counters {
  long jacobian_points = 0;  ///< mass points or nodes whose J was evaluated
  long rate_points = 0;      ///< mass points or nodes whose Jdot qs_dot was evaluated
  long mass_matrices = 0;    ///< mass matrices computed
  long inertial_forces = 0;  ///< vectors g_q evaluated; a part at rest adds none
  long point_jets = 0;       ///< material points evaluated for forces, joints and recorded paths (tracks)
  long surfaces = 0;         ///< surfaces evaluated for output
  long strain_points = 0;    ///< quadrature points whose strain was evaluated

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
  Counters operator-(const Counters& o) const {
    return {jacobian_points - o.jacobian_points, rate_points - o.rate_points, mass_matrices - o.mass_matrices,
            inertial_forces - o.inertial_forces, point_jets - o.point_jets,   surfaces - o.surfaces,
            strain_points - o.strain_points};
  }
};

}  // namespace pliant
