// The pattern of a symmetric matrix of small blocks and of its factor L D L^T. A node is a group of rows, and
// a block has the rows of one node and the columns of another; in the joint system a node is a joint. The
// pattern is computed once: the order of elimination, the fill-in, the list of block products, and the last
// rows and columns, which are factored as one dense matrix.
#pragma once

#include <utility>
#include <vector>

namespace pliant {

/// Largest number of rows of a node.
inline constexpr int kMaxBlock = 6;

/// A function that returns an order of elimination: the node at each place. A place is a position in the
/// order, from 0. The neighbours of node i are neighbour[first[i]] ... neighbour[first[i + 1] - 1].
using NodeOrder = std::vector<int> (*)(const std::vector<int>& first, const std::vector<int>& neighbour);
/// Returns the approximate minimum degree order, computed by Eigen.
std::vector<int> minimum_degree_order(const std::vector<int>& first, const std::vector<int>& neighbour);
/// Returns the order of a maximum cardinality search (Tarjan & Yannakakis 1984). The elimination has no
/// fill-in if an order without fill-in exists, as for the joint systems of chains and trees.
std::vector<int> cardinality_order(const std::vector<int>& first, const std::vector<int>& neighbour);

/// Minimum number of rows of the dense matrix. Fewer rows are factored by blocks, which costs no more.
inline constexpr int kFewDense = 18;

/// An order of elimination for a graph whose nodes have several rows each, with its fill-in and its cost.
struct Elimination {
  std::vector<int> sizes;               ///< rows of each node
  std::vector<int> node_at;             ///< the node at each place
  std::vector<std::vector<int>> below;  ///< for each place, the later places with a block in its column of L
  int first_dense = 0;      ///< the first place of the dense matrix; number of nodes if there is none
  long products = 0;        ///< multiplications of a factorisation
  long dense_products = 0;  ///< multiplications in the dense matrix, included in products
  long values = 0;          ///< numbers in the blocks of the factor
};
/// Returns the elimination of a graph in the order that `order` returns. sizes: number of rows of each node.
/// edges: pairs of nodes whose block is not zero, in any order; pairs may repeat.
Elimination eliminate(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& edges,
                      NodeOrder order);
/// Computes two eliminations, in cardinality_order and in the given order. Returns the one that needs fewer
/// multiplications.
Elimination cheapest_elimination(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& edges,
                                 NodeOrder order);

/// The storage of the blocks of a factor, and the updates of the elimination.
class BlockPattern {
 public:
  BlockPattern() = default;
  /// Computes the pattern of an elimination. Nodes have at most kMaxBlock rows.
  explicit BlockPattern(const Elimination& elimination);
  BlockPattern(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& edges, NodeOrder order)
      : BlockPattern(eliminate(sizes, edges, order)) {}

  /// The storage of one block, by columns. (This is not a place in the order.)
  struct Place {
    int offset;    ///< index of the first number
    bool swapped;  ///< for place(u, v): whether the block has the rows of v and the columns of u
  };
  /// Returns the storage of the block of the nodes u and v. Throws std::out_of_range if it is not in the
  /// pattern.
  Place place(int u, int v) const;

  int nodes() const { return static_cast<int>(columns_.size()); }
  int rows() const { return rows_; }
  /// Returns the number of values in all blocks: the storage that a factor needs.
  int values() const { return values_; }

  /// A block below the diagonal in a column.
  struct Block {
    int place;   ///< the place of its row node in the order
    int offset;  ///< index of the first number
  };
  /// A node at its place in the order.
  struct Column {
    int size;         ///< number of rows of the node
    int row;          ///< the first row of the node in the vectors, which are in the order of the nodes
    int diagonal;     ///< offset of the diagonal block
    int first, last;  ///< range of the blocks below the diagonal
    /// Index in updates() of the first update of the column. There is one update for each pair (a, b) of its
    /// blocks below the diagonal, a >= b.
    int first_update;
  };
  /// Returns the columns in the order of elimination; the columns of the dense matrix are the last ones.
  const std::vector<Column>& columns() const { return columns_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  /// Returns, for each update of each column, the offset of the block that it changes. The columns of the
  /// dense matrix have no updates.
  const std::vector<int>& updates() const { return updates_; }
  /// Returns the first column of the dense matrix: 0 if the whole matrix is dense, nodes() if there is no
  /// dense matrix, for example for a chain.
  int first_dense() const { return first_dense_; }
  /// Returns the rows of the dense matrix, as rows of the vectors.
  const std::vector<int>& dense_rows() const { return dense_rows_; }

 private:
  std::vector<Column> columns_;
  std::vector<Block> blocks_;
  std::vector<int> updates_;
  std::vector<int> place_of_;  // the place of each node
  std::vector<int> dense_rows_;
  int rows_ = 0, values_ = 0, first_dense_ = 0;
};

}  // namespace pliant
