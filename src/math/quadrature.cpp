// The library compiles the bodies of this header here.
#include <pliant/math/quadrature-inl.h>
