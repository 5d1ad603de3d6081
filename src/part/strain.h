// F = ds/dX and its derivatives by the dynamic parameters at points of the rest body, four at a time.
#pragma once

#include <array>

#include <pliant/part/part.h>

namespace pliant::strain {

/// Packs handled at a time.
inline constexpr int kBlock = 4;

using DualValues = ParameterValues<Dual<1>>;

struct Block {
  std::array<Mat3<Pack>, kBlock> F;
  std::array<std::array<Mat3<Pack>, kMaxGlobal>, kBlock> dF;  ///< by each dynamic parameter
};

/// Column r of what take(jet) picks of the jets of a block of packs, for each direction r.
template <class Take>
void for_each_direction(const Part& part, const DualValues& values, const StrainPoints& points, int first,
                        int count, Level level, Take&& take) {
  std::array<Jet<Dual<1, Pack>>, kBlock> jets;
  for (int r = 0; r < points.directions; ++r) {
    JetBatch<Dual<1, Pack>> batch{jets.data(), count, 0, level};
    part.jets(values, points.at[static_cast<std::size_t>(r)].data() + first, batch);
    for (int i = 0; i < count; ++i) take(r, i, jets[static_cast<std::size_t>(i)]);
  }
}

inline void put_column(Mat3<Pack>& to, int r, const Vec3<Dual<1, Pack>>& from) {
  for (int i = 0; i < 3; ++i) to(i, r) = from[i].d[0];
}

/// F of a block, and with Level::jacobian dF. Columns beyond the directions are 0.
inline void evaluate(const Part& part, const DualValues& values, const StrainPoints& points, int first,
                     int count, int n_s, Level level, Block& out) {
  const auto columns = static_cast<std::size_t>(level == Level::position ? 0 : n_s);
  for (std::size_t i = 0; points.directions < 3 && i < static_cast<std::size_t>(count); ++i) {
    out.F[i].col(2).setConstant(Pack(0.0));
    for (std::size_t k = 0; k < columns; ++k) out.dF[i][k].col(2).setConstant(Pack(0.0));
  }
  for_each_direction(part, values, points, first, count, level,
                     [&](int r, int i, const Jet<Dual<1, Pack>>& jet) {
                       const auto at = static_cast<std::size_t>(i);
                       put_column(out.F[at], r, jet.s);
                       for (std::size_t k = 0; k < columns; ++k) put_column(out.dF[at][k], r, jet.J[k]);
                     });
}

/// sum_k c_k A_k.
template <class C>
Mat3<Pack> combine(const std::array<Mat3<Pack>, kMaxGlobal>& A, const C& c) {
  Mat3<Pack> sum = Mat3<Pack>::Constant(Pack(0.0));
  for (Eigen::Index k = 0; k < c.size(); ++k)
    for (int i = 0; i < 9; ++i) sum.data()[i] += Pack(c[k]) * A[static_cast<std::size_t>(k)].data()[i];
  return sum;
}

}  // namespace pliant::strain
