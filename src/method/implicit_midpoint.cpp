// The library's instance of the function bodies in <pliant/method/implicit_midpoint-inl.h>.
#include <pliant/method/implicit_midpoint-inl.h>
