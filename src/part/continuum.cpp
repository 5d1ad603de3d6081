// Compiles the bodies of continuum-inl.h once.
#include <pliant/part/continuum-inl.h>
