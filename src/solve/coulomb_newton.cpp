// Compiles the functions of coulomb_newton-inl.h once for the library.
#include <pliant/solve/coulomb_newton-inl.h>
