// Compiles the functions of elasticity.h once for the library.
#include <pliant/local/elasticity-inl.h>
