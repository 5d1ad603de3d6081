// The compiled function bodies of solve_joints-inl.h.
#include <pliant/body/constraint/solve_joints-inl.h>
