// Compiles the functions of surface-inl.h once.
#include <pliant/part/mesh/surface-inl.h>
