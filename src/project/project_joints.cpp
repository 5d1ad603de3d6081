// The library's instance of the bodies in <pliant/project/project_joints-inl.h>.
#include <pliant/project/project_joints-inl.h>
