// The elimination of movers (groups of velocities, coulomb_system.h) of equal and of mixed sizes gives the
// solution of the dense system.
#include <pliant/solve/mover_system.h>

#include <vector>

#include <Eigen/LU>

#include "catch.h"
#include "draws.h"

namespace mover_system_test {

using namespace pliant;
using test::Draws;

TEST_CASE("the velocities of movers of any sizes are those of the dense system", "[coulomb]") {
  Draws draws(17);
  const std::vector<std::vector<int>> kinds{
      {3, 3, 3, 3}, {6, 6, 6}, {3, 7, 3, 3}, {6, 3, 6, 3}, {8, 6, 3, 7, 3, 6}};
  for (const std::vector<int>& sizes : kinds)
    for (int trial = 0; trial < 5; ++trial) {
      MoverSystem movers;
      const int n = static_cast<int>(sizes.size());
      for (const int size : sizes) movers.add_mover(size);
      // A ring, and a mover that is coupled to all others.
      const auto coupled = [&](int i, int j) {
        return i == j || i == 0 || j == 0 || (i + 1) % n == j || (j + 1) % n == i;
      };
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < i; ++j)
          if (coupled(i, j)) movers.couple(i, j);
      REQUIRE(movers.order(100));
      movers.clear();
      int rows = 0;
      for (const int size : sizes) rows += size;
      MatX<double> A = MatX<double>::Identity(rows, rows);
      VecX<double> b = VecX<double>::Zero(rows);
      const auto random = [&](int height, int width) {
        MatX<double> some(height, width);
        for (double& entry : some.reshaped()) entry = draws.uniform(-0.1, 0.1);
        return some;
      };
      for (int i = 0; i < n; ++i) {
        const int height = sizes[static_cast<std::size_t>(i)];
        for (int k = 0; k < height; ++k) movers.raise_weight(movers.row(i) + k, draws.uniform(0.1, 10));
        const VecX<double> of_b = random(height, 1);
        movers.add(movers.row(i), of_b);
        b.segment(movers.row(i), height) = of_b;
        for (int j = 0; j < n; ++j) {
          if (!coupled(i, j)) continue;
          const int width = sizes[static_cast<std::size_t>(j)];
          const MatX<double> of_A = random(height, width);
          movers.add(movers.block(i, j), of_A);
          A.block(movers.row(i), movers.row(j), height, width) += of_A;
        }
      }
      movers.solve();
      const VecX<double> x = A.partialPivLu().solve(b);
      for (int i = 0; i < n; ++i) {
        const int size = sizes[static_cast<std::size_t>(i)];
        CHECK((movers.change(movers.row(i), size) - x.segment(movers.row(i), size)).norm() < 1e-13);
      }
    }
}

}  // namespace mover_system_test
