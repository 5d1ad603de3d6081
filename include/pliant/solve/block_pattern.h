// The pattern of a symmetric matrix of small blocks and of its factor L D L^T, found once: the order of
// elimination, the blocks that fill in, the list of block products that the elimination is, and where it ends
// with a dense matrix.
#pragma once

#include <utility>
#include <vector>

namespace pliant {

/// Largest number of rows of a block.
inline constexpr int kMaxBlock = 6;

/// A fill-reducing order of the nodes of a graph: the node at each place. Neighbours of node i are
/// neighbour[first[i]] ... neighbour[first[i + 1] - 1].
using NodeOrder = std::vector<int> (*)(const std::vector<int>& first, const std::vector<int>& neighbour);
/// Approximate minimum degree, by Eigen.
std::vector<int> minimum_degree_order(const std::vector<int>& first, const std::vector<int>& neighbour);
/// Maximum cardinality search (Tarjan & Yannakakis 1984): nothing fills in where that is possible, as in the
/// systems of chains and trees.
std::vector<int> cardinality_order(const std::vector<int>& first, const std::vector<int>& neighbour);

/// Rows that the last nodes must have together to be factored as one dense matrix, when no block of them is
/// zero: below this, blocks cost no more.
inline constexpr int kFewDense = 18;

/// A graph of nodes of several rows each, in an order of elimination, and what fills in.
struct Elimination {
  std::vector<int> sizes;               ///< rows of each node
  std::vector<int> node_at;             ///< the node at each place
  std::vector<std::vector<int>> below;  ///< of each place, the places whose blocks are not zero
  int first_dense = 0;                  ///< the place from which all is one dense matrix
  long products = 0;                    ///< multiplications of a factorisation
  long dense_products = 0;              ///< those of the dense matrix among them
  long values = 0;                      ///< numbers in the blocks of the factor
};
/// edges: pairs of nodes whose block is not zero, in any order.
Elimination eliminate(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& edges,
                      NodeOrder order);
/// By the order that costs the least, of the cardinality search and a given one.
Elimination cheapest_elimination(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& edges,
                                 NodeOrder order);

class BlockPattern {
 public:
  BlockPattern() = default;
  /// Nodes have at most kMaxBlock rows.
  explicit BlockPattern(const Elimination& elimination);
  BlockPattern(const std::vector<int>& sizes, const std::vector<std::pair<int, int>>& edges, NodeOrder order)
      : BlockPattern(eliminate(sizes, edges, order)) {}

  /// Where a block of the matrix is stored, by columns: rows of `row`, columns of `column`, one of them u and
  /// the other v. Throws std::out_of_range if it is not in the pattern.
  struct Place {
    int offset;
    bool swapped;  ///< it holds the rows of v and the columns of u
  };
  Place place(int u, int v) const;

  int nodes() const { return static_cast<int>(columns_.size()); }
  int rows() const { return rows_; }
  /// Numbers that the blocks of the factor hold: the storage that a factor needs.
  int values() const { return values_; }

  /// A block below the diagonal in a column.
  struct Block {
    int place;   ///< its row, as place in the order
    int offset;  ///< of its first number
  };
  /// A node at its place in the order.
  struct Column {
    int size;
    int row;           ///< its first row in the vectors, in the order of the nodes
    int diagonal;      ///< offset of its diagonal block
    int first, last;   ///< its blocks below
    int first_update;  ///< of its updates: one for each pair (a, b) of its blocks, a from b on
  };
  /// Those that are eliminated block by block come first.
  const std::vector<Column>& columns() const { return columns_; }
  const std::vector<Block>& blocks() const { return blocks_; }
  /// Offsets of the blocks that the pairs of blocks of each column change, before the dense ones.
  const std::vector<int>& updates() const { return updates_; }
  /// The first of the columns that are one dense matrix: all of a small star, none of a chain.
  int first_dense() const { return first_dense_; }
  /// Rows in the vectors of that matrix.
  const std::vector<int>& dense_rows() const { return dense_rows_; }

 private:
  std::vector<Column> columns_;
  std::vector<Block> blocks_;
  std::vector<int> updates_;
  std::vector<int> place_of_;  // of each node
  std::vector<int> dense_rows_;
  int rows_ = 0, values_ = 0, first_dense_ = 0;
};

}  // namespace pliant
