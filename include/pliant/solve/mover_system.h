// The linear system (1 + A) x = b for the velocities of movers (coulomb_system.h) that contacts couple. There
// can be many movers, each coupled to few others. The movers are eliminated one after the other; the next one
// is always the mover with the fewest remaining neighbours.
#pragma once

#include <algorithm>
#include <vector>

#include <pliant/math/scalar/power_of_two.h>
#include <pliant/math/types.h>

namespace pliant {

/// The system of one cluster.
class MoverSystem {
 public:
  // The pattern: call these functions first, in this order.

  /// Adds a mover with `size` velocities and returns its number.
  int add_mover(int size);
  /// Adds the blocks A_ij and A_ji for the movers i and j. The diagonal blocks always exist.
  void couple(int i, int j);
  /// Computes the order of elimination and the storage. Returns false if the storage would exceed `max_fill`
  /// times the storage of the diagonal blocks; the system then cannot be solved.
  bool order(double max_fill);

  bool empty() const { return movers_.empty(); }
  bool is_ordered() const { return b_.size() > 0; }

  // The values: assemble and solve, any number of times.

  /// Returns the first row of a mover in x and b.
  int row(int mover) const { return movers_[at(mover)].row; }
  /// The storage of a block of A, by columns.
  struct Block {
    std::size_t first;
    int stride;  ///< distance of the starts of two columns
  };
  /// Raises the weight of a row: the factor that makes its velocity comparable with those of other rows. The
  /// elimination pivots on weighted rows. A row whose weight was never raised is not used as a pivot of other
  /// columns.
  void raise_weight(int row, double weight) {
    if (weight > 0) weight_[row] = std::max(weight_[row], power_of_two(weight));
  }
  /// Returns the storage of the block A_ij. The movers i and j must be equal or coupled.
  Block block(int i, int j) const;

  /// Sets A = 0 and b = 0.
  void clear();
  /// Adds a vector to b, starting at a row.
  template <class Vector>
  void add(int row, const Eigen::MatrixBase<Vector>& b) {
    b_.segment<Vector::RowsAtCompileTime>(row, b.rows()) += b;
  }
  /// Adds a matrix to a block of A, or to some columns of the block if block.first is the first number of the
  /// first of these columns.
  template <class Matrix>
  void add(const Block& block, const Eigen::MatrixBase<Matrix>& A) {
    using Numbers = Eigen::Matrix<double, Matrix::RowsAtCompileTime, Matrix::ColsAtCompileTime>;
    Eigen::Map<Numbers, 0, Eigen::OuterStride<>>(numbers_.data() + block.first, A.rows(), A.cols(),
                                                 Eigen::OuterStride<>(block.stride)) += A;
  }
  /// Solves the system by elimination without pivoting between movers; overwrites b by x. The solution is not
  /// checked: it can be wrong or not finite if the system is singular.
  void solve();
  /// Returns `size` values of x, starting at a row.
  auto change(int row, int size) const { return b_.segment(row, size); }

 private:
  struct Mover {
    int size = 3, row = 0, position = 0;  ///< position: in the order of elimination
    bool uniform = true;                  ///< whether all its remaining neighbours have its size
    std::vector<int> neighbours;  ///< movers coupled to it that are eliminated later, in ascending order
    /// Start in numbers_ of the diagonal block of this mover k. The blocks A_kj and A_jk of each neighbour j
    /// follow this block.
    std::size_t numbers = 0;
    std::size_t targets = 0;  ///< start in targets_ of the list of blocks that its elimination changes
  };
  static std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }
  /// N: size of the mover. M: size of all its neighbours. Either may be Eigen::Dynamic.
  template <int N, int M>
  void eliminate(const Mover& k);
  /// Returns the inverse of the diagonal block of a mover.
  template <int N>
  Eigen::Matrix<double, N, N> inverse_of(const Mover& k) const;

  std::vector<Mover> movers_;
  std::vector<int> sequence_;         // movers in the order of elimination
  std::vector<std::size_t> targets_;  // for each mover: storage of the blocks of its pairs of neighbours
  VecX<double> numbers_;              // the entries of 1 + A, in the order of elimination
  VecX<double> b_;
  VecX<double> weight_;  // of each row: a power of two
};

}  // namespace pliant
