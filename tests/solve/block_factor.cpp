// The block factorisation against dense algebra: random patterns and block sizes in three orders of
// elimination, redundant rows, and derivatives.
#include "catch.h"

#include <numeric>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <Eigen/QR>

#include <pliant/solve/block_factor.h>

#include "draws.h"

namespace block_factor_test {

using namespace pliant;
using test::Draws;

namespace {

/// Returns the nodes in the given order (0, 1, ...), as a NodeOrder of solve/block_pattern.h.
std::vector<int> given_order(const std::vector<int>& first, const std::vector<int>&) {
  std::vector<int> order(first.size() - 1);
  std::iota(order.begin(), order.end(), 0);
  return order;
}

/// A random positive definite matrix A = G G^T of blocks. Each node is a row of blocks. G has a column of
/// blocks for each edge and for each node.
struct Sample {
  std::vector<int> sizes, row;
  std::vector<std::pair<int, int>> edges;
  MatX<double> A;

  Sample(Draws& draws, int nodes, int more_edges, bool chain) {
    int rows = 0;
    for (int u = 0; u < nodes; ++u) {
      sizes.push_back(chain ? 3 : draws.integer(1, 6));
      row.push_back(rows);
      rows += sizes.back();
      if (u > 0) edges.emplace_back(chain ? u - 1 : draws.integer(0, u - 1), u);
    }
    for (int e = 0; e < more_edges; ++e)
      edges.emplace_back(draws.integer(0, nodes - 1), draws.integer(0, nodes - 1));
    A = MatX<double>::Zero(rows, rows);
    auto add = [&](int u, int v) {
      MatX<double> G = MatX<double>::Zero(rows, 6);
      for (const int node : {u, v})
        for (int i = 0; i < sizes[static_cast<std::size_t>(node)]; ++i)
          for (int k = 0; k < 6; ++k) G(row[static_cast<std::size_t>(node)] + i, k) = draws.uniform(-1, 1);
      A += G * G.transpose();
    };
    for (const auto& [u, v] : edges) add(u, v);
    for (int u = 0; u < nodes; ++u) add(u, u);
  }

