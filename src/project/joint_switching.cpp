// The library's instance of the bodies in <pliant/project/joint_switching-inl.h>.
#include <pliant/project/joint_switching-inl.h>
