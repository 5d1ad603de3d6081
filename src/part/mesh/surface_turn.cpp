// Compiles the functions of surface_turn-inl.h once.
#include <pliant/part/mesh/surface_turn-inl.h>
