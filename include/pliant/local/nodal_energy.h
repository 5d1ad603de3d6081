// The face of an energy of local deformation (design 1.4): E(x) of local coordinates x, see nodes.h. It never
// forms a matrix to give a force. Elements come in batches of Pack lanes, structure of arrays; a node gathers
// what its elements push in a fixed order, so that results do not depend on the number of threads.
#pragma once

#include <vector>

#include <Eigen/SparseCore>

#include <pliant/local/nodes.h>
#include <pliant/math/thread_pool.h>

namespace pliant {

class NodalEnergy {
 public:
  /// What E depends on. Of displacements d it is quadratic, E = 1/2 x K x, and acts on d alone; of positions
  /// p = s + d it is an energy of the whole map from rest to now, and global parameters feel it too.
  enum class Of { displacement, position };

  /// What an evaluation needs for itself; kept from call to call, so that a step takes nothing from the heap.
  struct Buffer {
    std::vector<double> numbers;
  };

  virtual ~NodalEnergy() = default;
  virtual Of of() const = 0;
  /// Whether displacements of every direction are alike to it, so that it does not mind how the shape under d
  /// is turned.
  virtual bool isotropic() const { return false; }
  /// Inertia of the coordinates that the energy has of its own; they follow those of the nodes. Most have
  /// none.
  virtual VecX<double> own_inertia() const { return {}; }

  /// J.
  virtual double energy(const Coordinates& x) const = 0;
  /// f -= dE/dx, N. pool: may be nullptr.
  virtual void add_force(const Coordinates& x, VecX<double>& f, Buffer& buffer, ThreadPool* pool) const = 0;
  /// f -= K(x) dx with K = d2E/dx2: the derivative of the force along dx.
  virtual void add_derivative(const Coordinates& x, const Coordinates& dx, VecX<double>& f, Buffer& buffer,
                              ThreadPool* pool) const = 0;
  /// f -= what beta = 1 s of Kelvin and Voigt's damping pushes while x moves at x_dot: viscous stresses in
  /// proportion to the rate of strain, which rigid motion does not make, and which never give power. K x_dot
  /// of what is quadratic in d, and about rest of the others.
  virtual void add_viscous_force(const Coordinates& x, const Coordinates& x_dot, VecX<double>& f,
                                 Buffer& buffer, ThreadPool* pool) const {
    add_derivative(x, x_dot, f, buffer, pool);
  }
  /// Adds the entries of K(x), but for w w^T with w = rank_one(x), which ties every coordinate to every
  /// other.
  virtual void add_stiffness(const Coordinates& x, std::vector<Eigen::Triplet<double>>& K) const = 0;
  /// Empty where add_stiffness leaves nothing out.
  virtual VecX<double> rank_one(const Coordinates& /*x*/) const { return {}; }
  /// No less than the largest omega^2 (1/s^2) of K(x) u = omega^2 M u, element by element; M diagonal, over
  /// all coordinates.
  virtual double frequency_bound(const Coordinates& x, const VecX<double>& M) const = 0;
};

}  // namespace pliant
