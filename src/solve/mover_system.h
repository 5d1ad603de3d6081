// (1 + A) x = b for the velocities of movers that contacts couple. Points, of which there may be many and
// each coupled to few others, are eliminated first, the one with the fewest neighbours next; the others at
// once.
#pragma once

#include <vector>

#include <pliant/math/types.h>

namespace pliant {

class MoverSystem {
 public:
  // The pattern, in this order.

  /// Of no movers yet, whose velocities are among n_x.
  void begin(int n_x);
  /// A mover whose velocities begin at `first`; it may be added again. One of three is a point.
  void add_mover(int first, int size);
  /// No more movers.
  void number();
  /// Two that A couples, told by a velocity of each.
  void couple(int x, int y);
  /// Finds the order of elimination.
  void order();

  /// Whether a velocity is of a mover here.
  bool has(int x) const { return mover_of_[at(x)] >= 0; }

  // Values, as often as wanted.

  /// A = 0, b = 0.
  void clear();
  /// Adds to b from `first` on, in a mover.
  template <class Vector>
  void add(int first, const Eigen::MatrixBase<Vector>& b) {
    b_.segment<Vector::RowsAtCompileTime>(row_of_[at(first)], b.rows()) += b;
  }
  /// Adds to the block of A from `row` and `column` on, in movers that are coupled.
  template <class Matrix>
  void add(int row, int column, const Eigen::MatrixBase<Matrix>& A) {
    A_.block<Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime>(row_of_[at(row)], row_of_[at(column)],
                                                                   A.rows(), A.cols()) += A;
  }
  /// Leaves numbers that are not finite where it is singular.
  void solve();
  /// x from `first` on, in a mover.
  auto change(int first, int size) const { return b_.segment(row_of_[at(first)], size); }

 private:
  struct Mover {
    int first, size;
    Eigen::Index row = 0;
    int neighbours = 0;      ///< that are not eliminated yet
    bool done = false;       ///< whether it is
    std::vector<int> after;  ///< neighbours when it was, in ascending order
  };
  static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }
  bool coupled(int i, int j) const { return coupled_[at(i) * at(n_movers_) + at(j)] != 0; }
  void set_coupled(int i, int j) { coupled_[at(i) * at(n_movers_) + at(j)] = 1; }
  void eliminate(const Mover& k);
  void solve_others();

  std::vector<Mover> movers_;  // as they came; more than there are, to be used again
  int n_movers_ = 0;
  std::vector<int> mover_of_;  // of each velocity; -1 of those of no mover here
  std::vector<Eigen::Index> row_of_;
  std::vector<char> coupled_;         // of each pair of movers, also by what is eliminated
  std::vector<int> points_, others_;  // movers, points in the order of elimination
  MatX<double> A_, A_others_;
  VecX<double> b_, b_others_;
};

}  // namespace pliant
