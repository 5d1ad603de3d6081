// (1 + A) x = b for the velocities of movers that contacts couple, of which there may be many and each
// coupled to few others: they are eliminated one after the other, the one with the fewest neighbours next.
#pragma once

#include <vector>

#include <pliant/math/types.h>

namespace pliant {

class MoverSystem {
 public:
  // The pattern, in this order.

  /// Returns the number of the mover.
  int add_mover(int size);
  /// Two that A couples.
  void couple(int i, int j);
  /// Finds the order of elimination, and where all numbers go. Returns false where they would be more than
  /// `most` times those of the movers' own blocks: nothing can be solved then.
  bool order(double most);

  bool empty() const { return movers_.empty(); }
  bool is_ordered() const { return b_.size() > 0; }

  // Values, as often as wanted.

  /// Where the velocities of a mover begin in x and b.
  int row(int mover) const { return movers_[at(mover)].row; }
  /// A block of A among its numbers.
  struct Block {
    std::size_t first;
    int stride;  ///< from column to column
  };
  /// That of two movers that are coupled.
  Block block(int i, int j) const;

  /// A = 0, b = 0.
  void clear();
  /// Adds to b from a row on.
  template <class Vector>
  void add(int row, const Eigen::MatrixBase<Vector>& b) {
    b_.segment<Vector::RowsAtCompileTime>(row, b.rows()) += b;
  }
  /// Adds to A where a block, or columns of one, begin.
  template <class Matrix>
  void add(const Block& block, const Eigen::MatrixBase<Matrix>& A) {
    using Numbers = Eigen::Matrix<double, Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime>;
    Eigen::Map<Numbers, 0, Eigen::OuterStride<>>(numbers_.data() + block.first, A.rows(), A.cols(),
                                                 Eigen::OuterStride<>(block.stride)) += A;
  }
  /// Leaves numbers that are not finite where it is singular.
  void solve();
  /// x from a row on.
  auto change(int row, int size) const { return b_.segment(row, size); }

 private:
  struct Mover {
    int size = 3, row = 0, turn = 0;  ///< turn: when it is eliminated
    bool even = true;                 ///< whether those that are left near it then are of its size
    std::vector<int> near;            ///< neighbours that are left then, in ascending order
    std::size_t numbers = 0;          ///< where those of its block begin, then of those above and left of it
    std::size_t targets = 0;          ///< where those begin that its elimination changes
  };
  static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }
  /// N: the size of the mover and of all its neighbours, or Eigen::Dynamic.
  template <int N>
  void eliminate(const Mover& k);

  std::vector<Mover> movers_;
  std::vector<int> turns_;            // movers in the order of elimination
  std::vector<std::size_t> targets_;  // blocks of pairs of neighbours, columns first
  VecX<double> numbers_;              // of A, in the order of elimination
  VecX<double> b_;
};

}  // namespace pliant
