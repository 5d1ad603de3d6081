// The compiled function bodies of joint_switching-inl.h.
#include <pliant/project/joint_switching-inl.h>
