// Interface of an elastic energy E(x) of local coordinates x (nodes.h). Its force on the coordinates is
// -dE/dx, which is -K q_d of Eq. (11) where E is quadratic. An energy evaluates forces element by element and
// never forms K for them (section 5 of the paper). SolidEnergy (solid/solid_energy-inl.h) and LinearMembrane
// (shell/linear_membrane-inl.h) are the main implementations; the others are in shell/. Elements are
// processed four at a time, one in each lane of a Pack. Each node sums the forces of its elements in a fixed
// order, so that results do not depend on the number of threads.
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
  ///   position       E depends on the positions p = s + d in the part's frame, Eq. (2); its forces act on
  ///                  global parameters too
  enum class Of { displacement, position };

  /// Scratch storage of an evaluation; its contents are ignored. Keep it between calls to avoid heap
  /// allocation in a step.
  struct Buffer {
    std::vector<double> numbers;
  };

  virtual ~NodalEnergy() = default;
  virtual Of of() const = 0;
  /// Returns whether E(Q d) = E(d) for every rotation Q of all displacements. Such an energy stays correct
  /// where a global deformation has rotated the material locally.
  virtual bool isotropic() const { return false; }
  /// Returns the inertia of the energy's own coordinates, which follow those of the nodes in x; kg m^2 if
  /// they are angles. The result is empty for most energies, which have no own coordinates.
  virtual VecX<double> own_inertia() const { return {}; }

  /// Returns E, J.
  virtual double energy(const Coordinates& x) const = 0;
  /// Adds the force -dE/dx to f: N at nodes, N m on own coordinates that are angles. pool may be nullptr.
  virtual void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const = 0;
  /// Adds the derivative of the force along dx to f: f -= K(x) dx with K = d2E/dx2.
  virtual void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                              ThreadPool* pool) const = 0;
  /// Adds the Kelvin-Voigt damping force at rates x_dot to f, for beta = 1 s. Its stress is proportional to
  /// the rate of strain, so that rigid motion of the part causes no force. Its power is never positive. The
  /// force is -K x_dot if E is quadratic in d; at rest this holds for the other energies too, except
  /// pressure, which has no damping.
  virtual void add_viscous_force(const Coordinates& x, const Coordinates& x_dot, VecX<double>& f,
                                 Buffer& buffer, ThreadPool* pool) const {
    add_derivative(x, x_dot, f, buffer, pool);
  }
  /// Appends the entries of K(x), without the term w w^T of w = rank_one(x), which would fill all of K.
  virtual void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const = 0;
  /// Returns w of the dense term w w^T of K. The result is empty if add_stiffness appends all of K.
  virtual VecX<double> rank_one(const Coordinates& /*x*/) const { return {}; }
  /// Returns an upper bound on omega^2 (1/s^2) of K(x) u = omega^2 M u, computed element by element. M:
  /// diagonal of the mass matrix, for all coordinates.
  virtual double frequency_bound(const Coordinates& x, const VecX<double>& M) const = 0;
};

}  // namespace pliant
