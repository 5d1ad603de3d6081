// Explicit instances of the active-set method.
#include <pliant/solve/complementarity-inl.h>

namespace pliant {

template ComplementarityResult<Eigen::Dynamic> solve_complementarity(const MatX<double>&,
                                                                     const VecX<double>&);
template ComplementarityResult<kMaxLimitRows> solve_complementarity(const MatMax<double, kMaxLimitRows>&,
                                                                    const VecMax<double, kMaxLimitRows>&);

}  // namespace pliant
