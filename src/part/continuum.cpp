// Compiles the functions of continuum-inl.h once.
#include <pliant/part/continuum-inl.h>
