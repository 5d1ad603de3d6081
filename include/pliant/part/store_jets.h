// Jets of many material points as structures of arrays: the x components of all points, then y, then z.
#pragma once

#include <vector>

#include <pliant/part/packs.h>
#include <pliant/part/part.h>

namespace pliant {

/// The arrays that receive the jets of n points. s, s1 and s2 have 3n numbers; J has 3n numbers for each
/// dynamic parameter.
struct JetArrays {
  Eigen::Index n;
  double* s;
  double *s1, *s2;  ///< not written if q_s_dot is zero; may be nullptr then
  double* J;
};

/// Writes s, J and, if q_s_dot is not zero, the rates s1 = J q_s_dot and s2 = Jdot q_s_dot of to.n material
/// points. packs: the points in packs of four, from packs_of().
void store_jets(const Part& part, const VecX<double>& q_s, const VecMax<double>& q_s_dot,
                const std::vector<Material<Pack>>& packs, const JetArrays& to, Counters& counters);

}  // namespace pliant
