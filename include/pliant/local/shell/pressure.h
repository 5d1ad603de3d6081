// Pressure in a closed shell: an energy E(V) of the enclosed volume V, m^3,
//   V = 1/6 sum over triangles of x_a . cross(x_b, x_c),
//   dE/dx = E' dV/dx,   K = E' d2V/dx2 + E'' (dV/dx)(dV/dx)^T.
//   constant pressure p   E = -p V
//   gas                   E = p0 V0/(gamma - 1) (V0/V)^(gamma - 1) + p_ext V   (adiabatic, gamma > 1)
//                         E = p0 V0 log(V0/V) + p_ext V                        (isothermal, gamma = 1)
// The gas has pressure p0 at volume V0; p_ext is the pressure outside.
#pragma once

#include <vector>

#include <pliant/local/nodal_energy.h>
#include <pliant/local/shell/shell_edges.h>
#include <pliant/local/solid/element_batches.h>

namespace pliant {

class Pressure : public NodalEnergy {
 public:
  Of of() const final { return Of::position; }
  double energy(const Coordinates& x) const final;
  void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const final;
  void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                      ThreadPool* pool) const final;
  void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const final;
  /// Adds nothing: pressure has no damping.
  void add_viscous_force(const Coordinates&, const Coordinates&, VecX<double>&, Buffer&,
                         ThreadPool*) const final {}
  void add_viscosity(const Coordinates&, std::vector<Eigen::Triplet<double>>&) const final {}
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const final;

  /// Returns w = sqrt(E'') dV/dx; zero at constant pressure.
  VecX<double> rank_one(const Coordinates& x) const final;
  /// Returns V at positions x, m^3.
  double volume(const Coordinates& x) const;

 protected:
  struct Law {
    double E, slope, curvature;  ///< E (J), E' (Pa), E'' (Pa/m^3)
  };
  /// Throws std::invalid_argument unless the mesh is closed and its volume is positive.
  explicit Pressure(const ShellMesh& mesh);

 private:
  virtual Law law(double V) const = 0;
  /// Returns the sum of f(batch) over the triangles, in the order of the batches. parts: scratch storage for
  /// one number of each batch.
  template <class F>
  double sum(double* parts, ThreadPool* pool, F&& f) const;
  double volume(const Coordinates& x, double* parts, ThreadPool* pool) const;
  /// Calls visit(ElementMatrix) for each edge, with the terms of E' d2V/dx2 that couple its two ends.
  template <class Visit>
  void each_element(const Coordinates& x, Visit&& visit) const;

  ElementBatches<3> batches_;
  /// Nodes a and b of each edge, then the opposite nodes c on its left and d on its right.
  Eigen::Matrix4Xi edges_;
};

class ConstantPressure final : public Pressure {
 public:
  /// p: pressure inside minus outside, Pa; may be negative. Throws the errors of Pressure, and
  /// std::invalid_argument if p is not finite.
  ConstantPressure(const ShellMesh& mesh, double p);

 private:
  Law law(double V) const override;
  double p_;
};

/// Constants of a gas.
struct Gas {
  double p0;         ///< pressure at V0, Pa
  double V0;         ///< reference volume, m^3
  double gamma;      ///< ratio of the specific heats; 1: constant temperature
  double p_ext = 0;  ///< pressure outside, Pa
};

class GasPressure final : public Pressure {
 public:
  /// Throws the errors of Pressure, and std::invalid_argument unless p0 >= 0, V0 > 0, gamma >= 1 and p_ext is
  /// finite. Energy, forces and stiffness are NaN where V <= 0.
  GasPressure(const ShellMesh& mesh, const Gas& gas);

 private:
  Law law(double V) const override;
  Gas gas_;
};

}  // namespace pliant
