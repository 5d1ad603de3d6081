// The compiled function bodies of assemble-inl.h.
#include <pliant/project/assemble-inl.h>
