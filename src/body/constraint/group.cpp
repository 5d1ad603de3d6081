// The compiled function bodies of group-inl.h, and the instances of Group.
#include <pliant/body/constraint/group-inl.h>

namespace pliant {

template class Group<double, kMaxVelocities>;
template class Group<double, Eigen::Dynamic>;
template class Group<Dual<1>, kMaxVelocities>;
template class Group<Dual<1>, Eigen::Dynamic>;

}  // namespace pliant
