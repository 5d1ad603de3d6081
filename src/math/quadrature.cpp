// Compiles the functions of quadrature.h once for the library.
#include <pliant/math/quadrature-inl.h>
