// Compiles the functions of time_function.h once for the library.
#include <pliant/math/time_function-inl.h>
