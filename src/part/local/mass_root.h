// A square root C of a mass matrix, M = C^T C. The mass matrix may couple nodes; the coupling is equal along
// x, y and z. The own coordinates of an energy (local/nodal_energy.h) have a diagonal block of M. x = C d are
// mass-normalised coordinates.
#pragma once

#include <vector>

#include <Eigen/SparseCholesky>

#include <pliant/local/nodes.h>

namespace pliant {

class MassRoot {
 public:
  /// nodes: M over n nodes, n x n, kg. own: inertia of the own coordinates of an energy; every entry must be
  /// positive. Throws std::invalid_argument if `nodes` is not positive definite.
  MassRoot(Eigen::SparseMatrix<double> nodes, const VecX<double>& own);

  Eigen::Index n_nodes() const { return M_.rows(); }
  /// Number of all coordinates: 3 for each node, and the own coordinates.
  Eigen::Index size() const { return 3 * n_nodes() + own_.size(); }
  /// M over nodes.
  const Eigen::SparseMatrix<double>& of_nodes() const { return M_; }
  /// These functions return C d and C^-1 x for scalar fields over nodes. Each column of d or x is one field.
  MatX<double> root_of_nodes(const MatX<double>& d) const;
  MatX<double> solve_of_nodes(const MatX<double>& x) const;
  /// These functions return C d, C^T x and C^-1 x for columns d or x over all coordinates.
  MatX<double> root(const MatX<double>& d) const;
  MatX<double> transposed(const MatX<double>& x) const;
  MatX<double> solve(const MatX<double>& x) const;
  /// Returns M over all coordinates.
  Eigen::SparseMatrix<double> whole() const;

 private:
  /// Applies `nodal` to each of the three blocks of n_nodes() rows (components along x, y and z), and `own`
  /// to the rows of the own coordinates.
  template <class Nodal, class Own>
  MatX<double> each(const MatX<double>& all, Nodal&& nodal, Own&& own) const;

  Eigen::SparseMatrix<double> M_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
  VecX<double> own_;  // square roots of the inertia of the own coordinates
};

}  // namespace pliant
