// The elimination order by AMD, and the choice of SuiteSparse for joint systems.
#include <pliant/solve/suitesparse.h>

#include <cholmod.h>

#include <new>

#include <pliant/solve/cholmod_factor.h>

namespace pliant {

std::vector<int> amd_order(const std::vector<int>& first, const std::vector<int>& neighbour) {
  cholmod_common common;
  cholmod_start(&common);
  common.print = 0;
  // The lower triangle of the graph; CHOLMOD does not write to it.
  std::vector<int> columns(1, 0), rows;
  const std::size_t n = first.size() - 1;
  for (std::size_t j = 0; j < n; ++j) {
    for (int k = first[j]; k < first[j + 1]; ++k)
      if (neighbour[static_cast<std::size_t>(k)] > static_cast<int>(j))
        rows.push_back(neighbour[static_cast<std::size_t>(k)]);
    columns.push_back(static_cast<int>(rows.size()));
  }
  rows.push_back(0);  // never read; data() must not be null
  cholmod_sparse graph{};
  graph.nrow = graph.ncol = n;
  graph.nzmax = rows.size();
  graph.p = columns.data();
  graph.i = rows.data();
  graph.stype = -1;
  graph.itype = CHOLMOD_INT;
  graph.xtype = CHOLMOD_PATTERN;
  graph.dtype = CHOLMOD_DOUBLE;
  graph.packed = 1;
  std::vector<int> order(n);
  const bool done = cholmod_amd(&graph, nullptr, 0, order.data(), &common) != 0;
  cholmod_finish(&common);
  if (!done) throw std::bad_alloc();
  return order;
}

void use_suitesparse(JointSolver& solver) {
  solver.make_factor = [] { return make_cholmod_factor(); };
  solver.order = amd_order;
}

}  // namespace pliant
