// Compiles the function bodies of surface_turn-inl.h once.
#include <pliant/part/mesh/surface_turn-inl.h>
