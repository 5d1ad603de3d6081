// The instances of constraints-inl.h: values and directional derivatives.
#include <pliant/body/constraint/constraints-inl.h>

namespace pliant {

#define PLIANT_INSTANCES(S)                                                                                \
  template void evaluate_joints(const Model&, const Island&, double, const std::vector<PartWorkspace<S>>&, \
                                ConstraintWorkspace<S>&, const EvaluatePart&);                             \
  template double diagonal_of_ends(const Model&, const ConstraintWorkspace<S>&, int, int);                 \
  template void factor_joints(const Model&, const Island&, const std::vector<PartWorkspace<S>>&,           \
                              ConstraintWorkspace<S>&);                                                    \
  template VecMax<S, kMaxJointRows> wanted(const Model&, const ConstraintWorkspace<S>&, int);              \
  template void evaluate_and_factor_joints(const Model&, const Island&, double,                            \
                                           const std::vector<PartWorkspace<S>>&, ConstraintWorkspace<S>&,  \
                                           const EvaluatePart&);                                           \
  template Vec<S, kWorks> joint_power(const Model&, const Workspace<S>&);                                  \
  template class JointFactor<S>;
PLIANT_INSTANCES(double)
PLIANT_INSTANCES(Dual<1>)
#undef PLIANT_INSTANCES

}  // namespace pliant
