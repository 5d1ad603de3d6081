// The compiled function bodies of group-inl.h.
#include <pliant/body/constraint/group-inl.h>
