// The axial vector of a matrix.
#pragma once

#include <pliant/math/types.h>

namespace pliant {

/// Returns sum a x b, the axial vector of the matrix ab = sum a b^T.
template <class T>
Vec3<T> axial(const Mat3<T>& ab) {
  return {ab(1, 2) - ab(2, 1), ab(2, 0) - ab(0, 2), ab(0, 1) - ab(1, 0)};
}

}  // namespace pliant
