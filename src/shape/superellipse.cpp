// Compiles the functions of superellipse.h once for the library.
#include <pliant/shape/superellipse-inl.h>
