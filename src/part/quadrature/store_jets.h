// Jets of material points as structures of arrays: all x, then y, then z.
#pragma once

#include <vector>

#include <pliant/part/part.h>

namespace pliant {

/// Where jets of n points go: 3n numbers each, and 3n for each dynamic parameter in J.
struct JetArrays {
  Eigen::Index n;
  double* s;
  double *s1, *s2;  ///< left alone where nothing moves
  double* J;
};

/// The shape s, J and, where q_s_dot is not zero, the rates J q_s_dot and Jdot q_s_dot of points. packs: the
/// points, by fours.
void store_jets(const Part& part, const VecX<double>& q_s, const VecMax<double>& q_s_dot,
                const std::vector<Material<Pack>>& packs, const JetArrays& to, Counters& counters);

/// Points by fours; the last one fills up.
std::vector<Material<Pack>> packs_of(const std::vector<Material<double>>& points);

}  // namespace pliant