  template <class S, class Matrix>
  void fill(const BlockPattern& pattern, const Matrix& of, BlockFactor<S>& factor) const {
    factor.clear(pattern);
    auto set = [&](int u, int v) {
      const BlockPattern::Place place = pattern.place(u, v);
      if (place.swapped) std::swap(u, v);
      S* block = factor.block(place.offset);
      const int n = sizes[static_cast<std::size_t>(u)], m = sizes[static_cast<std::size_t>(v)];
      for (int k = 0; k < m; ++k)
        for (int i = 0; i < n; ++i)
          block[k * n + i] = of(row[static_cast<std::size_t>(u)] + i, row[static_cast<std::size_t>(v)] + k);
    };
    for (const auto& [u, v] : edges) set(u, v);
    for (int u = 0; u < static_cast<int>(sizes.size()); ++u) set(u, u);
  }
};

VecX<double> random(Draws& draws, Eigen::Index n) {
  VecX<double> x(n);
  for (Eigen::Index i = 0; i < n; ++i) x[i] = draws.uniform(-1, 1);
  return x;
}

}  // namespace

TEST_CASE("block factor: solutions agree with dense algebra, in any order", "[block_factor]") {
  Draws draws(1);
  for (int trial = 0; trial < 200; ++trial) {
    const bool chain = trial % 3 == 0;
    // many edges fill the matrix
    const int more_edges = chain ? 0 : draws.integer(0, trial % 3 == 1 ? 15 : 300);
    const Sample sample(draws, draws.integer(1, 20), more_edges, chain);
    const VecX<double> b = random(draws, sample.A.rows()), expected = sample.A.ldlt().solve(b);
    for (const NodeOrder order : {minimum_degree_order, cardinality_order, given_order}) {
      const BlockPattern pattern(sample.sizes, sample.edges, order);
      BlockFactor<double> factor;
      sample.fill(pattern, sample.A, factor);
      factor.factor();
      VecX<double> x = b;
      factor.solve(x);
      CHECK(factor.rank() == sample.A.rows());
      CHECK((x - expected).norm() <= 1e-9 * expected.norm());
    }
  }
}

TEST_CASE("block factor: a chain and a tree have no fill-in", "[block_factor]") {
  Draws draws(2);
  for (const bool chain : {true, false}) {
    const Sample sample(draws, 200, 0, chain);
    const BlockPattern pattern(cheapest_elimination(sample.sizes, sample.edges, minimum_degree_order));
    int expected = 0;
    for (const int size : sample.sizes) expected += size * size;
    for (const auto& [u, v] : sample.edges)
      expected += sample.sizes[static_cast<std::size_t>(u)] * sample.sizes[static_cast<std::size_t>(v)];
    CHECK(pattern.values() == expected);
  }
}

TEST_CASE(
    "block factor: the last nodes form one dense matrix if all are neighbours and have at least 18 rows",
    "[block_factor]") {
  auto all_pairs = [](int first, int last) {
    std::vector<std::pair<int, int>> edges;
    for (int v = first; v < last; ++v)
      for (int u = first; u < v; ++u) edges.emplace_back(u, v);
    return edges;
  };
  const std::vector<int> chain(100, 3), star(9, 3), few(5, 3);
  std::vector<std::pair<int, int>> links;
  for (int u = 1; u < 100; ++u) links.emplace_back(u - 1, u);
  CHECK(BlockPattern(chain, links, cardinality_order).dense_rows().empty());
  CHECK(BlockPattern(few, all_pairs(0, 5), cardinality_order).dense_rows().empty());
  const BlockPattern all(star, all_pairs(0, 9), cardinality_order);
  CHECK(all.first_dense() == 0);
  CHECK(all.dense_rows().size() == 27);
  CHECK(all.updates().empty());
  // A chain that ends in a set of nodes that are all neighbours. The chain is factored by blocks, and the set
  // as one dense matrix.
  std::vector<std::pair<int, int>> both = all_pairs(91, 100);
  both.insert(both.end(), links.begin(), links.end());
  const BlockPattern last(chain, both, given_order);
  CHECK(last.first_dense() == 91);
  CHECK(last.dense_rows().front() == 3 * 91);
}

TEST_CASE("block factor: redundant rows get zero solutions, and the remaining rows are solved",
          "[block_factor]") {
  Draws draws(3);
  for (int trial = 0; trial < 100; ++trial) {
    Sample sample(draws, draws.integer(2, 12), draws.integer(0, 5), false);
    // A row and its column are replaced by copies of another row and its column. The rank falls by one, and
    // the system stays solvable.
    const auto n = static_cast<int>(sample.A.rows());
    const int copy = draws.integer(0, n - 1);
    int original = draws.integer(0, n - 2);
    if (original >= copy) ++original;
    // All pairs are neighbours, so that the pattern contains the copy.
    for (int u = 0; u < static_cast<int>(sample.sizes.size()); ++u)
      for (int v = 0; v < u; ++v) sample.edges.emplace_back(u, v);
    sample.A.row(copy) = sample.A.row(original);
    sample.A.col(copy) = sample.A.col(original);
    const VecX<double> b = sample.A * random(draws, n);
    const BlockPattern pattern(cheapest_elimination(sample.sizes, sample.edges, minimum_degree_order));
    BlockFactor<double> factor;
    sample.fill(pattern, sample.A, factor);
    factor.factor();
    VecX<double> x = b;
    factor.solve(x);
    CHECK(factor.rank() == n - 1);
    CHECK((factor.excluded(copy) || factor.excluded(original)));
    CHECK((sample.A * x - b).norm() <= 1e-9 * b.norm());
  }
}

TEST_CASE("block factor: derivatives of the solution", "[block_factor]") {
  Draws draws(4);
  for (int trial = 0; trial < 30; ++trial) {
    const int more_edges = trial % 3 == 0 ? 200 : draws.integer(0, 5);  // many edges fill the matrix
    const Sample sample(draws, draws.integer(1, 10), more_edges, trial % 2 == 0);
    const auto n = sample.A.rows();
    const VecX<double> b = random(draws, n), db = random(draws, n);
    // dA has the pattern of A.
    const MatX<double> dA = (0.3 * sample.A.array() * sample.A.array()).matrix();
    Eigen::Matrix<Dual<1>, Eigen::Dynamic, Eigen::Dynamic> A(n, n);
    VecX<Dual<1>> x(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      x[i] = Dual<1>(b[i]);
      x[i].d[0] = db[i];
      for (Eigen::Index k = 0; k < n; ++k) {
        A(i, k) = Dual<1>(sample.A(i, k));
        A(i, k).d[0] = dA(i, k);
      }
    }
    const BlockPattern pattern(cheapest_elimination(sample.sizes, sample.edges, minimum_degree_order));
    BlockFactor<Dual<1>> factor;
    sample.fill(pattern, A, factor);
    factor.factor();
    factor.solve(x);
    const Eigen::LDLT<MatX<double>> dense(sample.A);
    const VecX<double> value = dense.solve(b), slope = dense.solve(db - dA * value);
    for (Eigen::Index i = 0; i < n; ++i) {
      CHECK(std::abs(x[i].v - value[i]) <= 1e-9 * value.norm());
      CHECK(std::abs(x[i].d[0] - slope[i]) <= 1e-8 * (slope.norm() + value.norm()));
    }
  }
}

TEST_CASE("block factor: a tiny pivot is excluded if its row was given a larger scale") {
  const BlockPattern pattern({1, 1}, {}, given_order);
  for (const bool measured : {false, true}) {
    BlockFactor<double> factor;
    factor.clear(pattern);
    *factor.block(pattern.place(0, 0).offset) = 1e-20;
    *factor.block(pattern.place(1, 1).offset) = 2;
    if (measured) factor.raise_scale(0, 1);
    factor.factor();
    CHECK(factor.excluded(0) == measured);
    CHECK_FALSE(factor.excluded(1));
    VecX<double> x(2);
    x << 1, 6;
    factor.solve(x);
    CHECK(x[0] == Approx(measured ? 0 : 1e20));
    CHECK(x[1] == 3);
  }
}

TEST_CASE("block factor: the rows of three points that join two bodies are solved to rounding at any tilt",
          "[block_factor]") {
  // Two bodies have nine rows for six relative motions. Near tilt 0, after elimination of the first point,
  // the rows x and y of the second point are nearly dependent. The elimination must exclude one of these two
  // rows. If it used both, their small difference would take the place of row z, and row z would be excluded
  // instead.
  for (const int interfaces : {1, 2, 3}) {  // 9, 18 and 27 rows: blocks, and the dense matrix
    for (const double tilt : {0.0, 1e-9, 1e-7, 1e-6, 1e-5, 3e-5, 1e-4, 1e-3, 0.1, 1.0}) {
      CAPTURE(interfaces, tilt);
      const int points = 3 * interfaces;
      MatX<double> J = MatX<double>::Zero(3 * points, 6 * (interfaces + 1));
      const Eigen::Matrix3d R = Eigen::AngleAxisd(tilt, Eigen::Vector3d(0.6, 0.8, 0).normalized()).matrix();
      for (int p = 0; p < points; ++p) {
        const double angle = 2 * kPi / 3 * p;
        for (const int side : {0, 1}) {
          const double height = side == 0 ? 0.3 : -0.3;
          const Eigen::Vector3d r = R * Eigen::Vector3d(0.1 * std::cos(angle), 0.1 * std::sin(angle), height);
          const double sign = side == 0 ? 1 : -1;
          Eigen::Matrix3d cross;
          cross << 0, -r[2], r[1], r[2], 0, -r[0], -r[1], r[0], 0;
          J.block<3, 3>(3 * p, 6 * (p / 3 + side)) = sign * Eigen::Matrix3d::Identity();
          J.block<3, 3>(3 * p, 6 * (p / 3 + side) + 3) = -sign * cross;
        }
      }
      std::vector<std::pair<int, int>> edges;
      for (int u = 0; u < points; ++u)
        for (int v = 0; v < u; ++v)
          if (u / 3 - v / 3 <= 1) edges.emplace_back(u, v);
      const std::vector<int> sizes(static_cast<std::size_t>(points), 3);
      const BlockPattern pattern(sizes, edges, given_order);
      BlockFactor<double> factor;
      factor.clear(pattern);
      const MatX<double> A = J * J.transpose();
      auto fill = [&](int u, int v) {
        const BlockPattern::Place place = pattern.place(u, v);
        const Eigen::Matrix3d block = A.block<3, 3>(3 * (place.swapped ? v : u), 3 * (place.swapped ? u : v));
        std::copy_n(block.data(), 9, factor.block(place.offset));
      };
      for (const auto& [u, v] : edges) fill(u, v);
      for (int u = 0; u < points; ++u) fill(u, u);
      factor.factor();
      Draws draws(5);
      const VecX<double> b = J * random(draws, J.cols());
      VecX<double> x = b;
      factor.solve(x);
      CHECK(factor.rank() == 6 * interfaces);
      CHECK((A * x - b).norm() <= 1e-12 * b.norm());
    }
  }
}

}  // namespace block_factor_test
