// Whether numbers are finite, in one sum that runs on vector units.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// 0 x is 0 for every finite x, and for no other.
template <class Derived>
bool all_finite(const Eigen::DenseBase<Derived>& x) {
  return (0.0 * x.derived().array()).sum() == 0;
}

}  // namespace pliant
