// The library's instance of the bodies in <pliant/project/pre_step_impulses-inl.h>.
#include <pliant/project/pre_step_impulses-inl.h>
