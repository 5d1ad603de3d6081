// Interface of an elastic energy E(x) of local coordinates x (nodes.h). The force on the coordinates is
// -dE/dx; if E is quadratic in the displacements, this is -K q_d of Eq. (11). Forces are evaluated element by
// element, without K (section 5 of the paper). Examples are SolidEnergy (solid/solid_energy-inl.h) and
// LinearMembrane (shell/linear_membrane-inl.h). Elements are processed four at a time, one in each lane of a
// Pack. Each node sums the forces of its elements in a fixed order, so that results do not depend on the
// number of threads.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include <pliant/local/nodes.h>
#include <pliant/math/thread_pool.h>

namespace pliant {

class NodalEnergy {
 public:
  /// The argument x of E.
  ///   displacement   E = 1/2 d^T K d is quadratic in the displacements d; its forces act on d alone
  ///   position       E depends on the positions p = s + d in the part's frame, Eq. (2); its forces also act
  ///                  on global parameters
  enum class Of { displacement, position };

  /// Scratch storage of an evaluation; its contents are ignored. Keep the buffer between calls to avoid heap
  /// allocation in a step.
  struct Buffer {
    std::vector<double> numbers;
  };

  virtual ~NodalEnergy() = default;
  virtual Of of() const = 0;
  /// Returns whether E(Q d) = E(d) for every rotation Q of all displacements. E is then also valid where a
  /// global deformation has rotated the material.
  virtual bool isotropic() const { return false; }
  /// Returns the inertia of the energy's own coordinates, kg m^2 for angles. Own coordinates are coordinates
  /// in addition to the displacements of nodes, for example edge rotations; in x they follow the coordinates
  /// of the nodes. The result is empty if the energy has no own coordinates.
  virtual VecX<double> own_inertia() const { return {}; }

  /// Returns E, J.
  virtual double energy(const Coordinates& x) const = 0;
  /// Adds the force -dE/dx to f: N at nodes, N m on own coordinates that are angles. pool may be nullptr.
  virtual void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const = 0;
  /// Adds the derivative of the force along dx to f: f -= K(x) dx with K = d2E/dx2.
  virtual void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                              ThreadPool* pool) const = 0;
  /// Adds the Kelvin-Voigt damping force at rates x_dot to f, for beta = 1 s. The viscous stress is
  /// proportional to the rate of strain, so that rigid motion of the part causes no force. The power of the
  /// force is never positive. If E is quadratic in d, the force is -K x_dot. For other energies the force is
  /// -K x_dot in the rest shape; pressure has no damping.
  virtual void add_viscous_force(const Coordinates& x, const Coordinates& x_dot, VecX<double>& f,
                                 Buffer& buffer, ThreadPool* pool) const {
    add_derivative(x, x_dot, f, buffer, pool);
  }
  /// Appends the entries of K(x), without the dense term w w^T with w = rank_one(x).
  virtual void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const = 0;
  /// Appends the entries of the symmetric matrix V(x) of add_viscous_force(), whose force is -V(x) x_dot.
  virtual void add_viscosity(const Coordinates& x, std::vector<Eigen::Triplet<double>>& V) const {
    add_stiffness(x, V);
  }
  /// Returns w of the dense term w w^T of K; an empty vector if K has no dense term.
  virtual VecX<double> rank_one(const Coordinates& /*x*/) const { return {}; }
  /// Returns an upper bound on omega^2 (1/s^2) of K(x) u = omega^2 M u, computed element by element. M:
  /// diagonal of the mass matrix, for all entries of x.
  virtual double frequency_bound(const Coordinates& x, const VecX<double>& M) const = 0;
};

}  // namespace pliant
