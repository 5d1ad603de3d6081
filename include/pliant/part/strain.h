// The deformation gradient F = ds/dX and its derivatives dF/dq_s at quadrature points of the rest body, in
// packs of four. X is the position in the rest body.
#pragma once

#include <array>

#include <pliant/part/part.h>

namespace pliant::strain {

/// Number of packs in a block.
inline constexpr int kBlock = 4;

/// Values of the parameters as dual numbers. Part::jets() needs this type if the material points are dual
/// numbers.
using DualValues = ParameterValues<Dual<1>>;

/// F and dF/dq_k of each pack of a block.
struct Block {
  std::array<Mat3<Pack>, kBlock> F;
  std::array<std::array<Mat3<Pack>, kMaxGlobal>, kBlock> dF;
};

/// The packs number `first` to `first` + `count` - 1 of quadrature points, at given values of the parameters.
struct Packs {
  const Part& part;
  const DualValues& values;
  const StrainPoints& points;
  int first, count;
};

/// Evaluates the jets of a range of packs, with their derivatives along each direction r of the rest body.
/// Calls store(r, i, jet) for pack number i of the range.
template <class Store>
void for_each_direction(const Packs& packs, Level level, Store&& store) {
  std::array<Jet<Dual<1, Pack>>, kBlock> jets;
  for (int r = 0; r < packs.points.directions; ++r) {
    JetBatch<Dual<1, Pack>> batch{jets.data(), packs.count, 0, level};
    packs.part.jets(packs.values, packs.points.at[static_cast<std::size_t>(r)].data() + packs.first, batch);
    for (int i = 0; i < packs.count; ++i) store(r, i, jets[static_cast<std::size_t>(i)]);
  }
}

/// Writes the derivative of a position along direction r into column r.
inline void set_column(Mat3<Pack>& to, int r, const Vec3<Dual<1, Pack>>& from) {
  for (int i = 0; i < 3; ++i) to(i, r) = from[i].d[0];
}

/// Computes F of a block and, unless the level is Level::position, dF for the n_s dynamic parameters. For a
/// shell, which has two directions, the third columns are zero.
inline void evaluate(const Packs& packs, int n_s, Level level, Block& out) {
  const auto columns = static_cast<std::size_t>(level == Level::position ? 0 : n_s);
  for (std::size_t i = 0; packs.points.directions < 3 && i < static_cast<std::size_t>(packs.count); ++i) {
    out.F[i].col(2).setConstant(Pack(0.0));
    for (std::size_t k = 0; k < columns; ++k) out.dF[i][k].col(2).setConstant(Pack(0.0));
  }
  for_each_direction(packs, level, [&](int r, int i, const Jet<Dual<1, Pack>>& jet) {
    const auto at = static_cast<std::size_t>(i);
    set_column(out.F[at], r, jet.s);
    for (std::size_t k = 0; k < columns; ++k) set_column(out.dF[at][k], r, jet.J[k]);
  });
}

/// Returns sum_k c_k A_k. c: vector of numbers, one for each dynamic parameter.
template <class C>
Mat3<Pack> combine(const std::array<Mat3<Pack>, kMaxGlobal>& A, const C& c) {
  Mat3<Pack> sum = Mat3<Pack>::Constant(Pack(0.0));
  for (Eigen::Index k = 0; k < c.size(); ++k)
    for (int i = 0; i < 9; ++i) sum.data()[i] += Pack(c[k]) * A[static_cast<std::size_t>(k)].data()[i];
  return sum;
}

}  // namespace pliant::strain
