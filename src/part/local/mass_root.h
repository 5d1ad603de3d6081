// A root C of a mass matrix, M = C^T C, of nodes whose masses may be coupled, the same along x, y and z, and
// of coordinates that follow them, each with an inertia of its own. x = C d are mass-normalised coordinates.
#pragma once

#include <vector>

#include <Eigen/SparseCholesky>

#include <pliant/local/nodes.h>

namespace pliant {

class MassRoot {
 public:
  /// nodes: M over nodes, n x n, kg. own: of the coordinates that follow. Throws std::invalid_argument where
  /// M is not positive.
  MassRoot(Eigen::SparseMatrix<double> nodes, const VecX<double>& own);

  Eigen::Index n_nodes() const { return M_.rows(); }
  /// Over all coordinates.
  Eigen::Index size() const { return 3 * n_nodes() + own_.size(); }
  /// M over nodes.
  const Eigen::SparseMatrix<double>& of_nodes() const { return M_; }
  /// C d and C^-1 x of fields over nodes, one a column.
  MatX<double> root_of_nodes(const MatX<double>& d) const;
  MatX<double> solve_of_nodes(const MatX<double>& x) const;
  /// C d, C^T x and C^-1 x over all coordinates.
  MatX<double> root(const MatX<double>& d) const;
  MatX<double> transposed(const MatX<double>& x) const;
  MatX<double> solve(const MatX<double>& x) const;
  /// M over all coordinates.
  Eigen::SparseMatrix<double> whole() const;

 private:
  /// act on the columns of x, y and z of all, and the roots of own inertia on the rest.
  template <class Nodal, class Own>
  MatX<double> each(const MatX<double>& all, Nodal&& nodal, Own&& own) const;

  Eigen::SparseMatrix<double> M_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
  VecX<double> own_;  ///< roots
};

}  // namespace pliant
