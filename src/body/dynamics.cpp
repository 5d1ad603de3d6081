// The compiled function bodies of dynamics-inl.h, and the instances of the evaluation for values and for
// directional derivatives.
#include <pliant/body/dynamics-inl.h>

namespace pliant {

template void Dynamics::evaluate(const Evaluation<double>&) const;
template void Dynamics::evaluate(const Evaluation<Dual<1>>&) const;

}  // namespace pliant
