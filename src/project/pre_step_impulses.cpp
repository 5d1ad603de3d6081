// The compiled function bodies of pre_step_impulses-inl.h.
#include <pliant/project/pre_step_impulses-inl.h>
