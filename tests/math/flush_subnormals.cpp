// The guard FlushSubnormals, in one thread and in the threads of a pool.
#include "catch.h"

#include <limits>
#include <vector>

#include <pliant/math/flush_subnormals.h>
#include <pliant/math/thread_pool.h>

namespace flush_subnormals_test {

using namespace pliant;

namespace {
/// Returns half of the smallest normal number, by a product that the compiler cannot evaluate.
double half_of_smallest() {
  volatile double half = 0.5;
  return std::numeric_limits<double>::min() * half;
}
}  // namespace

TEST_CASE("subnormal numbers are zero while flushing is active, and not zero afterwards", "[math]") {
  REQUIRE_FALSE(FlushSubnormals::active());
  CHECK(half_of_smallest() != 0);
  {
    const FlushSubnormals flushed;
    CHECK((half_of_smallest() == 0) == FlushSubnormals::active());
    {
      const FlushSubnormals not_asked(false), again;
      CHECK(half_of_smallest() == 0);
    }
    CHECK((half_of_smallest() == 0) == FlushSubnormals::active());
  }
  CHECK_FALSE(FlushSubnormals::active());
  CHECK(half_of_smallest() != 0);
}

TEST_CASE("threads of a pool use the subnormal mode of the calling thread", "[math]") {
  ThreadPool pool(4);
  for (const bool flush : {false, true, false}) {
    const FlushSubnormals flushed(flush);
    std::vector<double> found(1000);
    pool.run(1000, [&](int i) { found[static_cast<std::size_t>(i)] = half_of_smallest(); });
    const double here = half_of_smallest();
    for (const double there : found) REQUIRE(there == here);
  }
}

}  // namespace flush_subnormals_test
