// The compiled function bodies of project_joints-inl.h.
#include <pliant/project/project_joints-inl.h>
