// Compiles the function bodies of surface-inl.h once.
#include <pliant/part/mesh/surface-inl.h>
