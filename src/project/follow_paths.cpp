// The compiled function bodies of follow_paths-inl.h.
#include <pliant/project/follow_paths-inl.h>
