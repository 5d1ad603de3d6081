// Orders of elimination, fill-in and storage of block matrices.
#pragma once

#include <pliant/solve/block_pattern.h>

#include <algorithm>
#include <stdexcept>
#include <string>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>

#include <pliant/math/header_only.h>

namespace pliant {

PLIANT_INLINE std::vector<int> minimum_degree_order(const std::vector<int>& first,
                                                    const std::vector<int>& neighbour) {
  const auto n = static_cast<Eigen::Index>(first.size()) - 1;
  std::vector<Eigen::Triplet<double>> entries;
  for (int i = 0; i < n; ++i) {
    entries.emplace_back(i, i, 1.0);
    for (int k = first[static_cast<std::size_t>(i)]; k < first[static_cast<std::size_t>(i) + 1]; ++k)
      entries.emplace_back(i, neighbour[static_cast<std::size_t>(k)], 1.0);
  }
  Eigen::SparseMatrix<double> graph(n, n);
  graph.setFromTriplets(entries.begin(), entries.end());
  Eigen::AMDOrdering<int>::PermutationType order(n);
  Eigen::AMDOrdering<int>()(graph, order);
  return {order.indices().data(), order.indices().data() + n};
}

PLIANT_INLINE std::vector<int> cardinality_order(const std::vector<int>& first,
                                                 const std::vector<int>& neighbour) {
  const std::size_t n = first.size() - 1;
  // Nodes are numbered from the last place to the first. Stack s contains the nodes without a number that
  // have s numbered neighbours. A node that gains a numbered neighbour is pushed on the next stack; its old
  // entry remains and is skipped later.
  std::vector<std::vector<int>> stack(1);
  std::vector<int> numbered(n, 0), order(n);
  for (std::size_t i = n; i-- > 0;) stack[0].push_back(static_cast<int>(i));
  for (std::size_t left = n; left > 0;) {
    const int node = stack.back().back();
    const auto largest = static_cast<int>(stack.size()) - 1;
    stack.back().pop_back();
    const bool current = numbered[static_cast<std::size_t>(node)] == largest;
    if (current) {
      order[--left] = node;
      numbered[static_cast<std::size_t>(node)] = -1;
      const auto begin = static_cast<std::size_t>(first[static_cast<std::size_t>(node)]),
                 end = static_cast<std::size_t>(first[static_cast<std::size_t>(node) + 1]);
      for (std::size_t k = begin; k < end; ++k) {
        int& count = numbered[static_cast<std::size_t>(neighbour[k])];
        if (count < 0) continue;
        ++count;
        if (stack.size() == static_cast<std::size_t>(count)) stack.emplace_back();
        stack[static_cast<std::size_t>(count)].push_back(neighbour[k]);
      }
    }
    while (stack.size() > 1 && stack.back().empty()) stack.pop_back();
  }
  return order;
}

namespace detail {

/// Returns the neighbours of each of n nodes, in ascending order, from a list of edges that may repeat.
inline std::vector<std::vector<int>> graph_neighbours(std::size_t n,
                                                      const std::vector<std::pair<int, int>>& edges) {
  std::vector<std::vector<int>> next(n);
  for (const auto& [u, v] : edges) {
    if (u == v) continue;
    next[static_cast<std::size_t>(u)].push_back(v);
    next[static_cast<std::size_t>(v)].push_back(u);
  }
  for (std::vector<int>& list : next) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return next;
}

}  // namespace detail

PLIANT_INLINE Elimination eliminate(const std::vector<int>& sizes,
                                    const std::vector<std::pair<int, int>>& edges, NodeOrder order) {
  const std::size_t n = sizes.size();
  const std::vector<std::vector<int>> next = detail::graph_neighbours(n, edges);
  std::vector<int> first(1, 0), neighbour;
  for (const std::vector<int>& list : next) {
    neighbour.insert(neighbour.end(), list.begin(), list.end());
    first.push_back(static_cast<int>(neighbour.size()));
  }
  Elimination result;
  result.sizes = sizes;
  if (n > 0) result.node_at = order(first, neighbour);
  std::vector<int> place_of(n);
  for (std::size_t j = 0; j < n; ++j)
    place_of[static_cast<std::size_t>(result.node_at[j])] = static_cast<int>(j);

  auto size_at = [&](int place) -> long {
    return sizes[static_cast<std::size_t>(result.node_at[static_cast<std::size_t>(place)])];
  };
  // Fill-in: the places below the diagonal of a column are added to the column at the first of these places.
  result.below.resize(n);
  std::vector<long> products(n);  // cost of each column
  for (std::size_t j = 0; j < n; ++j) {
    std::vector<int>& places = result.below[j];
    for (const int v : next[static_cast<std::size_t>(result.node_at[j])])
      if (place_of[static_cast<std::size_t>(v)] > static_cast<int>(j))
        places.push_back(place_of[static_cast<std::size_t>(v)]);
    std::sort(places.begin(), places.end());
    places.erase(std::unique(places.begin(), places.end()), places.end());
    const long size = size_at(static_cast<int>(j));
    long rows = 0, squares = 0;  // sums over the blocks below
    for (const int i : places) {
      rows += size_at(i);
      squares += size_at(i) * size_at(i);
    }
    products[j] = size * size * size / 6 + size + size * size * rows + size * (rows * rows + squares) / 2;
    result.values += size * (size + rows);
    result.products += products[j];
    if (places.empty()) continue;
    std::vector<int>& parent = result.below[static_cast<std::size_t>(places.front())];
    parent.insert(parent.end(), places.begin() + 1, places.end());
  }

  // The dense matrix begins where each column has blocks in all later places.
  const auto nodes = static_cast<int>(n);
  int first_dense = nodes;
  long rows = 0;
  while (first_dense > 0 &&
         static_cast<int>(result.below[static_cast<std::size_t>(first_dense - 1)].size()) ==
             nodes - first_dense)
    rows += size_at(--first_dense);
  result.first_dense = rows < kFewDense ? nodes : first_dense;
  for (int place = result.first_dense; place < nodes; ++place)
    result.dense_products += products[static_cast<std::size_t>(place)];
  return result;
}

PLIANT_INLINE Elimination cheapest_elimination(const std::vector<int>& sizes,
                                               const std::vector<std::pair<int, int>>& edges,
                                               NodeOrder order) {
  Elimination best = eliminate(sizes, edges, cardinality_order), other = eliminate(sizes, edges, order);
  return other.products < best.products ? other : best;
}

PLIANT_INLINE BlockPattern::BlockPattern(const Elimination& elimination) {
  const std::size_t n = elimination.sizes.size();
  const std::vector<int>&node_at = elimination.node_at, &sizes = elimination.sizes;
  place_of_.assign(n, 0);
  for (std::size_t j = 0; j < n; ++j) place_of_[static_cast<std::size_t>(node_at[j])] = static_cast<int>(j);
  std::vector<int> row_of(n);
  for (std::size_t u = 0; u < n; ++u) {
    row_of[u] = rows_;
    rows_ += sizes[u];
  }
  for (std::size_t j = 0; j < n; ++j) {
    const int size = sizes[static_cast<std::size_t>(node_at[j])];
    Column column{
        size, row_of[static_cast<std::size_t>(node_at[j])], values_, static_cast<int>(blocks_.size()), 0, 0};
    values_ += size * size;
    for (const int i : elimination.below[j]) {
      blocks_.push_back({i, values_});
      values_ += size * sizes[static_cast<std::size_t>(node_at[static_cast<std::size_t>(i)])];
    }
    column.last = static_cast<int>(blocks_.size());
    columns_.push_back(column);
  }

  auto offset_at = [&](int row, int column) {
    const Column& c = columns_[static_cast<std::size_t>(column)];
    if (row == column) return c.diagonal;
    const auto found = std::lower_bound(blocks_.begin() + c.first, blocks_.begin() + c.last, row,
                                        [](const Block& b, int r) { return b.place < r; });
    return found->offset;
  };
  first_dense_ = elimination.first_dense;
  for (int place = first_dense_; place < nodes(); ++place) {
    const Column& c = columns_[static_cast<std::size_t>(place)];
    for (int k = 0; k < c.size; ++k) dense_rows_.push_back(c.row + k);
  }
  for (int place = 0; place < first_dense_; ++place) {
    Column& column = columns_[static_cast<std::size_t>(place)];
    column.first_update = static_cast<int>(updates_.size());
    for (int b = column.first; b < column.last; ++b)
      for (int a = b; a < column.last; ++a)
        updates_.push_back(offset_at(blocks_[static_cast<std::size_t>(a)].place,
                                     blocks_[static_cast<std::size_t>(b)].place));
  }
}

PLIANT_INLINE BlockPattern::Place BlockPattern::place(int u, int v) const {
  const int at_u = place_of_.at(static_cast<std::size_t>(u)),
            at_v = place_of_.at(static_cast<std::size_t>(v));
  const Column& column = columns_[static_cast<std::size_t>(std::min(at_u, at_v))];
  if (at_u == at_v) return {column.diagonal, false};
  const int row = std::max(at_u, at_v);
  const auto end = blocks_.begin() + column.last;
  const auto found = std::lower_bound(blocks_.begin() + column.first, end, row,
                                      [](const Block& b, int r) { return b.place < r; });
  if (found == end || found->place != row)
    throw std::out_of_range("block (" + std::to_string(u) + ", " + std::to_string(v) +
                            ") is not in the pattern");
  return {found->offset, at_u < at_v};
}

}  // namespace pliant
