// Compiles the functions of coulomb_system.h once for the library.
#include <pliant/solve/coulomb_system-inl.h>
