// The compiled function bodies of joint_wrench-inl.h.
#include <pliant/body/constraint/joint_wrench-inl.h>
