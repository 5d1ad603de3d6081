// A test for finite numbers. The test computes one sum, which compilers vectorise.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// Returns whether all entries of x are finite: 0 * x is 0 if x is finite, and NaN otherwise.
template <class Derived>
bool all_finite(const Eigen::DenseBase<Derived>& x) {
  return (0.0 * x.derived().array()).sum() == 0;
}

}  // namespace pliant
