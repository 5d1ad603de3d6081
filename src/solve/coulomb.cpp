// Compiles the functions of coulomb.h once for the library.
#include <pliant/solve/coulomb-inl.h>
