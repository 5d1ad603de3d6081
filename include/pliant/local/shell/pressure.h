// Pressure in a closed shell: an energy E(V) of the volume that it encloses (m^3),
//   V = 1/6 sum_T x_a . (x_b x x_c),   dE/dx = E' dV/dx,   K = E' d2V/dx2 + E'' (dV/dx) (dV/dx)^T.
// Constant pressure p: E = -p V. A gas of p0 at V0, with p_ext outside (adiabatic; gamma = 1 isothermal):
//   E = p0 V0/(gamma - 1) (V0/V)^(gamma - 1) + p_ext V.
#pragma once

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
  /// A pressure damps nothing.
  void add_viscous_force(const Coordinates&, const Coordinates&, VecX<double>&, Buffer&,
                         ThreadPool*) const final {}
  double frequency_bound(const Coordinates& x, const VecX<double>& M) const final;

  /// w = sqrt(E'') dV/dx. Nothing but zeros at constant pressure.
  VecX<double> rank_one(const Coordinates& x) const final;
  double volume(const Coordinates& x) const;

 protected:
  struct Law {
    double E, slope, curvature;  ///< E, E', E''
  };
  /// Throws std::invalid_argument unless the mesh is closed and encloses a volume.
  explicit Pressure(const ShellMesh& mesh);

 private:
  virtual Law law(double V) const = 0;
  template <class F>
  double sum(double* parts, ThreadPool* pool, F&& f) const;
  double volume(const Coordinates& x, double* parts, ThreadPool* pool) const;
  template <class Visit>
  void each_element(const Coordinates& x, Visit&& visit) const;

  ElementBatches<3> batches_;
  Eigen::Matrix4Xi edges_;  ///< a, b, c opposite on the left, d on the right
};

class ConstantPressure final : public Pressure {
 public:
  /// p: inside less outside, Pa; may be negative. Throws as Pressure, and when p is not finite.
  ConstantPressure(const ShellMesh& mesh, double p);

 private:
  Law law(double V) const override;
  double p_;
};

struct Gas {
  double p0;         ///< Pa at V0
  double V0;         ///< m^3
  double gamma;      ///< ratio of the specific heats; 1: at constant temperature
  double p_ext = 0;  ///< Pa outside
};

class GasPressure final : public Pressure {
 public:
  /// Throws as Pressure, and unless p0 >= 0, V0 > 0 and gamma >= 1. The energy is not finite where V <= 0.
  GasPressure(const ShellMesh& mesh, const Gas& gas);

 private:
  Law law(double V) const override;
  Gas gas_;
};

}  // namespace pliant
