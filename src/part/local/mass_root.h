// A square root C of a mass matrix, M = C^T C. The mass matrix may couple nodes, equally along x, y and z.
// Each further coordinate, which an energy adds (local/nodal_energy.h), has an inertia of its own. x = C d
// are mass-normalised coordinates.
#pragma once

#include <vector>

#include <Eigen/SparseCholesky>

#include <pliant/local/nodes.h>

namespace pliant {

class MassRoot {
 public:
  /// nodes: M over nodes, n x n, kg. own: inertia of the further coordinates. Throws std::invalid_argument if
  /// M is not positive definite.
  MassRoot(Eigen::SparseMatrix<double> nodes, const VecX<double>& own);

  Eigen::Index n_nodes() const { return M_.rows(); }
  /// Number of all coordinates.
  Eigen::Index size() const { return 3 * n_nodes() + own_.size(); }
  /// M over nodes.
  const Eigen::SparseMatrix<double>& of_nodes() const { return M_; }
  /// Return C d and C^-1 x of scalar fields over nodes. Each column of d or x is a field.
  MatX<double> root_of_nodes(const MatX<double>& d) const;
  MatX<double> solve_of_nodes(const MatX<double>& x) const;
  /// Return C d, C^T x and C^-1 x over all coordinates.
  MatX<double> root(const MatX<double>& d) const;
  MatX<double> transposed(const MatX<double>& x) const;
  MatX<double> solve(const MatX<double>& x) const;
  /// Returns M over all coordinates.
  Eigen::SparseMatrix<double> whole() const;

 private:
  /// Applies `nodal` to each of the three blocks of n_nodes() rows, which have the components along x, y and
  /// z. Applies `own` to the rows of the further coordinates.
  template <class Nodal, class Own>
  MatX<double> each(const MatX<double>& all, Nodal&& nodal, Own&& own) const;

  Eigen::SparseMatrix<double> M_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
  VecX<double> own_;  // square roots of the inertia of the further coordinates
};

}  // namespace pliant
