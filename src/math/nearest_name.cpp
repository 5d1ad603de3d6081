// Compiles the functions of nearest_name.h once for the library.
#include <pliant/math/nearest_name-inl.h>
