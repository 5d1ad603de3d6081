// Compiles the function bodies of continuum-inl.h once.
#include <pliant/part/continuum-inl.h>
